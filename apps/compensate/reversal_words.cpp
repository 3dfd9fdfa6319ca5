#include "compensate/reversal_words.h"

#include <fmt/format.h>

#include "abbe/machine/axis_unit.h"

namespace abbe {

std::string reversal_size(const Machine& machine, std::size_t axis, double value) {
  const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
  return fmt::format("{:.4g} {}", micro_per_unit(rotary) * value, micro_unit(rotary));
}

void print_linuxcnc_backlash(const Machine& machine, const ErrorSet& errors) {
  const std::vector<JointBacklash> all = linuxcnc_backlash(machine, errors);
  if (all.empty()) return;
  fmt::print("  reversal values are not in the file, kinematics do not know directions; in LinuxCNC's ini file:\n");
  for (const JointBacklash& one : all) {
    const char* const unit = one.rotary ? "deg" : "mm";
    if (one.lost_motion > 0) {
      fmt::print("    {} = {:.7f}    ({}, {}; more than that by what was set when the errors were measured)\n",
                 one.setting, one.lost_motion, one.axis, unit);
    } else {
      fmt::print("    {}    {:.7f} {} less than when the errors were measured ({}: no lost motion)\n", one.setting,
                 -one.lost_motion, unit, one.axis);
    }
  }
}

}  // namespace abbe
