#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/evaluations.h"

namespace abbe::python {
namespace {

double number_of(const EvaluatedFigure& figure) { return figure.is_evaluated() ? figure.value : NAN; }

/// [targets, 2]: a number for each direction of approach.
template <class Value>
nb::object of_sides(const PositioningEvaluation& evaluation, const Value& value) {
  std::vector<double> values;
  for (const PositioningTarget& target : evaluation.targets) {
    for (std::size_t side = 0; side < 2; ++side) values.push_back(value(target, side));
  }
  return array_of(std::move(values), {evaluation.targets.size(), 2});
}

void bind_positioning(nb::module_& module) {
  using Evaluated = PositioningEvaluation;
  nb::class_<PositioningEvaluation>(
      module, "PositioningNumbers",
      "Positioning at each target: mm for a linear axis, rad for a rotary one. The second\nindex of [n, 2] is the "
      "direction of approach: positive, negative. NaN: too few readings.")
      .def_prop_ro(
          "targets_mm_rad", [](const Evaluated& e) { return numbers_of_each(e.targets, &PositioningTarget::position); },
          nb::sig("def targets_mm_rad(self) -> numpy.ndarray"), "[n] target positions, ascending.")
      .def_prop_ro(
          "runs",
          [](const Evaluated& e) {
            return of_sides(
                e, [](const PositioningTarget& t, std::size_t side) { return static_cast<double>(t.runs[side]); });
          },
          nb::sig("def runs(self) -> numpy.ndarray"), "[n, 2] number of readings.")
      .def_prop_ro(
          "mean_mm_rad",
          [](const Evaluated& e) {
            return of_sides(
                e, [](const PositioningTarget& t, std::size_t side) { return t.runs[side] > 0 ? t.mean[side] : NAN; });
          },
          nb::sig("def mean_mm_rad(self) -> numpy.ndarray"), "[n, 2] mean unidirectional positioning deviation.")
      .def_prop_ro(
          "standard_deviation_mm_rad",
          [](const Evaluated& e) {
            return of_sides(e, [](const PositioningTarget& t, std::size_t side) {
              return t.runs[side] > 1 ? t.deviation[side] : NAN;
            });
          },
          nb::sig("def standard_deviation_mm_rad(self) -> numpy.ndarray"),
          "[n, 2] s, the standard deviation of the readings.")
      .def_prop_ro(
          "repeatability_mm_rad",
          [](const Evaluated& e) {
            return of_sides(
                e, [](const PositioningTarget& t, std::size_t side) { return number_of(t.repeatability[side]); });
          },
          nb::sig("def repeatability_mm_rad(self) -> numpy.ndarray"),
          "[n, 2] unidirectional repeatability R+ and R-, 4 s.")
      .def_prop_ro(
          "reversal_mm_rad",
          [](const Evaluated& e) {
            return numbers_of_each(e.targets, [](const PositioningTarget& t) { return number_of(t.reversal); });
          },
          nb::sig("def reversal_mm_rad(self) -> numpy.ndarray"),
          "[n] signed reversal error B: mean of the positive approaches minus that of the negative.")
      .def_prop_ro(
          "mean_bidirectional_mm_rad",
          [](const Evaluated& e) {
            return numbers_of_each(e.targets,
                                   [](const PositioningTarget& t) { return number_of(t.mean_bidirectional); });
          },
          nb::sig("def mean_bidirectional_mm_rad(self) -> numpy.ndarray"),
          "[n] mean bidirectional positioning deviation.")
      .def_prop_ro(
          "bidirectional_repeatability_mm_rad",
          [](const Evaluated& e) {
            return numbers_of_each(e.targets,
                                   [](const PositioningTarget& t) { return number_of(t.bidirectional_repeatability); });
          },
          nb::sig("def bidirectional_repeatability_mm_rad(self) -> numpy.ndarray"),
          "[n] bidirectional repeatability R.")
      .def("__len__", [](const Evaluated& e) { return e.targets.size(); })
      .def("__repr__",
           [](const Evaluated& e) { return fmt::format("<abbe.PositioningNumbers: {} targets>", e.targets.size()); });
  nb::class_<DiagonalsEvaluation>(module, "DiagonalsNumbers", "Positioning along each diagonal.")
      .def_prop_ro(
          "names",
          [](const DiagonalsEvaluation& e) {
            return values_of_each<std::string>(e.diagonals, &DiagonalEvaluation::name);
          },
          "In the order of the readings.")
      .def_prop_ro(
          "positioning",
          [](const DiagonalsEvaluation& e) {
            return values_of_each<PositioningEvaluation>(e.diagonals, &DiagonalEvaluation::positioning);
          },
          "PositioningNumbers of each diagonal, mm.")
      .def("__repr__", [](const DiagonalsEvaluation& e) {
        return fmt::format("<abbe.DiagonalsNumbers: {} diagonals>", e.diagonals.size());
      });
}

const char* status_word(StraightnessStatus status) {
  switch (status) {
    case StraightnessStatus::not_run:
      return "not run";
    case StraightnessStatus::done:
      return "done";
    case StraightnessStatus::too_few_positions:
      return "too few positions";
  }
  return "";
}

void bind_lines(nb::module_& module) {
  nb::class_<Straightness>(module, "LineDeviations", "Deviations from a reference straight line, mm.")
      .def_prop_ro(
          "status", [](const Straightness& s) { return status_word(s.status); }, "'done', or why there is no result.")
      .def_prop_ro(
          "origin_mm", [](const Straightness& s) { return s.line.origin; }, "Mean position of the readings.")
      .def_prop_ro(
          "offset_mm", [](const Straightness& s) { return s.line.offset; }, "Deviation of the line at origin_mm.")
      .def_prop_ro(
          "slope_rad", [](const Straightness& s) { return s.line.slope; }, "Slope of the line.")
      .def_prop_ro(
          "deviations_mm", [](const Straightness& s) { return copied_array(s.deviations); },
          nb::sig("def deviations_mm(self) -> numpy.ndarray"), "[n] from the line, in the order of the readings.")
      .def_ro("value_mm", &Straightness::value, "Straightness error: largest minus smallest deviation.")
      .def_ro("largest_at", &Straightness::largest_at, "Index of the reading with the largest deviation.")
      .def_ro("smallest_at", &Straightness::smallest_at, "Index of the reading with the smallest deviation.")
      .def_ro("scatter_mm", &Straightness::scatter, "Standard deviation about the least-squares line.")
      .def_ro("value_uncertainty_mm", &Straightness::value_uncertainty,
              "Standard uncertainty of value_mm; 0 if not stated.")
      .def_ro("slope_uncertainty_rad", &Straightness::slope_uncertainty, "Standard uncertainty of slope_rad.")
      .def("__repr__", [](const Straightness& s) {
        return fmt::format("<abbe.LineDeviations: {} readings, {:.3f} um>", s.deviations.size(), 1e3 * s.value);
      });
  nb::class_<StraightnessEvaluation>(module, "StraightnessNumbers", "Deviations from both reference lines.")
      .def_ro("least_squares", &StraightnessEvaluation::least_squares)
      .def_ro("minimum_zone", &StraightnessEvaluation::minimum_zone);
  nb::class_<Squareness>(module, "SquarenessNumbers", "Two lines and the angle between them.")
      .def_prop_ro(
          "status", [](const Squareness& s) { return status_word(s.status); }, "'done', or why there is no result.")
      .def_prop_ro(
          "lines", [](const Squareness& s) { return std::vector<Straightness>(s.lines.begin(), s.lines.end()); },
          "LineDeviations of both, the reference first.")
      .def_ro("value_rad", &Squareness::value, "Angle between the positive directions minus 90 degrees.")
      .def_ro("uncertainty_rad", &Squareness::uncertainty, "Standard uncertainty of value_rad.");
}

}  // namespace

void bind_axis_numbers(nb::module_& module) {
  bind_positioning(module);
  bind_lines(module);
}

}  // namespace abbe::python
