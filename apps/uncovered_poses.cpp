#include "uncovered_poses.h"

#include <fmt/format.h>

#include "exit_code.h"
#include "messages.h"

namespace abbe {

std::string uncovered_words(std::size_t left_out, std::size_t all) {
  return fmt::format("{} of {} poses of the map lie outside the range in which the errors are known; they are left out",
                     left_out, all);
}

int tell_uncovered(std::size_t left_out, std::size_t all, bool accepted) {
  if (left_out == 0) return kDone;
  tell("abbe: {}{}\n", uncovered_words(left_out, all), accepted ? "" : " (--accept-uncovered: exit code 0)");
  return accepted ? kDone : kNegative;
}

}  // namespace abbe
