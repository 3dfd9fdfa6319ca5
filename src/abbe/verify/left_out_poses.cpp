#include "abbe/verify/left_out_poses.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace abbe {

std::string left_out_words(const LeftOutPoses& left_out) {
  std::vector<std::pair<std::size_t, const char*>> reasons;
  const auto add = [&](std::size_t count, const char* of_one, const char* of_several) {
    if (count > 0) reasons.emplace_back(count, count == 1 ? of_one : of_several);
  };
  add(left_out.not_covered, "lies outside the range in which the errors are known",
      "lie outside the range in which the errors are known");
  add(left_out.outside_travel, "needs corrected commands outside the travel",
      "need corrected commands outside the travel");
  add(left_out.not_reached, "cannot be reached with the axes that are corrected",
      "cannot be reached with the axes that are corrected");
  const std::string of_all = fmt::format("{} of {} {}", left_out.count(), left_out.all, left_out.what);
  if (reasons.size() == 1) {
    const char* const end = left_out.count() == 1 ? "it is left out" : "they are left out";
    return fmt::format("{} {}; {}", of_all, reasons.front().second, end);
  }
  std::string words = of_all + " are left out";
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    words += fmt::format("{} {} {}", i == 0 ? ":" : ",", reasons[i].first, reasons[i].second);
  }
  return words;
}

}  // namespace abbe
