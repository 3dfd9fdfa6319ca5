#include "abbe/controls/lost_motion.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/controls/joint_order.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

/// Digits of a position in mm or degrees: "0.012000".
std::string number_in_units(double value, bool rotary) {
  return rotary ? fmt::format("{:.7f}", value / kDegree) : fmt::format("{:.6f}", value);
}

}  // namespace

std::string lost_motion_words(double lost_motion, bool rotary) {
  return fmt::format("{} {} {} than when the errors were measured", number_in_units(std::abs(lost_motion), rotary),
                     rotary ? "deg" : "mm", lost_motion < 0 ? "less" : "more");
}

std::vector<JointBacklash> linuxcnc_backlash(const Machine& machine, const ErrorSet& errors) {
  const std::vector<std::size_t> order = joint_order(machine);
  std::vector<JointBacklash> all;
  for (std::size_t joint = 0; joint < order.size(); ++joint) {
    for (const Reversal& reversal : errors.reversals) {
      if (reversal.axis != order[joint] || reversal.value == 0) continue;
      const Axis& axis = machine.axes[reversal.axis];
      const bool rotary = axis.kind == AxisKind::rotary;
      all.push_back(
          {axis.name, fmt::format("[JOINT_{}]BACKLASH", joint), -reversal.value * (1 / position_unit(axis)), rotary});
    }
  }
  return all;
}

}  // namespace abbe
