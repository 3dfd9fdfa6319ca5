#include "abbe/plan/ways/clear_ways.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/machine/coupling.h"
#include "abbe/plan/ways/linear_motion.h"

namespace abbe {
namespace {

/// Index of the outermost axis between a carrier and the tool, counted along the chain: that axis and all behind it
/// move the tool as the carrier sees it.
std::size_t first_axis_between(const Machine& machine, ObstacleCarrier carrier, std::size_t axis) {
  if (carrier == ObstacleCarrier::table) return 0;
  if (carrier == ObstacleCarrier::base) return machine.workpiece_axis_count();
  return machine.axes[axis].side == ChainSide::workpiece ? axis : axis + 1;
}

double distance_to_line(const Eigen::Vector3d& point, const Eigen::Vector3d& on_line,
                        const Eigen::Vector3d& direction) {
  return (point - on_line).cross(direction).norm();
}

std::vector<double> between(const std::vector<double>& from, const std::vector<double>& to, double share) {
  std::vector<double> pose(from.size());
  for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = from[i] + share * (to[i] - from[i]);
  return pose;
}

}  // namespace

/// The machine at one pose, in the frame of the bed.
struct ClearWays::Stand {
  std::array<RigidTransform, kMaxAxes> carried;  ///< [axes] bed from what the axis carries
  std::array<RigidTransform, kMaxAxes> base;     ///< [axes] bed from what the axis stands on
  Eigen::Vector3d point;                         ///< functional point, mm
  Eigen::Vector3d direction;                     ///< of the tool, towards the spindle

  RigidTransform of(const Machine& machine, ObstacleCarrier carrier, std::size_t axis) const {
    if (carrier == ObstacleCarrier::axis) return carried[axis];
    if (carrier == ObstacleCarrier::base) return {};
    return machine.workpiece_axis_count() > 0 ? carried[0] * machine.bed_from_workpiece : machine.bed_from_workpiece;
  }
};

ClearWays::ClearWays(const Machine& machine, const std::vector<Obstacle>& obstacles, ToolShape tool, WayOptions options)
    : machine_(machine), tool_(tool), options_(std::move(options)) {
  for (const Obstacle& obstacle : obstacles) {
    surfaces_.push_back({ClosestPointFinder(obstacle.mesh), check_mesh(obstacle.mesh).encloses_volume(),
                         obstacle.carrier, obstacle.axis});
  }
}

ClearWays::Stand ClearWays::stand(const std::vector<double>& pose) const {
  Stand stand;
  const std::vector<double> position = positions_of_commands(machine_, pose);
  const std::size_t workpiece_side = machine_.workpiece_axis_count();
  RigidTransform at;
  for (std::size_t i = workpiece_side; i-- > 0;) {
    stand.base[i] = at;
    at = stand.carried[i] = at * nominal_motion(machine_.axes[i], position[i]);
  }
  at = {};
  for (std::size_t i = workpiece_side; i < machine_.axes.size(); ++i) {
    stand.base[i] = at;
    at = stand.carried[i] = at * nominal_motion(machine_.axes[i], position[i]);
  }
  stand.point = at * (machine_.tool_reference + machine_.tool_offset).eval();
  stand.direction = at.rotation * machine_.tool_direction;
  return stand;
}

std::optional<WayCollision> ClearWays::piece(const std::vector<double>& from, const std::vector<double>& to,
                                             double begin, double end) const {
  const double middle = 0.5 * (begin + end);
  const std::vector<double> pose = between(from, to, middle);
  const Stand at = stand(pose);
  const std::vector<double> begins = positions_of_commands(machine_, from), ends = positions_of_commands(machine_, to);
  const Eigen::Vector3d far_end = at.point + tool_.length * at.direction;
  // What all axes from one on, to the tool, move the tool's line over half of the piece.
  std::array<double, kMaxAxes + 1> moved{};
  for (std::size_t i = machine_.axes.size(); i-- > 0;) {
    const Axis& axis = machine_.axes[i];
    const double motion = 0.5 * (end - begin) * std::abs(ends[i] - begins[i]);
    double reach = 1;
    if (axis.kind == AxisKind::rotary) {
      const Eigen::Vector3d on_line = at.base[i] * axis.point, direction = at.base[i].rotation * axis.direction;
      // A distance from a line is convex along the tool: one of its ends is farthest.
      reach = moved[i + 1] +
              std::max(distance_to_line(at.point, on_line, direction), distance_to_line(far_end, on_line, direction));
    }
    moved[i] = moved[i + 1] + motion * reach;
  }
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const Surface& surface = surfaces_[k];
    const double bound = moved[first_axis_between(machine_, surface.carrier, surface.axis)];
    const RigidTransform obstacle_from_bed = at.of(machine_, surface.carrier, surface.axis).inverse();
    const Eigen::Vector3d point = obstacle_from_bed * at.point, direction = obstacle_from_bed.rotation * at.direction;
    const double wanted = tool_.radius + bound;
    // Along the tool's line: at a distance d, nothing is nearer than d - s to its points up to s away.
    for (double along = 0;;) {
      const double found = surface.finder.closest_to(point + along * direction).distance;
      const double distance = surface.is_closed ? found : std::abs(found);
      if (distance <= wanted + 0.5 * kTouching) {
        const WayCollision collision{k, pose, middle, distance};
        if (distance <= tool_.radius || bound <= 0.5 * kTouching) return collision;
        if (const std::optional<WayCollision> first = piece(from, to, begin, middle)) return first;
        return piece(from, to, middle, end);
      }
      if (along >= tool_.length) break;
      along = std::min(tool_.length, along + distance - wanted);
    }
  }
  return std::nullopt;
}

