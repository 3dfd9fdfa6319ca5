#include "abbe/plan/scans/scan_reach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr int kAzimuths = 12;

/// A direction beside the normal.
class Tilts {
 public:
  explicit Tilts(const Eigen::Vector3d& normal) : normal_(normal), u_(normal.unitOrthogonal()), v_(normal.cross(u_)) {}
  Eigen::Vector3d at(double tilt, int azimuth) const {
    const double angle = azimuth * 2 * std::numbers::pi / kAzimuths;
    return std::cos(tilt) * normal_ + std::sin(tilt) * (std::cos(angle) * u_ + std::sin(angle) * v_);
  }

 private:
  Eigen::Vector3d normal_, u_, v_;
};

/// How far a direction comes: the place must be seen, the probe must fit, the axes must reach.
int stage_of(ScanObstacle obstacle) {
  switch (obstacle) {
    case ScanObstacle::none:
      return 4;
    case ScanObstacle::travel:
      return 3;
    case ScanObstacle::working_distance:
      return 2;
    case ScanObstacle::collision:
      return 1;
    default:
      return 0;
  }
}

}  // namespace

ScanReachFinder::ScanReachFinder(const Machine& machine, const ScanClearance& clearance, double largest_angle)
    : clearance_(clearance), largest_angle_(largest_angle), inverse_(machine) {}

bool ScanReachFinder::commands(const Eigen::Vector3d& point, const Eigen::Vector3d& beam,
                               const std::vector<double>& start, std::vector<double>& positions) {
  inverse_.solve(PoseTarget::at(point, beam), start.data(), result_);
  if (result_.status != InverseStatus::solved || !result_.solutions.front().within_travel) return false;
  const auto& position = result_.solutions.front().position;
  positions.assign(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(start.size()));
  return true;
}

ScanObstacle ScanReachFinder::attempt(const Eigen::Vector3d& point, const Eigen::Vector3d& beam,
                                      const std::vector<double>& start, std::vector<double>& positions) {
  switch (clearance_.measuring(point, beam)) {
    case ScanClearance::Verdict::beam_hidden:
      return ScanObstacle::hidden;
    case ScanClearance::Verdict::working_distance:
      return ScanObstacle::working_distance;
    case ScanClearance::Verdict::probe_too_near:
      return ScanObstacle::collision;
    case ScanClearance::Verdict::free:
      break;
  }
  return commands(point, beam, start, positions) ? ScanObstacle::none : ScanObstacle::travel;
}

bool ScanReachFinder::is_seen_more_steeply(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const Tilts tilts(normal);
  for (const double angle : {45 * kDegree, 65 * kDegree, 80 * kDegree}) {
    for (int k = 0; angle > largest_angle_ && k < kAzimuths; ++k) {
      if (clearance_.sees(point, tilts.at(angle, k))) return true;
    }
  }
  return false;
}

ScanReach ScanReachFinder::find(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                const Eigen::Vector3d& first, const Eigen::Vector3d& before,
                                const std::vector<double>& start) {
  ScanReach reach;
  reach.beam = first;
  reach.obstacle = attempt(point, first, start, reach.positions);
  if (reach.obstacle == ScanObstacle::none) return reach;
  const Tilts tilts(normal);
  std::array<Eigen::Vector3d, 1 + 2 * kAzimuths> beams;
  beams[0] = normal;
  for (int k = 0; k < kAzimuths; ++k) {
    const auto which = static_cast<std::size_t>(k);
    beams[1 + which] = tilts.at(0.5 * (largest_angle_ - kScanAngleMargin), k);
    beams[1 + kAzimuths + which] = tilts.at(largest_angle_ - kScanAngleMargin, k);
  }
  std::stable_sort(beams.begin(), beams.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.dot(before) > b.dot(before) + 1e-9;
  });
  for (const Eigen::Vector3d& beam : beams) {
    const ScanObstacle obstacle = attempt(point, beam, start, reach.positions);
    if (obstacle == ScanObstacle::none) {
      reach.obstacle = obstacle;
      reach.beam = beam;
      reach.tilted = true;
      return reach;
    }
    if (stage_of(obstacle) > stage_of(reach.obstacle)) reach.obstacle = obstacle;
  }
  if (reach.obstacle == ScanObstacle::hidden && is_seen_more_steeply(point, normal)) {
    reach.obstacle = ScanObstacle::angle;
  }
  return reach;
}

}  // namespace abbe
