#include "abbe/instruments/path_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

/// Where a point of a body stands in the machine frame; of the tool it counts from the gauge point.
Eigen::Vector3d in_machine(const Machine& machine, const std::vector<double>& positions, Body body,
                           const Eigen::Vector3d& point) {
  if (body == Body::bed) return point;
  if (body == Body::workpiece) return nominal_bed_from_workpiece(machine, positions) * point;
  return nominal_bed_from_tool(machine, positions) * Eigen::Vector3d(point - machine.tool_offset);
}

std::string pose_text(const Machine& machine, const std::vector<double>& positions) {
  std::string text;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    text += fmt::format("{}{} = {:.6g} deg", text.empty() ? "" : ", ", machine.axes[i].name, positions[i] / kDegree);
  }
  return text.empty() ? "the plan" : text;
}

}  // namespace

Eigen::Vector3d nominal_displacement(const Machine& machine, const std::vector<double>& positions, Body from, Body to,
                                     const MeetingPoints& points) {
  return in_machine(machine, positions, from, points.on_from) - in_machine(machine, positions, to, points.on_to);
}

std::optional<std::vector<double>> meet(const Machine& machine, const std::vector<double>& positions, Body from,
                                        Body to, const MeetingPoints& points, const Eigen::Vector3d& displacement) {
  const auto gap = [&](const std::vector<double>& at) -> Eigen::Vector3d {
    return nominal_displacement(machine, at, from, to, points) - displacement;
  };
  std::vector<std::size_t> linear;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::linear) linear.push_back(i);
  }
  std::vector<double> result = positions;
  const Eigen::Vector3d start = gap(result);
  if (start.norm() < 1e-9) return result;
  if (linear.empty()) return std::nullopt;
  // The gap is an affine function of the linear axes, so one step of any length gives its slope.
  constexpr double kStep = 100;  // mm
  Eigen::MatrixXd slopes(3, static_cast<Eigen::Index>(linear.size()));
  for (std::size_t i = 0; i < linear.size(); ++i) {
    std::vector<double> moved = result;
    moved[linear[i]] += kStep;
    slopes.col(static_cast<Eigen::Index>(i)) = (gap(moved) - start) / kStep;
  }
  const CompleteOrthogonal solver(slopes);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const Eigen::VectorXd step = solver.solve(-gap(result));
    for (std::size_t i = 0; i < linear.size(); ++i) result[linear[i]] += step[static_cast<Eigen::Index>(i)];
  }
  if (gap(result).norm() > 1e-7) return std::nullopt;
  for (const std::size_t i : linear) {
    const Axis& axis = machine.axes[i];
    if (result[i] < axis.travel_min - 1e-9 || result[i] > axis.travel_max + 1e-9) return std::nullopt;
  }
  return result;
}

PoseList circle_plan(const Machine& machine, const std::vector<double>& positions, Body from, Body to,
                     const MeetingPoints& points, const CircleDescription& circle) {
  PoseList poses;
  for (const double t : evenly_spaced(circle.from_angle, circle.to_angle, circle.count)) {
    const Eigen::Vector3d displacement = circle.radius * (std::cos(t) * circle.u + std::sin(t) * circle.v);
    const auto pose = meet(machine, positions, from, to, points, displacement);
    if (!pose) {
      throw std::invalid_argument(
          fmt::format("the circle is out of reach of the linear axes at {:.6g} deg", t / kDegree));
    }
    poses.append(*pose);
  }
  return poses;
}

PoseList follow_plan(const Machine& machine, const PoseList& rotary, Body from, Body to, const MeetingPoints& points,
                     const Eigen::Vector3d& displacement) {
  PoseList poses;
  for (std::size_t k = 0; k < rotary.count(); ++k) {
    const std::vector<double> positions = rotary.pose(k);
    const auto pose = meet(machine, positions, from, to, points, displacement);
    if (!pose) {
      throw std::invalid_argument("the linear axes cannot follow at " + pose_text(machine, positions));
    }
    poses.append(*pose);
  }
  return poses;
}

PoseList repeated(const PoseList& poses, std::size_t repeats, bool there_and_back) {
  PoseList result;
  result.axis.resize(poses.axis.size());
  for (std::size_t r = 0; r < repeats; ++r) {
    for (std::size_t i = 0; i < poses.axis.size(); ++i) {
      std::vector<double> part = poses.axis[i];
      if (there_and_back && r % 2 == 1) std::reverse(part.begin(), part.end());
      result.axis[i].insert(result.axis[i].end(), part.begin(), part.end());
    }
  }
  return result;
}

}  // namespace abbe
