#pragma once

#include "abbe/formats/machine/errors_file.h"
#include "abbe/verify/left_out_poses.h"

namespace abbe {

/// What --accept-uncovered does, for --help.
inline constexpr const char* kAcceptUncoveredWords =
    "Exit with code 0 even if poses are left out, for example where the errors are not known";

/// The one rule of all commands that leave poses out: says on standard error how many have no result, if any.
/// @returns the exit code of the command: kNegative for poses left out unless that is accepted
int tell_left_out(const LeftOutPoses& left_out, bool accepted);

/// The same of commands that leave no pose out: says which states lie beyond what the readings of the errors covered.
/// @param code  the exit code of the command otherwise
int tell_outside(const StateValues& at_state, int code);

}  // namespace abbe
