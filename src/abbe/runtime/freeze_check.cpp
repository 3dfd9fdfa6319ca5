#include "abbe/runtime/freeze_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/coupling.h"
#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/runtime/frozen_couplings.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_machine.h"

namespace abbe {
namespace {

struct Free {
  void operator()(abbe_runtime* runtime) const { abbe_runtime_free(runtime); }
};

struct FreeStates {
  void operator()(abbe_runtime_states* states) const { abbe_runtime_states_free(states); }
};

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Range {
  double from = 0, to = 0;
};

/// Ends of travel and map, of an endless axis one turn; then those of the given states.
std::vector<Range> ranges_of(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan) {
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    Range range{axis.endless ? -std::numbers::pi : std::max(axis.travel_min, -frozen::kLongest),
                axis.endless ? std::numbers::pi : std::min(axis.travel_max, frozen::kLongest)};
    const std::array<double, 2> map = map_of(errors, i);
    if (is_coupled(machine, i) && !axis.endless) {
      const std::array<double, 2> known = commands_in_map(machine, errors, i);
      range = {known[0], known[1]};
    } else if (std::max(range.from, map[0]) <= std::min(range.to, map[1])) {
      range = {std::max(range.from, map[0]), std::min(range.to, map[1])};
    }
    ranges.push_back(range);
  }
  for (const std::size_t state : plan.given) ranges.push_back({plan.ranges[state].from, plan.ranges[state].to});
  return ranges;
}

/// Where errors are tried: nominal commands, and values of states as state_factor() takes them.
struct TriedPose {
  std::vector<double> nominal, given;
};

/// @param at  values of all ranges_of()
TriedPose tried_pose(const Machine& machine, const FrozenStatePlan& plan, const std::vector<double>& at) {
  TriedPose pose;
  pose.nominal.assign(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(machine.axes.size()));
  if (plan.any()) pose.given.assign(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < plan.given.size(); ++k) pose.given[plan.given[k]] = at[machine.axes.size() + k];
  return pose;
}

/// Values between the ends, at an end now and then.
std::vector<double> some_values(const std::vector<Range>& ranges, RandomStream& random) {
  std::vector<double> commands;
  for (const Range& range : ranges) {
    const double share = std::clamp(random.uniform(-0.1, 1.1), 0.0, 1.0);
    commands.push_back(range.from + share * (range.to - range.from));
  }
  return commands;
}

bool within_map(const abbe_runtime& runtime, const std::vector<double>& joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double position = position_at(runtime, joints.data(), i);
    if (!(position >= runtime.axis[i].map_min && position <= runtime.axis[i].map_max)) return false;
  }
  return true;
}

std::unique_ptr<abbe_runtime, Free> load(FrozenCompensation& result) {
  abbe_runtime* handle = nullptr;
  char text[128];
  if (abbe_runtime_load(result.bytes.data(), result.bytes.size(), text, sizeof text, &handle) != ABBE_OK)
    result.problem = text;
  return std::unique_ptr<abbe_runtime, Free>(handle);
}

/// Calls `each` with the machine with a tool and values of all ranges, for the poses that are tried: always the same.
template <typename Each>
void for_each_pose(const Machine& machine, const FreezeOptions& options, const std::vector<Range>& ranges, Each each) {
  RandomStream random(5);
  Machine with_tool = machine;
  for (const Eigen::Vector3d& tool : tools_tried(machine, options)) {
    with_tool.tool_offset = tool;
    for (std::size_t k = 0; k < options.poses; ++k) each(with_tool, some_values(ranges, random));
  }
}

/// A larger value of a function of values than at `start`, by steps of a half to a 1024th of their
/// ranges: random poses seldom come near a corner of the travel, where errors that add up are largest.
template <typename Function>
double climb(const std::vector<Range>& ranges, std::vector<double>& at, Function function) {
  constexpr int kHalvings = 10, kRounds = 20;
  double best = function(at);
  double share = 1;
  for (int halving = 0; halving < kHalvings; ++halving) {
    share /= 2;
    bool better = true;
    for (int round = 0; better && round < kRounds; ++round) {
      better = false;
      for (std::size_t i = 0; i < at.size(); ++i) {
        for (const double sign : {-1.0, 1.0}) {
          const double before = at[i];
          at[i] = std::clamp(before + sign * share * (ranges[i].to - ranges[i].from), ranges[i].from, ranges[i].to);
          const double value = function(at);
          if (value > best) {
            best = value;
            better = true;
          } else {
            at[i] = before;
          }
        }
      }
    }
  }
  return best;
}

