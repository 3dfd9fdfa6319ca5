#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "abbe/report/evaluations/rotation_report.h"
#include "bindings/evaluate/evaluations.h"

namespace abbe::python {
namespace {

/// A path with what the causes explain of it, and what they leave.
struct CircularPath {
  const CircularDeviation* deviation;
  const std::vector<double>*residuals, *modelled;  ///< null for both directions together
};

const char* status_word(CircleStatus status) {
  switch (status) {
    case CircleStatus::not_run:
      return "not run";
    case CircleStatus::done:
      return "done";
    case CircleStatus::too_few_readings:
      return "too few readings";
    case CircleStatus::arc_too_short:
      return "arc too short";
    case CircleStatus::not_converged:
      return "not converged";
  }
  return "";
}

nb::object array_or_none(const std::vector<double>* values) { return values ? copied_array(*values) : nb::none(); }

void bind_circular(nb::module_& module) {
  nb::class_<CircularPath>(module, "CircularPath", "Radial deviations of a path about a centre.")
      .def_prop_ro(
          "status", [](const CircularPath& p) { return status_word(p.deviation->status); },
          "'done', or why there are no numbers.")
      .def_prop_ro(
          "partial", [](const CircularPath& p) { return p.deviation->partial; },
          "Whether the path is an arc, not a full circle.")
      .def_prop_ro(
          "centre_mm", [](const CircularPath& p) { return p.deviation->centre; },
          "[2] along the first and the second axis, from the centre of the instrument.")
      .def_prop_ro("mean_radius_mm", [](const CircularPath& p) { return p.deviation->mean_radius; })
      .def_prop_ro(
          "angle_rad", [](const CircularPath& p) { return copied_array(p.deviation->angle); },
          nb::sig("def angle_rad(self) -> numpy.ndarray"), "[n] seen from the centre, in the order along the path.")
      .def_prop_ro(
          "deviation_mm", [](const CircularPath& p) { return copied_array(p.deviation->deviations); },
          nb::sig("def deviation_mm(self) -> numpy.ndarray"), "[n] radius about the centre minus the nominal radius.")
      .def_prop_ro(
          "circular_mm", [](const CircularPath& p) { return p.deviation->circular; },
          "Circular deviation G: largest minus smallest radius.")
      .def_prop_ro(
          "radial_largest_mm", [](const CircularPath& p) { return p.deviation->radial_largest; },
          "Radial deviation F max.")
      .def_prop_ro(
          "radial_smallest_mm", [](const CircularPath& p) { return p.deviation->radial_smallest; },
          "Radial deviation F min.")
      .def_prop_ro(
          "modelled_mm", [](const CircularPath& p) { return array_or_none(p.modelled); },
          nb::sig("def modelled_mm(self) -> numpy.ndarray | None"),
          "[n] radial deviation that the causes explain, centre left out; None for both directions together.")
      .def_prop_ro(
          "residuals_mm", [](const CircularPath& p) { return array_or_none(p.residuals); },
          nb::sig("def residuals_mm(self) -> numpy.ndarray | None"), "[n] radial deviation that the causes leave.")
      .def("__repr__", [](const CircularPath& p) {
        return fmt::format("<abbe.CircularPath: {} readings, G {:.3f} um>", p.deviation->deviations.size(),
                           1e3 * p.deviation->circular);
      });
  const auto path = [](CircularDirection direction) {
    return [at = static_cast<std::size_t>(direction)](const CircularEvaluation& e) {
      return CircularPath{&e.deviations.paths[at], &e.diagnosis.residuals[at], &e.diagnosis.modelled[at]};
    };
  };
  nb::class_<CircularEvaluation>(module, "CircularNumbers", "Radial deviations; the causes are among the figures.")
      .def_prop_ro("clockwise", path(CircularDirection::clockwise), nb::keep_alive<0, 1>())
      .def_prop_ro("counterclockwise", path(CircularDirection::counterclockwise), nb::keep_alive<0, 1>())
      .def_prop_ro(
          "both",
          [](const CircularEvaluation& e) {
            return CircularPath{&e.deviations.both, nullptr, nullptr};
          },
          nb::keep_alive<0, 1>(), "About their common centre: the clockwise readings, then the others.")
      .def_prop_ro(
          "mean_mm",
          [](const CircularEvaluation& e) {
            return e.deviations.has_mean ? std::optional(e.deviations.mean) : std::nullopt;
          },
          "Mean bidirectional radial deviation D; None with one direction only.")
      .def_prop_ro(
          "residual_rms_mm", [](const CircularEvaluation& e) { return e.diagnosis.residual_rms; },
          "Standard deviation of what the causes leave.");
}

/// [turns, positions]
nb::object by_turn(const std::vector<double>& values, std::size_t positions) {
  const std::size_t turns = positions == 0 ? 0 : values.size() / positions;
  return array_of(std::vector<double>(values), {turns, positions});
}

void bind_rotation(nb::module_& module) {
  nb::class_<AxisErrorMotion>(module, "AxisErrorMotion", "An error motion of an axis of rotation, in mm; tilts in rad.")
      .def_prop_ro(
          "symbol", [](const AxisErrorMotion& m) { return error_motion_symbol(m.kind); },
          "Start of the symbols of its figures: 'radial_x1', 'tilt_rotating', 'axial'.")
      .def_prop_ro(
          "synchronous_mm_rad", [](const AxisErrorMotion& m) { return copied_array(m.synchronous); },
          nb::sig("def synchronous_mm_rad(self) -> numpy.ndarray"), "[positions] mean over the turns.")
      .def_prop_ro(
          "total_mm_rad", [](const AxisErrorMotion& m) { return by_turn(m.total, m.synchronous.size()); },
          nb::sig("def total_mm_rad(self) -> numpy.ndarray"), "[turns, positions] deviations from the base circle.")
      .def_ro("total_value_mm_rad", &AxisErrorMotion::total_value)
      .def_ro("synchronous_value_mm_rad", &AxisErrorMotion::synchronous_value)
      .def_ro("asynchronous_value_mm_rad", &AxisErrorMotion::asynchronous_value)
      .def_ro("drift_mm_rad", &AxisErrorMotion::drift, "Change of the mean of a turn from the first turn to the last.")
      .def("__repr__", [](const AxisErrorMotion& m) {
        return fmt::format("<abbe.AxisErrorMotion {}>", error_motion_symbol(m.kind));
      });
  nb::class_<RotationResult>(module, "RotationNumbers", "Error motions over the angle of the axis.")
      .def_ro("turns", &RotationResult::turns, "Whole turns used.")
      .def_ro("interpolated", &RotationResult::interpolated,
              "Whether the angles differ from turn to turn, so that readings were interpolated.")
      .def_prop_ro(
          "angle_rad", [](const RotationResult& r) { return copied_array(r.angle); },
          nb::sig("def angle_rad(self) -> numpy.ndarray"), "[positions] angles of the first turn.")
      .def_prop_ro(
          "motions",
          [](const RotationResult& r) {
            nb::dict motions;
            for (const AxisErrorMotion& motion : r.motions)
              motions[error_motion_symbol(motion.kind)] = nb::cast(motion);
            return motions;
          },
          nb::sig("def motions(self) -> dict[str, AxisErrorMotion]"),
          "Error motions by symbol; empty if the evaluation is refused.");
}

}  // namespace

void bind_circular_numbers(nb::module_& module) {
  bind_circular(module);
  bind_rotation(module);
}

}  // namespace abbe::python
