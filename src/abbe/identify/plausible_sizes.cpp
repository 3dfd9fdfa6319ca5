#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/trust/trust.h"

namespace abbe {
namespace {

constexpr double kLargestShare = 0.01;                   // of the travel or of the machine's size
constexpr double kLeastPosition = 5;                     // mm
constexpr double kLeastMotion = 1;                       // mm
constexpr double kLargestAngle = 2 * kDegree;            // rad
constexpr double kLargestReversal = 1;                   // mm
constexpr double kLargestReversalAngle = 0.5 * kDegree;  // rad
constexpr int kSamples = 101;

/// Diagonal of the linear travels, or of the box around the axis points and the tool if that is larger, mm.
double size_of_machine(const Machine& machine) {
  double travels = 0;
  Eigen::AlignedBox3d box(machine.tool_reference);
  box.extend(machine.tool_reference + machine.tool_offset);
  for (const Axis& axis : machine.axes) {
    if (axis.kind == AxisKind::rotary) {
      box.extend(axis.point);
    } else {
      travels = std::hypot(travels, axis.travel_max - axis.travel_min);
    }
  }
  return std::max(travels, box.diagonal().norm());
}

/// Mean over the range, and largest distance from it.
struct SpreadOfMotion {
  double mean = 0, largest = 0;
};

SpreadOfMotion spread_of(const ErrorMotion& motion) {
  const Basis& basis = motion.basis;
  const bool has_range = basis.to > basis.from;  // else it goes round its period
  const double from = has_range ? basis.from : 0, to = has_range ? basis.to : basis.period;
  std::vector<double> values(kSamples);
  SpreadOfMotion spread;
  for (int k = 0; k < kSamples; ++k) {
    values[static_cast<std::size_t>(k)] = basis.evaluate(from + (to - from) * k / (kSamples - 1), motion.coefficients);
    spread.mean += values[static_cast<std::size_t>(k)] / kSamples;
  }
  for (const double value : values) spread.largest = std::max(spread.largest, std::abs(value - spread.mean));
  return spread;
}

class SizeCheck {
 public:
  void check(const std::string& name, const char* what, double value, double limit, bool angle) {
    if (std::abs(value) <= limit) return;
    const double unit = angle ? 1 / kDegree : 1;
    const char* const unit_name = angle ? "deg" : "mm";
    found.push_back(
        {DistrustKind::implausible_size,
         fmt::format("{} {} {:.4g} {}, beyond the {:.3g} {} that a machine in use may have: an axis, its "
                     "direction or point, a unit or a number of the set-up is probably wrong in the input",
                     name, what, value * unit, unit_name, limit * unit, unit_name),
         {{std::string("value_") + unit_name, value * unit}, {std::string("limit_") + unit_name, limit * unit}}});
  }

  std::vector<Distrust> found;
};

}  // namespace

PlausibleSizes plausible_sizes(const Machine& machine, std::size_t axis) {
  const Axis& of = machine.axes[axis];
  const double size = size_of_machine(machine);
  const double travel = of.kind == AxisKind::linear ? of.travel_max - of.travel_min : size;
  return {.position = std::max(kLeastPosition, kLargestShare * size),
          .angle = kLargestAngle,
          .motion = std::max(kLeastMotion, kLargestShare * travel),
          .reversal_length = kLargestReversal,
          .reversal_angle = kLargestReversalAngle};
}

std::vector<Distrust> distrust_of_sizes(const Machine& machine, const ErrorSet& errors) {
  SizeCheck sizes;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.state != kNoState) continue;  // per unit of a factor, of which no usual size is known
    const PlausibleSizes limits = plausible_sizes(machine, motion.axis);
    const bool angle = is_rotation(motion.component);
    const SpreadOfMotion spread = spread_of(motion);
    const std::string name = error_motion_name(machine, motion.axis, motion.component);
    sizes.check(name, "is on average", spread.mean, angle ? limits.angle : limits.position, angle);
    sizes.check(name, "varies about its mean by", spread.largest, angle ? limits.angle : limits.motion, angle);
  }
  for (const LocationError& location : errors.locations) {
    if (location.state != kNoState) continue;
    const PlausibleSizes limits = plausible_sizes(machine, location.axis);
    const bool angle = is_rotation(location.component);
    sizes.check(location_error_name(machine, location.axis, location.component), "is", location.value,
                angle ? limits.angle : limits.position, angle);
  }
  for (const Reversal& reversal : errors.reversals) {
    const PlausibleSizes limits = plausible_sizes(machine, reversal.axis);
    const bool angle = machine.axes[reversal.axis].kind == AxisKind::rotary;
    sizes.check(reversal_name(machine, reversal.axis), "is", reversal.value,
                angle ? limits.reversal_angle : limits.reversal_length, angle);
  }
  if (!machine.axes.empty()) {
    const double limit = plausible_sizes(machine, 0).position;
    sizes.check("the tool offset error", "is", errors.tool_offset_error.norm(), limit, false);
  }
  return sizes.found;
}

}  // namespace abbe
