#include <fmt/core.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/inverse_kinematics.h"

namespace abbe {
namespace {

std::string number(double value, const char* unit) { return fmt::format("{:.6g} {}", value, unit); }

std::string angle(double radians) { return number(radians / kDegree, "deg"); }

std::string command(const Axis& axis, double position) {
  return axis.kind == AxisKind::rotary ? angle(position) : number(position, "mm");
}

std::string singularity_in_words(const Machine& machine, const InverseSolution& solution) {
  std::string held;
  std::string name = "the first rotary axis";
  if (solution.singular_axis < machine.axes.size()) {
    const Axis& axis = machine.axes[solution.singular_axis];
    name = axis.name;
    held = name + " is free, held at " + command(axis, solution.position[solution.singular_axis]);
  }
  switch (solution.singularity) {
    case PoseSingularity::none:
      return "";
    case PoseSingularity::tool_parallel:
      return "tool parallel to " + name + ": " + held;
    case PoseSingularity::axes_parallel:
      return "first and last rotary axes parallel, only their sum counts: " + held;
    case PoseSingularity::limit_of_reach:
      return "tool at the limit of what the rotary axes reach: two branches meet";
    case PoseSingularity::point_on_axis:
      return "point on the axis of " + name + ": " + held;
    case PoseSingularity::linear_dependent:
      return "linear axes parallel or in one plane: the commands nearest to the start were taken";
    case PoseSingularity::arm_dependent:
      return "axes of the arm dependent: " + held;
  }
  return "";
}

}  // namespace

std::string describe(const Machine& machine, const InverseSolution& solution) {
  std::string text = singularity_in_words(machine, solution);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const double excess = solution.excess[i];
    if (excess == 0) continue;
    const Axis& axis = machine.axes[i];
    if (!text.empty()) text += "; ";
    text += axis.name + " at " + command(axis, solution.position[i]) + " is " + command(axis, std::abs(excess)) +
            (excess > 0 ? " above" : " below") + " its travel";
  }
  return text;
}

std::string describe(const Machine& machine, const InverseResult& result) {
  const InverseSolution& closest = result.closest;
  switch (result.status) {
    case InverseStatus::not_run:
      return "not run";
    case InverseStatus::solved:
      return std::to_string(result.solutions.size()) +
             (result.solutions.size() == 1 ? " solution" : " solutions, nearest first");
    case InverseStatus::outside_travel:
      return "outside travel: " + describe(machine, result.solutions.front());
    case InverseStatus::unreachable_orientation:
      return "unreachable: the rotary axes miss the orientation by " + angle(closest.orientation_residual);
    case InverseStatus::unreachable_position:
      return "unreachable: the point is missed by " + number(closest.position_residual, "mm");
    case InverseStatus::too_few_axes:
      return "too few axes for this target: missed by " + number(closest.position_residual, "mm") + " and " +
             angle(closest.orientation_residual);
    case InverseStatus::invalid_target:
      return "the target or the start is not finite, or the target has a direction of length zero or an orientation "
             "that is not a rotation";
    case InverseStatus::invalid_machine:
      return "the machine or the options are not usable";
  }
  return "";
}

}  // namespace abbe
