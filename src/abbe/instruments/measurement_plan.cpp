#include "abbe/instruments/measurement_plan.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// @param either_way  ranges may also run downwards
void check_ranges(const Machine& machine, const std::vector<AxisRange>& ranges, bool either_way = false) {
  if (ranges.size() != machine.axes.size()) {
    throw std::invalid_argument("plan with " + std::to_string(ranges.size()) + " ranges for " +
                                std::to_string(machine.axes.size()) + " axes");
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const AxisRange& range = ranges[i];
    if (!std::isfinite(range.from) || !std::isfinite(range.to) || (range.to < range.from && !either_way) ||
        !(range.step >= 0)) {
      throw std::invalid_argument("plan: range of " + axis.name +
                                  (either_way ? " must be finite, its step not negative"
                                              : " must be finite and increasing, its step not negative"));
    }
    const double spare = 1e-9 * (axis.travel_max - axis.travel_min);
    if (!axis.endless && (std::min(range.from, range.to) < axis.travel_min - spare ||
                          std::max(range.from, range.to) > axis.travel_max + spare)) {
      throw std::invalid_argument("plan: range of " + axis.name + " is outside its travel");
    }
  }
}

std::vector<std::vector<double>> empty_columns(std::size_t axes, std::size_t count) {
  return std::vector<std::vector<double>>(axes, std::vector<double>(count));
}

bool is_whole_turn(const Axis& axis, const AxisRange& range) {
  return axis.kind == AxisKind::rotary && std::abs(range.to - range.from - kTurn) < 1e-9;
}

double span_of(const Axis& axis) { return axis.endless ? kTurn : axis.travel_max - axis.travel_min; }

/// One multiple of the step inside the range, every multiple with the same probability.
double draw_position(const AxisRange& range, RandomStream& random) {
  const double share = random.uniform();
  if (range.step <= 0) return range.from + share * (range.to - range.from);
  const double first = std::ceil(range.from / range.step - 1e-9), last = std::floor(range.to / range.step + 1e-9);
  if (last < first) return range.from;
  return std::clamp(range.step * (first + std::floor(share * (last - first + 1))), range.from, range.to);
}

}  // namespace

std::vector<AxisRange> full_ranges(const Machine& machine, std::size_t count_per_axis) {
  std::vector<AxisRange> ranges;
  for (const Axis& axis : machine.axes) {
    const double from = axis.endless ? 0 : axis.travel_min;
    const double to = axis.endless ? kTurn : axis.travel_max;
    ranges.push_back({from, to, from == to ? 1 : count_per_axis, 0});
  }
  return ranges;
}

PoseList grid_plan(const Machine& machine, const std::vector<AxisRange>& ranges) {
  check_ranges(machine, ranges);
  std::vector<std::vector<double>> values;
  std::size_t count = 1;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const AxisRange& range = ranges[i];
    if (range.count == 0) throw std::invalid_argument("plan: no position of " + machine.axes[i].name);
    if (range.is_fixed()) {
      values.push_back({range.from});
    } else if (is_whole_turn(machine.axes[i], range)) {
      values.push_back(evenly_spaced(range.from, range.to, range.count + 1));
      values.back().pop_back();
    } else {
      values.push_back(evenly_spaced(range.from, range.to, range.count));
    }
    if (values.back().size() > 200'000'000 / count) throw std::invalid_argument("plan: more than 200,000,000 poses");
    count *= values.back().size();
  }
  PoseList plan{empty_columns(values.size(), count)};
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t before = k, block = count;
    // Every second pass of a faster axis runs backwards, counted over all slower axes.
    std::size_t passes = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t n = values[i].size();
      block /= n;
      const std::size_t index = before / block;
      before %= block;
      plan.axis[i][k] = values[i][passes % 2 == 0 ? index : n - 1 - index];
      passes = passes * n + index;
    }
  }
  return plan;
}

PoseList line_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count) {
  check_ranges(machine, ranges, true);
  PoseList plan;
  for (const AxisRange& range : ranges) plan.axis.push_back(evenly_spaced(range.from, range.to, count));
  return plan;
}

PoseList step_diagonal_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t steps,
                            const std::vector<std::size_t>& order) {
  check_ranges(machine, ranges, true);
  if (steps == 0) throw std::invalid_argument("step diagonal: no step");
  std::vector<std::uint8_t> moves(ranges.size(), 0);
  for (const std::size_t axis : order) {
    if (axis >= ranges.size() || moves[axis] != 0) {
      throw std::invalid_argument("step diagonal: the order names an axis that is not there, or names it twice");
    }
    moves[axis] = 1;
  }
  std::vector<double> positions;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (moves[i] == 0 && !ranges[i].is_fixed()) {
      throw std::invalid_argument("step diagonal: " + machine.axes[i].name + " is not in the order of the axes");
    }
    positions.push_back(ranges[i].from);
  }
  PoseList plan;
  plan.append(positions);
  for (std::size_t step = 1; step <= steps; ++step) {
    for (const std::size_t axis : order) {
      const double share = static_cast<double>(step) / static_cast<double>(steps);
      // The last step ends at `to` itself, whatever rounding does.
      positions[axis] =
          step == steps ? ranges[axis].to : ranges[axis].from + share * (ranges[axis].to - ranges[axis].from);
      plan.append(positions);
    }
  }
  return plan;
}

