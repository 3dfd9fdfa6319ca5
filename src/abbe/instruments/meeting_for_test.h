#pragma once

#include <stdexcept>
#include <vector>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/path_plan.h"

/// Poses for tests of instruments that touch something.
namespace abbe::test {

/// Axis commands in the middle of all travels (endless axes: 0), [axes].
inline std::vector<double> middle(const Machine& machine) {
  std::vector<double> positions;
  for (const Axis& axis : machine.axes) {
    positions.push_back(axis.endless ? 0 : (axis.travel_min + axis.travel_max) / 2);
  }
  return positions;
}

/// A point of the tool (from its gauge point, mm) seen from the workpiece on the actual machine; not through ChainPlan.
inline Eigen::Vector3d seen_from_workpiece(const Machine& machine, const ErrorSet& errors,
                                           const std::vector<double>& positions, const Eigen::Vector3d& on_tool) {
  return actual_workpiece_from_tool(machine, errors, positions) * Eigen::Vector3d(on_tool - machine.tool_offset);
}

/// Random poses near the middle in which the meeting points stand apart by at most `apart` along each axis.
/// @param turn  rad, rotary axes up to this to either side
inline PoseList meeting_poses(const Machine& machine, Body from, Body to, const MeetingPoints& points, double apart,
                              double turn, std::size_t count) {
  PoseList poses;
  for (std::uint64_t trial = 0; poses.count() < count; ++trial) {
    if (trial > 50 * count) throw std::logic_error("the points meet nowhere");
    RandomStream random(5, trial);
    std::vector<double> start = middle(machine);
    for (std::size_t i = 0; i < start.size(); ++i) {
      if (machine.axes[i].kind == AxisKind::rotary) start[i] += random.uniform(-turn, turn);
    }
    Eigen::Vector3d displacement;
    for (double& d : displacement) d = random.uniform(-apart, apart);
    if (const auto found = meet(machine, start, from, to, points, displacement)) poses.append(*found);
  }
  return poses;
}

/// Such poses for all items of an instrument, one after the other.
inline InstrumentReadings meeting_plan(const Machine& machine, const Instrument& instrument, double apart, double turn,
                                       std::size_t count, const std::vector<double>& inputs = {}) {
  InstrumentReadings plan;
  for (std::size_t item = 0; item < instrument.items().size(); ++item) {
    const InstrumentItem& own = instrument.items()[item];
    const PoseList poses =
        meeting_poses(machine, own.from, own.to, *instrument.meeting_points(item), apart, turn, count);
    for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), item, inputs);
  }
  return plan;
}

}  // namespace abbe::test
