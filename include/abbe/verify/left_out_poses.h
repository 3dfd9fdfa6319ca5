#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace abbe {

/// Poses that have no result, by reason.
struct LeftOutPoses {
  std::size_t all = 0;             ///< poses asked for, with and without a result
  std::size_t not_covered = 0;     ///< outside the range in which the errors are known
  std::size_t outside_travel = 0;  ///< their corrected commands leave the travel
  std::size_t not_reached = 0;     ///< no command of the axes that are corrected reaches the point
  const char* what = "poses of the map";
  std::vector<std::string> extrapolated{};  ///< what of all poses lies beyond what was measured, a sentence each

  std::size_t count() const { return not_covered + outside_travel + not_reached; }
};

/// That poses have no result, and why: "2 of 6 poses of the map lie outside the range in which the errors are known;
/// they are left out".
std::string left_out_words(const LeftOutPoses& left_out);

}  // namespace abbe
