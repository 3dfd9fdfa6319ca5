#include "abbe/errors/calibrated_machine.h"

#include <algorithm>
#include <stdexcept>

#include "abbe/errors/error_states.h"
#include "abbe/geometry/rotation.h"

namespace abbe {

CalibratedMachine calibrated_machine(const Machine& machine, const ErrorSet& errors) {
  const std::string first = first_error_with_state(machine, errors);
  if (!first.empty())
    throw std::invalid_argument(first + " depends on a state, so it is not a constant of the geometry");
  CalibratedMachine result{machine, std::vector<double>(machine.axes.size(), 0.0), {}};
  for (const ErrorMotion& motion : errors.motions) {
    const bool moves = std::any_of(motion.coefficients.begin(), motion.coefficients.end(),
                                   [](double coefficient) { return coefficient != 0; });
    if (moves && result.variable.empty()) {
      result.variable = error_motion_name(machine, motion.axis, motion.component);
    }
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    Axis& axis = result.machine.axes[i];
    Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
    for (const LocationError& location : errors.locations) {
      if (location.axis != i) continue;
      const LocationEffect effect = location_effect(machine.axes[i], location.component);
      result.zero[i] += location.value * effect.zero_position;
      tilt += location.value * effect.tilt;
      axis.point += location.value * effect.shift;
    }
    // Rounding of the product must not make the direction any other than a unit vector.
    axis.direction = (rotation_from_error_angles(tilt) * axis.direction).normalized();
    axis.travel_min += result.zero[i];
    axis.travel_max += result.zero[i];
  }
  result.machine.tool_offset += errors.tool_offset_error;
  return result;
}

}  // namespace abbe
