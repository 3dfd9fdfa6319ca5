#include "abbe/study/identification/turn_coverage.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe {

bool covers_turn(std::span<const double> positions, const Basis& basis) {
  if (positions.empty()) return false;
  const double widest = basis.period / (2.0 * basis.order + 1.0) + 1e-9 * basis.period;
  // Each part is half as wide as the widest gap that is allowed, so no gap that is too wide lies within one part.
  struct Part {
    bool empty = true;
    double first = 0, last = 0;
  };
  std::vector<Part> parts(4 * static_cast<std::size_t>(basis.order) + 2);
  for (const double position : positions) {
    const double turns = position / basis.period;
    const double around = turns - std::floor(turns);
    const double place = around * static_cast<double>(parts.size());
    Part& part = parts[std::min(static_cast<std::size_t>(place), parts.size() - 1)];
    const double from_zero = around * basis.period;
    part.first = part.empty ? from_zero : std::min(part.first, from_zero);
    part.last = part.empty ? from_zero : std::max(part.last, from_zero);
    part.empty = false;
  }
  const auto is_filled = [](const Part& part) { return !part.empty; };
  double before = std::find_if(parts.rbegin(), parts.rend(), is_filled)->last - basis.period;
  for (const Part& part : parts) {
    if (part.empty) continue;
    if (part.first - before > widest) return false;
    before = part.last;
  }
  return true;
}

}  // namespace abbe
