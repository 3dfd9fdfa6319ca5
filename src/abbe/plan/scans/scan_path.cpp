#include "abbe/plan/scans/scan_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {

ScanPathBuilder::ScanPathBuilder(const Machine& machine, const ScanPlanOptions& options, const ScanClearance& clearance,
                                 const RayTracer& part, ScanReachFinder& reach, ScanPlan& plan)
    : machine_(machine),
      options_(options),
      clearance_(clearance),
      part_(part),
      reach_(reach),
      plan_(plan),
      last_(machine.axes.size(), 0.0) {
  plan_.positions.axis.resize(machine.axes.size());
}

RigidTransform ScanPathBuilder::half_way(const std::vector<double>& positions) const {
  std::vector<double> half(positions.size());
  for (std::size_t i = 0; i < half.size(); ++i) half[i] = 0.5 * (positions[i] + last_[i]);
  return nominal_workpiece_from_tool(machine_, half);
}

bool ScanPathBuilder::goes_straight(const std::vector<double>& positions) {
  // More than a point's step could lead through the part.
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double limit = machine_.axes[i].kind == AxisKind::rotary ? 0.35 : 10 * options_.along;
    if (std::abs(positions[i] - last_[i]) > limit) return false;
  }
  const RigidTransform pose = half_way(positions);
  if (!clearance_.probe_fits(pose.translation, pose.rotation * machine_.tool_direction)) return false;
  const double sag = sag_half_way(positions);
  if (sag > 0.5 * options_.range) {
    ++plan_.beyond_range;
    return false;
  }
  plan_.largest_sag = std::max(plan_.largest_sag, sag);
  return true;
}

double ScanPathBuilder::sag_half_way(const std::vector<double>& positions) const {
  const RigidTransform pose = half_way(positions);
  const Eigen::Vector3d along = -(pose.rotation * machine_.tool_direction);
  const auto hit = part_.first(pose.translation, along, -options_.working_distance, options_.working_distance);
  return hit ? std::abs(hit->distance) : std::numeric_limits<double>::infinity();
}

void ScanPathBuilder::measure(PlannedMove move, const std::vector<double>& positions, bool continues) {
  if (measured_ && !(continues && goes_straight(positions))) move.blocked = !link(move, positions);
  move.measures = true;
  step(move, positions);
  last_point_ = move.point;
  last_beam_ = move.beam;
  measured_ = true;
}

bool ScanPathBuilder::link(const PlannedMove& to, const std::vector<double>& positions) {
  const std::vector<double> start = last_;
  std::vector<double> up, over, trial_up, trial_over;
  bool done = false;
  for (double back = 2 * options_.clearance; back <= 256 * options_.clearance && !done; back *= 2) {
    if (!reach_.commands(last_point_ + back * last_beam_, last_beam_, start, trial_up)) continue;
    // Near the commands of the place itself: of several solutions the one from which the probe goes straight down.
    if (!reach_.commands(to.point + back * to.beam, to.beam, positions, trial_over)) continue;
    up = trial_up;
    over = trial_over;
    done = clearance_.draws_back(last_point_, last_beam_, back) && clearance_.draws_back(to.point, to.beam, back) &&
           way_is_clear(up, over);
  }
  if (!done) ++plan_.blocked_links;
  if (up.empty()) return false;
  PlannedMove over_the_place = to, above_the_last = to;
  over_the_place.blocked = above_the_last.blocked = !done;
  above_the_last.beam = last_beam_;
  above_the_last.point = last_point_;
  step(above_the_last, up);
  step(over_the_place, over);
  return done;
}

bool ScanPathBuilder::way_is_clear(const std::vector<double>& from, const std::vector<double>& to) const {
  double turn = 0, length = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    double& largest = machine_.axes[i].kind == AxisKind::rotary ? turn : length;
    largest = std::max(largest, std::abs(to[i] - from[i]));
  }
  const int steps = std::min(
      2000, 1 + static_cast<int>(std::ceil(turn / 0.05 + length / std::max(0.5, 0.5 * options_.probe_radius))));
  std::vector<double> at(from.size());
  for (int k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = from[i] + share * (to[i] - from[i]);
    const RigidTransform pose = nominal_workpiece_from_tool(machine_, at);
    if (!clearance_.passing(pose.translation, pose.rotation * machine_.tool_direction)) return false;
  }
  return true;
}

void ScanPathBuilder::step(const PlannedMove& move, const std::vector<double>& positions) {
  double time = move.measures ? 1 / options_.readings_per_second : 0;
  for (std::size_t i = 0; i < positions.size() && !plan_.moves.empty(); ++i) {
    const double speed = machine_.axes[i].kind == AxisKind::rotary ? options_.rotary_speed : options_.linear_speed;
    time = std::max(time, std::abs(positions[i] - last_[i]) / speed);
  }
  plan_.time += time;
  plan_.positions.append(positions);
  plan_.moves.push_back(move);
  plan_.moves.back().time = time;
  last_ = positions;
}

}  // namespace abbe
