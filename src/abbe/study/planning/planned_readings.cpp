#include "abbe/study/planning/planned_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "abbe/formats/readings/planned_poses.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/path_plan.h"

namespace abbe {
namespace {

PoseList poses_once(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed) {
  const std::size_t points = static_cast<std::size_t>(std::max(plan.points, 0));
  if (plan.kind == PlanKind::line) return line_plan(machine, plan.axes, points);
  if (plan.kind == PlanKind::step_diagonal) return step_diagonal_plan(machine, plan.axes, plan.steps, plan.order);
  if (plan.kind == PlanKind::random) return random_plan(machine, plan.axes, points, seed);
  if (plan.kind != PlanKind::spiral) return grid_plan(machine, plan.axes);
  // The two axes of largest range carry the ellipse.
  std::vector<std::size_t> order(plan.axes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto extent = [&](std::size_t i) {
    const Axis& axis = machine.axes[i];
    const double whole = axis.travel_max - axis.travel_min;
    return whole > 0 ? (plan.axes[i].to - plan.axes[i].from) / whole : plan.axes[i].to - plan.axes[i].from;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extent(a) > extent(b); });
  return spiral_plan(machine, plan.axes, points, plan.turns, order.at(0), order.at(1));
}

/// A pose of a file with what is measured there.
struct PlannedTargets {
  PoseList poses;
  std::vector<std::size_t> target, station;  ///< [poses]
  std::vector<std::size_t> row;              ///< [poses] of the file
  PoseList file;                             ///< poses of the file, with their states
  std::vector<double> time_s;                ///< [poses] or empty

  /// Goes through the same poses again, forwards or backwards.
  void repeat(const PlannedTargets& once, bool backwards) {
    const auto join = [backwards](std::vector<std::size_t>& all, const std::vector<std::size_t>& more) {
      if (backwards) {
        all.insert(all.end(), more.rbegin(), more.rend());
      } else {
        all.insert(all.end(), more.begin(), more.end());
      }
    };
    join(target, once.target);
    join(station, once.station);
    join(row, once.row);
  }
};

/// The rows of a file in their order, each with its target, or with all of the plan where the file names none; repeated
/// as the plan says.
PlannedTargets planned_targets(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                               const ChannelUse& channels) {
  PlannedPoses planned = read_planned_poses(plan.file, machine, setup, channels);
  if (!planned.time_s.empty() && plan.repeats > 1) {
    throw InputError({plan.file.string(), 0, 0, "time"},
                     fmt::format("the poses are gone through {} times", plan.repeats),
                     "repeats = 1, and rows with times of their own for each time");
  }
  PlannedTargets once;
  for (std::size_t k = 0; k < planned.poses.count(); ++k) {
    for (const std::size_t target : planned.target.empty() ? plan.targets : std::vector{planned.target[k]}) {
      once.poses.append(planned.poses.pose(k));
      once.target.push_back(target);
      once.station.push_back(planned.station.empty() ? 0 : planned.station[k]);
      once.row.push_back(k);
    }
  }
  PlannedTargets all;
  all.poses = repeated(once.poses, plan.repeats, plan.there_and_back);
  for (const std::size_t row : planned.time_s.empty() ? std::vector<std::size_t>() : once.row) {
    all.time_s.push_back(planned.time_s[row]);
  }
  for (std::size_t r = 0; r < plan.repeats; ++r) all.repeat(once, plan.there_and_back && r % 2 == 1);
  all.file = std::move(planned.poses);
  return all;
}

/// Poses of a plan for one target; those with points that meet are items.
PoseList target_poses(const Machine& machine, const Setup& setup, const MeasurementPlan& plan, std::size_t target,
                      std::uint64_t seed) {
  const Instrument& device = *setup.device;
  if (plan.kind != PlanKind::circle && plan.kind != PlanKind::follow) return plan_poses(machine, plan, seed);
  const std::optional<MeetingPoints> points = device.meeting_points(target);
  if (!points) {
    throw std::invalid_argument(device.name() + " has no points that meet; use a plan of another kind");
  }
  const InstrumentItem& ends = device.items()[target];
  PoseList poses;
  if (plan.kind == PlanKind::circle) {
    std::vector<double> positions;
    for (const AxisRange& range : plan.axes) positions.push_back(range.from);
    poses = circle_plan(machine, positions, ends.from, ends.to, *points, plan.circle);
  } else {
    poses = follow_plan(machine, grid_plan(machine, plan.axes), ends.from, ends.to, *points, plan.displacement);
  }
  return repeated(poses, plan.repeats, plan.there_and_back);
}

}  // namespace

std::uint64_t plan_seed(const Study& study, std::size_t setup, std::size_t plan) {
  return study.seed * 1000003 + setup * 1009 + plan;
}

PoseList plan_poses(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed) {
  return repeated(poses_once(machine, plan, seed), plan.repeats, plan.there_and_back);
}

PlannedReadings planned_readings(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                                 std::uint64_t seed, const ChannelUse& channels) {
  const Instrument& device = *setup.device;
  PlannedReadings planned;
  InstrumentReadings& readings = planned.readings;
  std::size_t target = 0;
  const auto append = [&](std::size_t station, const std::vector<double>& pose) {
    const std::size_t item = device.item_at(machine, target, station, pose);
    for (const std::vector<double>& inputs : device.planned_inputs(item)) readings.append(pose, item, inputs);
  };
  try {
    // A file goes from row to row, whatever their targets.
    if (plan.kind == PlanKind::poses) {
      const PlannedTargets rows = planned_targets(machine, setup, plan, channels);
      for (std::size_t n = 0; n < rows.poses.count(); ++n) {
        target = rows.target[n];
        append(rows.station[n], rows.poses.pose(n));
        if (!rows.time_s.empty()) readings.time_s.resize(readings.count(), rows.time_s[n]);
        readings.poses.state.resize(rows.file.state.size());
        for (std::size_t j = 0; j < rows.file.state.size(); ++j) {
          if (rows.file.state[j].empty()) continue;
          readings.poses.state[j].resize(readings.count(), rows.file.state[j][rows.row[n]]);
        }
      }
      return planned;
    }
    if (device.targets_share_poses()) {
      const PoseList poses = target_poses(machine, setup, plan, plan.targets.front(), seed);
      for (std::size_t k = 0; k < poses.count(); ++k) {
        for (const std::size_t one : plan.targets) {
          target = one;
          append(plan.station, poses.pose(k));
        }
        if (k == 0) planned.per_pose = readings.count();
      }
      return planned;
    }
    for (const std::size_t one : plan.targets) {
      target = one;
      const PoseList poses = target_poses(machine, setup, plan, target, seed);
      for (std::size_t k = 0; k < poses.count(); ++k) append(plan.station, poses.pose(k));
    }
  } catch (const std::invalid_argument& error) {
    throw InputError({.file = setup.name, .field = "plan"},
                     fmt::format("{}: {}", device.target_names()[target], error.what()),
                     "poses at which it can be measured, within the travel of the machine");
  }
  return planned;
}

}  // namespace abbe