/// How far errors move the tool point, mm.
class PointShift {
 public:
  PointShift(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan)
      : machine_(machine), errors_(errors), plan_(plan) {}
  double operator()(const Machine& with_tool, const std::vector<double>& at) const {
    const TriedPose pose = tried_pose(machine_, plan_, at);
    return (actual_workpiece_from_tool(with_tool, errors_, pose.nominal, pose.given).translation -
            nominal_workpiece_from_tool(with_tool, pose.nominal).translation)
        .norm();
  }

 private:
  const Machine& machine_;
  const ErrorSet& errors_;
  const FrozenStatePlan& plan_;
};

/// Puts tried states into the handle that has them.
void set_states(const Machine& machine, const FrozenStatePlan& plan, const TriedPose& pose,
                abbe_runtime_states* states) {
  std::vector<double> channels, lags;
  for (const std::size_t state : plan.states) {
    if (machine.states[state].kind == StateKind::measured) channels.push_back(pose.given[state]);
    if (machine.states[state].kind == StateKind::lag) lags.push_back(pose.given[state]);
  }
  abbe_runtime_states_set(states, channels.data(), lags.data());
}

}  // namespace

std::array<double, 2> map_of(const ErrorSet& errors, std::size_t axis) {
  std::array<double, 2> map{-frozen::kLongest, frozen::kLongest};
  for (const ErrorMotion& motion : errors.motions) {
    const Basis& basis = motion.basis;
    if (motion.axis != axis || (basis.covers(basis.from - 1e5) && basis.covers(basis.to + 1e5))) continue;
    const double spare = 1e-9 * (basis.to - basis.from);
    map[0] = std::max(map[0], basis.from - spare);
    map[1] = std::min(map[1], basis.to + spare);
  }
  return map;
}

std::array<double, 2> commands_in_map(const Machine& machine, const ErrorSet& errors, std::size_t axis) {
  const Axis& one = machine.axes[axis];
  const std::array<double, 2> map = map_of(errors, axis);
  const PositionLimits limits = commands_within(machine, axis, {map[0], map[1]});
  const double from = std::max(one.travel_min, limits.from), to = std::min(one.travel_max, limits.to);
  return from < to ? std::array<double, 2>{from, to} : std::array<double, 2>{one.travel_min, one.travel_max};
}

std::vector<Eigen::Vector3d> tools_tried(const Machine& machine, const FreezeOptions& options) {
  return {options.tool, -options.tool_length_min * machine.tool_direction,
          -options.tool_length_max * machine.tool_direction};
}

std::vector<double> largest_per_unit(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan,
                                     const FreezeOptions& options) {
  std::vector<double> all;
  const std::vector<Range> ranges = ranges_of(machine, errors, plan);
  for (std::size_t j = 0; j < plan.factors.size(); ++j) {
    const ErrorSet per_unit = errors_per_unit(plan, errors, j);
    const PointShift shift(machine, per_unit, plan);
    double largest = 0;
    std::vector<double> worst;
    for_each_pose(machine, options, ranges, [&](const Machine& with_tool, const std::vector<double>& at) {
      const double moved = shift(with_tool, at);
      if (!worst.empty() && !(moved > largest)) return;
      largest = moved;
      worst = at;
    });
    Machine with_tool = machine;
    for (const Eigen::Vector3d& tool : tools_tried(machine, options)) {
      with_tool.tool_offset = tool;
      std::vector<double> at = worst;
      largest = std::max(largest,
                         climb(ranges, at, [&](const std::vector<double>& there) { return shift(with_tool, there); }));
    }
    all.push_back(largest);
  }
  return all;
}

