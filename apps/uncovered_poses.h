#pragma once

#include "abbe/verify/left_out_poses.h"

namespace abbe {

/// What --accept-uncovered does, for --help.
inline constexpr const char* kAcceptUncoveredWords =
    "Exit code 0 even if poses are left out, such as where the errors are not known";

/// The one rule of all commands that leave poses out: says on standard error how many have no result, if any.
/// @returns the exit code of the command: kNegative for poses left out unless that is accepted
int tell_left_out(const LeftOutPoses& left_out, bool accepted);

}  // namespace abbe