PoseList random_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count,
                     std::uint64_t seed) {
  check_ranges(machine, ranges);
  PoseList plan{empty_columns(ranges.size(), count)};
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(seed, k);
    for (std::size_t i = 0; i < ranges.size(); ++i) plan.axis[i][k] = draw_position(ranges[i], random);
  }
  return plan;
}

PoseList spiral_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count, double turns,
                     std::size_t first_axis, std::size_t second_axis) {
  check_ranges(machine, ranges);
  if (first_axis >= ranges.size() || second_axis >= ranges.size() || first_axis == second_axis || !(turns > 0)) {
    throw std::invalid_argument("spiral: two different axes and a positive number of turns are needed");
  }
  PoseList plan = line_plan(machine, ranges, count);
  for (std::size_t k = 0; k < count; ++k) {
    const double share = count > 1 ? static_cast<double>(k) / static_cast<double>(count - 1) : 0;
    // Radius with the root of the share: the same number of poses per area.
    const double radius = std::sqrt(share), angle = kTurn * turns * radius;
    const auto place = [&](std::size_t i, double unit) {
      const double centre = 0.5 * (ranges[i].from + ranges[i].to), half = 0.5 * (ranges[i].to - ranges[i].from);
      plan.axis[i][k] = std::clamp(centre + half * unit, ranges[i].from, ranges[i].to);
    };
    place(first_axis, radius * std::cos(angle));
    place(second_axis, radius * std::sin(angle));
  }
  return plan;
}

namespace {

double distance(const std::vector<double>& spans, const PoseList& poses, std::size_t a, std::size_t b) {
  double largest = 0;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    if (spans[i] > 0) largest = std::max(largest, std::abs(poses.axis[i][a] - poses.axis[i][b]) / spans[i]);
  }
  return largest;
}

std::vector<double> spans(const Machine& machine) {
  std::vector<double> result;
  for (const Axis& axis : machine.axes) result.push_back(span_of(axis));
  return result;
}

}  // namespace

double travel(const Machine& machine, const PoseList& poses) {
  const std::vector<double> widths = spans(machine);
  double sum = 0;
  for (std::size_t k = 1; k < poses.count(); ++k) sum += distance(widths, poses, k - 1, k);
  return sum;
}

PoseList order_by_travel(const Machine& machine, const PoseList& poses) {
  const std::size_t n = poses.count();
  if (n < 3) return poses;
  const std::vector<double> widths = spans(machine);
  std::vector<std::size_t> order{0};
  std::vector<std::size_t> left;
  for (std::size_t k = 1; k < n; ++k) left.push_back(k);
  while (!left.empty()) {
    std::size_t nearest = 0;
    double least = distance(widths, poses, order.back(), left[0]);
    for (std::size_t i = 1; i < left.size(); ++i) {
      const double d = distance(widths, poses, order.back(), left[i]);
      if (d < least) {
        least = d;
        nearest = i;
      }
    }
    order.push_back(left[nearest]);
    // Order of the rest decides ties only; filling the gap with the last one keeps it quick.
    left[nearest] = left.back();
    left.pop_back();
  }
  const auto between = [&](std::size_t i, std::size_t j) { return distance(widths, poses, order[i], order[j]); };
  for (int round = 0; round < 20; ++round) {
    bool better = false;
    for (std::size_t i = 0; i + 2 < n; ++i) {
      for (std::size_t j = i + 2; j < std::min(n, i + 52); ++j) {
        const double now = between(i, i + 1) + (j + 1 < n ? between(j, j + 1) : 0);
        const double then = between(i, j) + (j + 1 < n ? between(i + 1, j + 1) : 0);
        if (then < now - 1e-12) {
          std::reverse(order.begin() + static_cast<std::ptrdiff_t>(i + 1),
                       order.begin() + static_cast<std::ptrdiff_t>(j + 1));
          better = true;
        }
      }
    }
    if (!better) break;
  }
  PoseList ordered{empty_columns(poses.axis.size(), n)};
  for (std::size_t i = 0; i < poses.axis.size(); ++i) {
    for (std::size_t k = 0; k < n; ++k) ordered.axis[i][k] = poses.axis[i][order[k]];
  }
  for (const std::vector<double>& values : poses.state) {
    std::vector<double>& moved = ordered.state.emplace_back();
    for (std::size_t k = 0; k < values.size(); ++k) moved.push_back(values[order[k]]);
  }
  return ordered;
}

PoseList join(const PoseList& first, const PoseList& second) {
  if (first.axis.empty()) return second;
  if (second.axis.empty()) return first;
  if (first.axis.size() != second.axis.size()) throw std::invalid_argument("plans with different numbers of axes");
  PoseList both = first;
  for (std::size_t i = 0; i < both.axis.size(); ++i) {
    both.axis[i].insert(both.axis[i].end(), second.axis[i].begin(), second.axis[i].end());
  }
  return both;
}

}  // namespace abbe
