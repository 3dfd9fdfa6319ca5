#include "abbe/instruments/further_readings.h"

#include <algorithm>
#include <numbers>

namespace abbe {

std::vector<TrialRange> measured_ranges(const Machine& machine, const PoseList& poses) {
  std::vector<TrialRange> ranges;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::vector<double>& values = poses.axis[i];
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    TrialRange range;
    if (!values.empty()) range = {*low, *high};
    const Axis& axis = machine.axes[i];
    // Steps of a whole turn leave the last one out; the axis moved over all of it nevertheless.
    if (axis.kind == AxisKind::rotary && range.to - range.from > std::numbers::pi)
      range.to = std::max(range.to, axis.endless ? range.from + 2 * std::numbers::pi : axis.travel_max);
    ranges.push_back(range);
  }
  return ranges;
}

TrialRange whole_travel(const Axis& axis) {
  if (axis.endless) return {0, 2 * std::numbers::pi};
  return {axis.travel_min, axis.travel_max};
}

}  // namespace abbe
