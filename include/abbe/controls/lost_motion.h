#pragma once

#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "0.012000 mm more than when the errors were measured"; less where the lost motion is below zero.
/// @param lost_motion  mm or rad
std::string lost_motion_words(double lost_motion, bool rotary);

/// A setting of LinuxCNC's own backlash compensation for a joint.
struct JointBacklash {
  std::string axis, setting;  ///< "X", "[JOINT_0]BACKLASH"
  double lost_motion = 0;     ///< minus the reversal value, mm or deg
  bool rotary = false;
};
/// For all joints with a reversal value, in the default order of the LinuxCNC module.
std::vector<JointBacklash> linuxcnc_backlash(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
