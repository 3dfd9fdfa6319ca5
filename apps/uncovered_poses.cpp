#include "uncovered_poses.h"

#include "exit_code.h"
#include "messages.h"

namespace abbe {

int tell_outside(const StateValues& at_state, int code) {
  for (const std::string& sentence : at_state.outside) tell("abbe: {}\n", sentence);
  return at_state.outside.empty() || code != kDone ? code : kNegative;
}

int tell_left_out(const LeftOutPoses& left_out, bool accepted) {
  if (left_out.count() == 0 && left_out.extrapolated.empty()) return kDone;
  const char* const way_out = accepted ? "" : " (--accept-uncovered: exit code 0)";
  for (const std::string& sentence : left_out.extrapolated) tell("abbe: {}{}\n", sentence, way_out);
  if (left_out.count() > 0) tell("abbe: {}{}\n", left_out_words(left_out), way_out);
  return accepted ? kDone : kNegative;
}

}  // namespace abbe