std::optional<WayCollision> ClearWays::standing(const std::vector<double>& pose) const {
  return piece(pose, pose, 0, 1);
}

std::optional<WayCollision> ClearWays::straight(const std::vector<double>& from, const std::vector<double>& to) const {
  return piece(from, to, 0, 1);
}

bool ClearWays::is_clear_along(const std::vector<std::vector<double>>& poses) const {
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (straight(poses[k - 1], poses[k])) return false;
  }
  return true;
}

std::optional<std::vector<double>> ClearWays::retracted(const std::vector<double>& pose) const {
  if (!(options_.clearance > 0)) return std::nullopt;
  const Eigen::Vector3d direction = nominal_bed_from_tool(machine_, pose).rotation * machine_.tool_direction;
  std::vector<double> away = pose;
  const std::optional<std::vector<double>> one = moved_linearly(machine_, pose, direction);
  if (!one) return std::nullopt;
  double length = options_.clearance;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const double per_mm = (*one)[i] - pose[i];
    if (per_mm == 0) continue;
    const double room = per_mm > 0 ? machine_.axes[i].travel_max - pose[i] : pose[i] - machine_.axes[i].travel_min;
    length = std::min(length, room / std::abs(per_mm));
  }
  if (!(length > kTouching)) return std::nullopt;
  for (std::size_t i = 0; i < pose.size(); ++i) away[i] += length * ((*one)[i] - pose[i]);
  return away;
}

Way ClearWays::find(const std::vector<double>& from, const std::vector<double>& to) const {
  Way way;
  way.collision = straight(from, to);
  way.is_clear = !way.collision;
  if (way.is_clear) return way;
  // Between two poses, the rotary axes together with the others, after them and before them.
  const auto crossings = [this](const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> moved = a, turned = a;
    for (std::size_t i = 0; i < a.size(); ++i) {
      (machine_.axes[i].kind == AxisKind::linear ? moved : turned)[i] = b[i];
    }
    return std::vector<std::vector<std::vector<double>>>{{a, b}, {a, moved, b}, {a, turned, b}};
  };
  const auto at_clear = [this](std::vector<double> pose) {
    for (const auto& [axis, position] : options_.clear_at) pose[axis] = position;
    return pose;
  };
  const auto take = [&](std::vector<std::vector<double>> via) {
    // Stands that are the same need no move.
    via.insert(via.begin(), from);
    via.push_back(to);
    via.erase(std::unique(via.begin(), via.end()), via.end());
    if (via.size() < 3 || !is_clear_along(via)) return false;
    way.via.assign(via.begin() + 1, via.end() - 1);
    return way.is_clear = true;
  };
  const std::optional<std::vector<double>> away = retracted(from), before = retracted(to);
  if (away && before) {
    for (const auto& crossing : crossings(*away, *before)) {
      if (take(crossing)) return way;
    }
  }
  if (options_.clear_at.empty()) return way;
  for (auto crossing : crossings(at_clear(from), at_clear(to))) {
    if (take(crossing)) return way;
    if (!away || !before) continue;
    crossing.insert(crossing.begin(), *away);
    crossing.push_back(*before);
    if (take(crossing)) return way;
  }
  return way;
}

}  // namespace abbe