void survey_corrections(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                        const FrozenStatePlan& plan, FrozenCompensation& result) {
  const PointShift shift(machine, errors, plan);
  const auto turn = [&](const std::vector<double>& at) {
    const TriedPose pose = tried_pose(machine, plan, at);
    return angle(
        actual_workpiece_from_tool(machine, errors, pose.nominal, pose.given).rotation * machine.tool_direction,
        nominal_workpiece_from_tool(machine, pose.nominal).rotation * machine.tool_direction);
  };
  std::vector<double> moved_most, turned_most;
  const auto take = [&](const Machine& with_tool, const std::vector<double>& at) {
    const double moved = shift(with_tool, at);
    if (!moved_most.empty() && !(moved > result.largest_correction)) return;
    result.largest_correction = moved;
    moved_most = at;
    result.tool_length_there = -with_tool.tool_offset.dot(machine.tool_direction);
  };
  const std::vector<Range> ranges = ranges_of(machine, errors, plan);
  for_each_pose(machine, options, ranges, [&](const Machine& with_tool, const std::vector<double>& at) {
    take(with_tool, at);
    const double turned = turn(at);
    if (!turned_most.empty() && !(turned > result.largest_correction_turn)) return;
    result.largest_correction_turn = turned;
    turned_most = at;
  });
  Machine with_tool = machine;
  const std::vector<double> start = moved_most;
  for (const Eigen::Vector3d& tool : tools_tried(machine, options)) {
    with_tool.tool_offset = tool;
    std::vector<double> at = start;
    climb(ranges, at, [&](const std::vector<double>& there) { return shift(with_tool, there); });
    take(with_tool, at);
  }
  result.where = tried_pose(machine, plan, moved_most).nominal;
  result.largest_correction_turn = std::max(result.largest_correction_turn, climb(ranges, turned_most, turn));
}

void freeze_check(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                  const FrozenStatePlan& plan, FrozenCompensation& result) {
  const std::unique_ptr<abbe_runtime, Free> runtime = load(result);
  if (!runtime) return;
  abbe_runtime_states* made = nullptr;
  if (abbe_runtime_states_make(runtime.get(), nullptr, &made) != ABBE_OK) result.problem = "no memory";
  const std::unique_ptr<abbe_runtime_states, FreeStates> states(made);
  if (!states) return;
  const abbe_runtime* const used = abbe_runtime_at_states(states.get());
  result.point_axes = runtime->reaching.count;
  result.largest_joint.assign(machine.axes.size(), 0.0);
  result.largest_joint_at.assign(machine.axes.size(), {});
  const std::vector<Range> ranges = ranges_of(machine, errors, plan);
  for_each_pose(machine, options, ranges, [&](const Machine& with_tool, const std::vector<double>& at) {
    const TriedPose pose = tried_pose(machine, plan, at);
    const std::vector<double>& nominal = pose.nominal;
    if (!plan.given.empty()) set_states(machine, plan, pose, states.get());
    const double* const tool = with_tool.tool_offset.data();
    std::vector<double> joints(nominal), back(nominal);
    const RigidTransform wanted = nominal_workpiece_from_tool(with_tool, nominal);
    ++result.poses;
    abbe_runtime_state state;
    abbe_runtime_start(&state);
    const int called = abbe_runtime_correct(used, &state, nominal.data(), tool, 1, joints.data());
    const int status = called < 0 ? ABBE_POSITION_LEFT : called & ABBE_RESULT_MASK;
    if (status == ABBE_POSITION_LEFT) ++result.unreached;
    if (status == ABBE_TURN_LIMITED) ++result.limited;
    if (called < 0) return;
    result.worst_iterations = std::max(result.worst_iterations, state.iterations);
    abbe_runtime_start(&state);
    if (abbe_runtime_uncorrect(used, &state, joints.data(), tool, 1, back.data()) >= 0)
      result.worst_iterations = std::max(result.worst_iterations, state.iterations);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double correction = std::abs(joints[i] - nominal[i]);
      if (!result.largest_joint_at[i].empty() && !(correction > result.largest_joint[i])) continue;
      result.largest_joint[i] = correction;
      result.largest_joint_at[i] = nominal;
    }
    // Beyond the map nothing is known, by the full model neither.
    if (status == ABBE_POSITION_LEFT || !within_map(*runtime, joints)) return;
    ++result.points_compared;
    const RigidTransform alone = actual_workpiece_from_tool(with_tool, errors, joints, pose.given);
    result.difference = std::max(result.difference, (alone.translation - wanted.translation).norm());
    const RigidTransform after =
        options.all_errors ? actual_workpiece_from_tool(with_tool, *options.all_errors, joints, pose.given) : alone;
    result.accuracy = std::max(result.accuracy, (after.translation - wanted.translation).norm());
    if (status != ABBE_OK) return;
    // Machines without rotary axes for it do not correct the direction.
    if (runtime->turning.count == 0) return;
    ++result.directions_compared;
    const double turned = angle(after.rotation * machine.tool_direction, wanted.rotation * machine.tool_direction);
    result.accuracy_turn = std::max(result.accuracy_turn, turned);
  });
}

}  // namespace abbe
