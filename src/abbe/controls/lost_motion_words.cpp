#include "abbe/controls/lost_motion_words.h"

#include <fmt/format.h>

#include <vector>

namespace abbe {

std::string linuxcnc_backlash_text(const Machine& machine, const ErrorSet& errors) {
  std::string text;
  const std::vector<JointBacklash> all = linuxcnc_backlash(machine, errors);
  if (all.empty()) return text;
  text += "  reversal values are not in the file, because kinematics do not know directions; in LinuxCNC's ini file:\n";
  for (const JointBacklash& one : all) {
    const char* const unit = one.rotary ? "deg" : "mm";
    if (one.lost_motion > 0) {
      text += fmt::format("    {} = {:.7f}    ({}, {}; add what was set when the errors were measured)\n", one.setting,
                          one.lost_motion, one.axis, unit);
    } else {
      text += fmt::format("    {}    {:.7f} {} less than when the errors were measured ({}: no lost motion)\n",
                          one.setting, -one.lost_motion, unit, one.axis);
    }
  }
  return text;
}

}  // namespace abbe
