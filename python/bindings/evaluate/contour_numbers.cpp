#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/evaluations.h"

namespace abbe::python {
namespace {

void bind_sections(nb::module_& module) {
  using Sections = SectionsEvaluation;
  nb::class_<SectionsEvaluation>(module, "SectionNumbers",
                                 "Results of each cross-section of an engraved curve, mm; NaN where there is none.")
      .def_prop_ro(
          "reasons", [](const Sections& s) { return values_of_each<std::string>(s.answers, &SectionAnswer::reason); },
          "[n] why there is no result; empty where there is one.")
      .def_prop_ro(
          "error_mm",
          [](const Sections& s) {
            return numbers_of_each(s.answers, [](const SectionAnswer& a) { return a.ok ? a.error : NAN; });
          },
          nb::sig("def error_mm(self) -> numpy.ndarray"), "[n] signed contour error across the curve.")
      .def_prop_ro(
          "error_uncertainty_mm",
          [](const Sections& s) {
            return numbers_of_each(s.answers, [](const SectionAnswer& a) { return a.ok ? a.error_uncertainty : NAN; });
          },
          nb::sig("def error_uncertainty_mm(self) -> numpy.ndarray"), "[n] standard uncertainty of error_mm.")
      .def_prop_ro(
          "width_mm",
          [](const Sections& s) {
            return numbers_of_each(s.answers, [](const SectionAnswer& a) { return a.ok && a.groove ? a.width : NAN; });
          },
          nb::sig("def width_mm(self) -> numpy.ndarray"), "[n] width of the groove; NaN for an edge.")
      .def_ro("refused", &Sections::refused, "Number of sections without a result.")
      .def_ro("radius_mm", &Sections::radius, "Mean radius of the rounding of the edges.")
      .def("__len__", [](const Sections& s) { return s.answers.size(); });
}

void bind_points(nb::module_& module) {
  using Points = ContourPointsEvaluation;
  nb::class_<ContourPointsEvaluation>(module, "ContourNumbers",
                                      "Deviation of each measured point from the commanded curve, mm.")
      .def_prop_ro(
          "along_mm", [](const Points& p) { return numbers_of_each(p.deviations, &ContourDeviation::along); },
          nb::sig("def along_mm(self) -> numpy.ndarray"), "[n] position along the curve.")
      .def_prop_ro(
          "distance_mm", [](const Points& p) { return numbers_of_each(p.deviations, &ContourDeviation::distance); },
          nb::sig("def distance_mm(self) -> numpy.ndarray"), "[n] from the curve.")
      .def_prop_ro(
          "across_mm",
          [](const Points& p) {
            return numbers_of_each(p.deviations, [](const ContourDeviation& d) { return d.across.value_or(NAN); });
          },
          nb::sig("def across_mm(self) -> numpy.ndarray"),
          "[n] in the surface, positive to the left of the curve seen from outside; NaN without a direction.")
      .def_prop_ro(
          "off_mm",
          [](const Points& p) {
            return numbers_of_each(p.deviations, [](const ContourDeviation& d) { return d.off.value_or(NAN); });
          },
          nb::sig("def off_mm(self) -> numpy.ndarray"), "[n] out of the surface.")
      .def_prop_ro(
          "beyond_end", [](const Points& p) { return flags_of_each(p.deviations, &ContourDeviation::beyond_end); },
          nb::sig("def beyond_end(self) -> numpy.ndarray"),
          "[n] whether a point lies beyond an end of the curve; such points do not count.")
      .def("__len__", [](const Points& p) { return p.deviations.size(); });
}

void bind_linkage(nb::module_& module) {
  nb::class_<LinkageEvaluation>(module, "LinkageNumbers", "Linkage parameters of a laser engraver, mm.")
      .def_prop_ro(
          "names",
          [](const LinkageEvaluation&) {
            std::vector<std::string> names;
            for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) names.emplace_back(linkage_name(i));
            return names;
          },
          "R_A, R_C1, L_tA, L_AC1, x0, y0, z0.")
      .def_prop_ro(
          "values_mm",
          [](const LinkageEvaluation& e) {
            const auto values = e.linkage.values();
            return copied_array({values.begin(), values.end()});
          },
          nb::sig("def values_mm(self) -> numpy.ndarray"), "[7] in the order of names.")
      .def_prop_ro(
          "covariance_mm2", [](const LinkageEvaluation& e) { return e.covariance; },
          "[7, 7] of values_mm; zero if no uncertainty is stated.")
      .def_ro("focus_z_mm", &LinkageEvaluation::focus_z, "Lowest point of the parabola through width squared.");
}

}  // namespace

void bind_contour_numbers(nb::module_& module) {
  bind_sections(module);
  bind_points(module);
  bind_linkage(module);
}

}  // namespace abbe::python
