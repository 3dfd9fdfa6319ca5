#include "abbe/errors/poses.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace abbe {

std::vector<double> positions_of_axis(const Machine& machine, const PoseList& poses, std::size_t axis) {
  std::vector<double> positions = poses.axis[axis];
  for (const AxisCoupling& coupling : machine.couplings) {
    if (coupling.axis != axis) continue;
    for (std::size_t k = 0; k < positions.size(); ++k) positions[k] += coupling.ratio * poses.axis[coupling.of][k];
  }
  return positions;
}

PoseSource pose_source(const PoseList& list) {
  PoseSource source{list.axis.size(), list.count(),
                    [&list](std::size_t first, std::size_t number, double* const* axis) {
                      for (std::size_t i = 0; i < list.axis.size(); ++i) {
                        std::copy_n(&list.axis[i][first], number, axis[i]);
                      }
                    }};
  if (list.state.empty()) return source;
  source.states = list.state.size();
  source.fill_states = [&list](std::size_t first, std::size_t number, double* const* state) {
    for (std::size_t j = 0; j < list.state.size(); ++j) {
      if (list.state[j].empty()) {
        std::fill_n(state[j], number, std::numeric_limits<double>::quiet_NaN());
      } else {
        std::copy_n(&list.state[j][first], number, state[j]);
      }
    }
  };
  return source;
}

PoseSource at_states(PoseSource poses, std::vector<double> values) {
  poses.states = values.size();
  poses.fill_states = [values = std::move(values)](std::size_t, std::size_t number, double* const* state) {
    for (std::size_t j = 0; j < values.size(); ++j) std::fill_n(state[j], number, values[j]);
  };
  return poses;
}

PoseSource pose_source(PoseGrid grid) {
  const std::size_t axes = grid.values.size();
  const std::size_t count = grid.count();
  return {axes, count, [values = std::move(grid.values)](std::size_t first, std::size_t number, double* const* axis) {
            // Every axis repeats each of its positions `repeat` times, then starts again.
            std::size_t repeat = 1;
            for (std::size_t i = values.size(); i-- > 0;) {
              std::size_t index = first / repeat % values[i].size();
              std::size_t left = repeat - first % repeat;
              for (std::size_t k = 0; k < number;) {
                const std::size_t run = std::min(left, number - k);
                std::fill_n(axis[i] + k, run, values[i][index]);
                k += run;
                index = index + 1 == values[i].size() ? 0 : index + 1;
                left = repeat;
              }
              repeat *= values[i].size();
            }
          }};
}

std::vector<std::vector<std::int8_t>> approach_in_order(const PoseList& poses) {
  std::vector<std::vector<std::int8_t>> approach;
  for (const std::vector<double>& commands : poses.axis) {
    std::vector<std::int8_t>& sides = approach.emplace_back(commands.size(), std::int8_t{0});
    for (std::size_t k = 1; k < commands.size(); ++k) {
      const double motion = commands[k] - commands[k - 1];
      sides[k] = motion > 0 ? std::int8_t{1} : motion < 0 ? std::int8_t{-1} : sides[k - 1];
    }
  }
  return approach;
}

void join_labels(std::vector<std::string>& all, std::size_t count, const std::vector<std::string>& more,
                 std::size_t more_count) {
  if (all.empty() && more.empty()) return;
  all.resize(count);
  all.insert(all.end(), more.begin(), more.end());
  all.resize(count + more_count);
}

namespace {

void join_states(PoseList& all, std::size_t before, const PoseList& more) {
  const double not_given = std::numeric_limits<double>::quiet_NaN();
  all.state.resize(std::max(all.state.size(), more.state.size()));
  for (std::size_t j = 0; j < all.state.size(); ++j) {
    const bool has_more = j < more.state.size() && !more.state[j].empty();
    std::vector<double>& values = all.state[j];
    if (values.empty() && !has_more) continue;
    values.resize(before, not_given);
    if (has_more) values.insert(values.end(), more.state[j].begin(), more.state[j].end());
    values.resize(all.count(), not_given);
  }
}

}  // namespace

void join_poses(PoseList& all, const PoseList& more) {
  const std::size_t before = all.count();
  all.axis.resize(more.axis.size());
  for (std::size_t i = 0; i < more.axis.size(); ++i) {
    all.axis[i].insert(all.axis[i].end(), more.axis[i].begin(), more.axis[i].end());
  }
  join_states(all, before, more);
  if (all.approach.empty() && more.approach.empty()) return;
  all.approach.resize(more.axis.size());
  for (std::size_t i = 0; i < more.axis.size(); ++i) {
    std::vector<std::int8_t>& sides = all.approach[i];
    sides.resize(before, 0);
    if (!more.approach.empty()) sides.insert(sides.end(), more.approach[i].begin(), more.approach[i].end());
    sides.resize(all.count(), 0);
  }
}

std::vector<double> evenly_spaced(double from, double to, std::size_t count) {
  std::vector<double> values(count);
  if (count == 1) values[0] = 0.5 * (from + to);
  for (std::size_t i = 0; count > 1 && i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    // Ends exactly at `to`, or a position at the limit of the travel would fall outside by rounding.
    values[i] = i + 1 == count ? to : from + share * (to - from);
  }
  return values;
}

}  // namespace abbe
