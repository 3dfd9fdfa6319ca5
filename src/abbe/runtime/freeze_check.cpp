#include "abbe/runtime/freeze_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/runtime/frozen_machine.h"

namespace abbe {
namespace {

struct Free {
  void operator()(abbe_runtime* runtime) const { abbe_runtime_free(runtime); }
};

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Range {
  double from = 0, to = 0;
};

/// Ends of travel and map; of an endless axis one turn.
std::vector<Range> ranges_of(const Machine& machine, const abbe_runtime& runtime) {
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    abbe_runtime_axis axis;
    abbe_runtime_describe_axis(&runtime, static_cast<int>(i), &axis);
    Range range{axis.endless != 0 ? -std::numbers::pi : axis.travel_min,
                axis.endless != 0 ? std::numbers::pi : axis.travel_max};
    if (std::max(range.from, axis.map_min) <= std::min(range.to, axis.map_max))
      range = {std::max(range.from, axis.map_min), std::min(range.to, axis.map_max)};
    ranges.push_back(range);
  }
  return ranges;
}

/// Commands between the ends, at an end now and then.
std::vector<double> some_commands(const std::vector<Range>& ranges, RandomStream& random) {
  std::vector<double> commands;
  for (const Range& range : ranges) {
    const double share = std::clamp(random.uniform(-0.1, 1.1), 0.0, 1.0);
    commands.push_back(range.from + share * (range.to - range.from));
  }
  return commands;
}

bool within_map(const abbe_runtime& runtime, const std::vector<double>& joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!(joints[i] >= runtime.axis[i].map_min && joints[i] <= runtime.axis[i].map_max)) return false;
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

/// Calls `each` with the machine with a tool and nominal commands, for the poses that are tried: always the same ones.
template <typename Each>
void for_each_pose(const Machine& machine, const FreezeOptions& options, const abbe_runtime& runtime, Each each) {
  RandomStream random(5);
  const std::vector<Range> ranges = ranges_of(machine, runtime);
  Machine with_tool = machine;
  for (const Eigen::Vector3d& tool : tools_tried(machine, options)) {
    with_tool.tool_offset = tool;
    for (std::size_t k = 0; k < options.poses; ++k) each(with_tool, some_commands(ranges, random));
  }
}

/// A larger value of a function of the commands than at `start`, by steps along the axes of a half to a 1024th of their
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

}  // namespace

std::vector<Eigen::Vector3d> tools_tried(const Machine& machine, const FreezeOptions& options) {
  return {options.tool, -options.tool_length_min * machine.tool_direction,
          -options.tool_length_max * machine.tool_direction};
}

void survey_corrections(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                        FrozenCompensation& result) {
  const std::unique_ptr<abbe_runtime, Free> runtime = load(result);
  if (!runtime) return;
  const auto shift = [&](const Machine& with_tool, const std::vector<double>& nominal) {
    return (actual_workpiece_from_tool(with_tool, errors, nominal).translation -
            nominal_workpiece_from_tool(with_tool, nominal).translation)
        .norm();
  };
  const auto turn = [&](const std::vector<double>& nominal) {
    return angle(actual_workpiece_from_tool(machine, errors, nominal).rotation * machine.tool_direction,
                 nominal_workpiece_from_tool(machine, nominal).rotation * machine.tool_direction);
  };
  const auto take = [&](const Machine& with_tool, const std::vector<double>& nominal) {
    const double moved = shift(with_tool, nominal);
    if (!result.where.empty() && !(moved > result.largest_correction)) return;
    result.largest_correction = moved;
    result.where = nominal;
    result.tool_length_there = -with_tool.tool_offset.dot(machine.tool_direction);
  };
  std::vector<double> turned_most;
  for_each_pose(machine, options, *runtime, [&](const Machine& with_tool, const std::vector<double>& nominal) {
    take(with_tool, nominal);
    const double turned = turn(nominal);
    if (!turned_most.empty() && !(turned > result.largest_correction_turn)) return;
    result.largest_correction_turn = turned;
    turned_most = nominal;
  });
  const std::vector<Range> ranges = ranges_of(machine, *runtime);
  Machine with_tool = machine;
  const std::vector<double> start = result.where;
  for (const Eigen::Vector3d& tool : tools_tried(machine, options)) {
    with_tool.tool_offset = tool;
    std::vector<double> at = start;
    climb(ranges, at, [&](const std::vector<double>& nominal) { return shift(with_tool, nominal); });
    take(with_tool, at);
  }
  result.largest_correction_turn = std::max(result.largest_correction_turn, climb(ranges, turned_most, turn));
}

void freeze_check(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                  FrozenCompensation& result) {
  const std::unique_ptr<abbe_runtime, Free> runtime = load(result);
  if (!runtime) return;
  result.point_axes = runtime->reaching.count;
  result.largest_joint.assign(machine.axes.size(), 0.0);
  result.largest_joint_at.assign(machine.axes.size(), {});
  for_each_pose(machine, options, *runtime, [&](const Machine& with_tool, const std::vector<double>& nominal) {
    const double* const tool = with_tool.tool_offset.data();
    std::vector<double> joints(nominal), back(nominal);
    const RigidTransform wanted = nominal_workpiece_from_tool(with_tool, nominal);
    ++result.poses;
    abbe_runtime_state state;
    abbe_runtime_start(&state);
    const int called = abbe_runtime_correct(runtime.get(), &state, nominal.data(), tool, 1, joints.data());
    const int status = called < 0 ? ABBE_POSITION_LEFT : called & ABBE_RESULT_MASK;
    if (status == ABBE_POSITION_LEFT) ++result.unreached;
    if (status == ABBE_TURN_LIMITED) ++result.limited;
    if (called < 0) return;
    result.worst_iterations = std::max(result.worst_iterations, state.iterations);
    abbe_runtime_start(&state);
    if (abbe_runtime_uncorrect(runtime.get(), &state, joints.data(), tool, 1, back.data()) >= 0)
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
    const RigidTransform alone = actual_workpiece_from_tool(with_tool, errors, joints);
    result.difference = std::max(result.difference, (alone.translation - wanted.translation).norm());
    const RigidTransform after =
        options.all_errors ? actual_workpiece_from_tool(with_tool, *options.all_errors, joints) : alone;
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
