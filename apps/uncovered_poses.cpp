#include "uncovered_poses.h"

#include "exit_code.h"
#include "messages.h"

namespace abbe {

int tell_left_out(const LeftOutPoses& left_out, bool accepted) {
  if (left_out.count() == 0) return kDone;
  tell("abbe: {}{}\n", left_out_words(left_out), accepted ? "" : " (--accept-uncovered: exit code 0)");
  return accepted ? kDone : kNegative;
}

}  // namespace abbe
