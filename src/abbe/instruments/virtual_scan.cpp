#include "abbe/instruments/virtual_scan.h"

#include <cmath>
#include <optional>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

/// The beam at one position, in the frame of the part.
struct Beam {
  Eigen::Vector3d zero, direction;
};

Beam beam_at(const Machine& machine, const ErrorSet& actual, const VirtualScanSetup& setup,
             const RigidTransform& part_from_workpiece, const std::vector<double>& positions) {
  // The pose is that of the functional point; the beam is given from the gauge point.
  const RigidTransform part_from_tool = part_from_workpiece * actual_workpiece_from_tool(machine, actual, positions);
  return {part_from_tool * Eigen::Vector3d(setup.beam.zero - machine.tool_offset),
          part_from_tool.rotation * setup.beam.direction};
}

}  // namespace

VirtualScan scan_part(const Machine& machine, const ErrorSet& actual, const RayTracer& part, const PoseList& planned,
                      const VirtualScanSetup& setup) {
  const RigidTransform part_from_workpiece = setup.workpiece_from_part.inverse();
  const double least_cosine = std::cos(setup.largest_angle);
  const bool follows = setup.following_axis < machine.axes.size();
  // How far the command of the following axis brings the probe along its beam.
  double along = 0;
  if (follows) {
    const Axis& axis = machine.axes[setup.following_axis];
    along = axis.sense() * axis.direction.dot(setup.beam.direction);
    if (axis.side == ChainSide::workpiece) along = -along;
  }
  VirtualScan scan;
  scan.positions.axis.resize(machine.axes.size());
  double shift = 0;  // of the following axis
  for (std::size_t k = 0; k < planned.count(); ++k) {
    RandomStream random(setup.seed, k);
    std::vector<double> command = planned.pose(k), position;
    std::vector<double> deviation(command.size());
    for (std::size_t i = 0; i < command.size(); ++i) {
      deviation[i] =
          random.normal() * (machine.axes[i].kind == AxisKind::linear ? setup.linear_noise : setup.rotary_noise);
    }
    const double probe_deviation = random.normal() * setup.probe_noise;
    if (follows) command[setup.following_axis] += shift;
    std::optional<RayHit> hit;
    Beam beam;
    const auto look = [&](double search) {
      position = command;
      for (std::size_t i = 0; i < command.size(); ++i) position[i] += deviation[i];
      beam = beam_at(machine, actual, setup, part_from_workpiece, position);
      hit = part.first(beam.zero, beam.direction, -setup.working_distance, setup.highest + search);
    };
    look(follows ? setup.search : 0);
    const auto in_range = [&] { return hit && hit->distance >= setup.lowest && hit->distance <= setup.highest; };
    if (follows && hit && !in_range() && std::abs(hit->distance) <= setup.highest + setup.search && along != 0) {
      command[setup.following_axis] += hit->distance / along;
      shift += hit->distance / along;
      look(0);
    }
    if (!in_range()) {
      ++scan.no_surface;
      continue;
    }
    if (!(-hit->normal.dot(beam.direction) >= least_cosine)) {
      ++scan.too_steep;
      continue;
    }
    scan.positions.append(command);
    scan.indication.push_back(hit->distance + probe_deviation);
    scan.planned.push_back(k);
    if (follows && along != 0) shift += hit->distance / along;
  }
  return scan;
}

Eigen::Matrix3Xd scanned_points(const Machine& machine, const ErrorSet& errors, const ProbeBeam& beam,
                                const VirtualScan& scan) {
  const std::size_t count = scan.indication.size();
  std::vector<const double*> axis;
  for (const std::vector<double>& values : scan.positions.axis) axis.push_back(values.data());
  std::vector<double> x(count), y(count), z(count);
  PointScan(machine, errors, beam).points({axis, count}, scan.indication.data(), {x.data(), y.data(), z.data()});
  const auto columns = static_cast<Eigen::Index>(count);
  Eigen::Matrix3Xd points(3, columns);
  points.row(0) = Eigen::Map<const Eigen::RowVectorXd>(x.data(), columns);
  points.row(1) = Eigen::Map<const Eigen::RowVectorXd>(y.data(), columns);
  points.row(2) = Eigen::Map<const Eigen::RowVectorXd>(z.data(), columns);
  return points;
}

}  // namespace abbe
