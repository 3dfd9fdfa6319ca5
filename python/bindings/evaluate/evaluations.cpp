#include "bindings/evaluate/evaluations.h"

#include <fmt/format.h>

#include "bindings/evaluate/report.h"

namespace abbe::python {

Evaluation evaluate_test(TestToEvaluate test, const std::string& file, const Tolerances& tolerances) {
  EvaluationRequest request{file, std::move(test), tolerance_texts(tolerances)};
  return computed([&] { return evaluate_readings(request); });
}

std::string name_of(const GivenReadings& readings, const std::string& file) {
  if (!file.empty()) return file;
  const auto* const given = std::get_if<ReadingsFile>(&readings);
  return given ? given->path.string() : "readings";
}

void bind_evaluations(nb::module_& module) {
  bind_evaluation_reports(module);
  bind_axis_numbers(module);
  bind_circular_numbers(module);
  bind_contour_numbers(module);
  nb::class_<Evaluation> bound(
      module, "Evaluation",
      "Figures of a test as its standard defines them. Made by the evaluate_...() functions.\n\n"
      "text(), json_text(), page_html() and write() give what `abbe evaluate` writes; "
      "numbers\n"
      "has the arrays behind the figures.");
  add_report(
      bound, &Evaluation::report, +[](const Evaluation& e) { return e.files; });
  bound
      .def_prop_ro(
          "numbers",
          [](nb::handle_t<Evaluation> self) {
            const Evaluation& evaluation = initialised(self);
            return std::visit(
                [&](const auto& found) { return nb::cast(&found, nb::rv_policy::reference_internal, self); },
                evaluation.found);
          },
          nb::sig("def numbers(self) -> PositioningNumbers | DiagonalsNumbers | CircularNumbers | RotationNumbers | "
                  "StraightnessNumbers | SquarenessNumbers | SectionNumbers | ContourNumbers | LinkageNumbers | "
                  "EtveNumbers | SpindleDistortionNumbers | AxisDistortionNumbers | LocationDistortionNumbers"),
          "Results as numbers and arrays in mm and rad; the class depends on the test.")
      .def_ro("refused", &Evaluation::refused,
              "Why the figures are not those requested; empty if they are. An exceeded tolerance is no reason.")
      .def_prop_ro("ok", &Evaluation::is_ok, "Whether the figures are those requested and none exceeds its tolerance.")
      .def("__repr__", [](const Evaluation& e) {
        return fmt::format("<abbe.Evaluation '{}': {} figures{}>", e.report.title, e.report.figures.size(),
                           !e.refused.empty()             ? ", refused"
                           : e.report.exceeds_tolerance() ? ", a tolerance is exceeded"
                                                          : "");
      });
  bind_axis_tests(module);
  bind_contour_tests(module);
  bind_thermal_tests(module);
}

}  // namespace abbe::python
