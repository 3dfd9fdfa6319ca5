#include "abbe/plan/scans/scan_clearance.h"

#include <algorithm>
#include <cmath>

namespace abbe {

ScanClearance::ScanClearance(const TriangleMesh& part, const std::optional<TriangleMesh>& stage,
                             double working_distance, double radius, double length)
    : part_{ClosestPointFinder(part), RayTracer(part)},
      working_distance_(working_distance),
      radius_(radius),
      length_(length) {
  if (stage) stage_.emplace(Obstacle{ClosestPointFinder(*stage), RayTracer(*stage)});
}

bool ScanClearance::rod_is_clear(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, double from,
                                 double to) const {
  // Sphere tracing: nothing is nearer to the axis of the rod than the distance found, so that much of it is clear. A
  // hundredth of the radius decides where the rod just touches.
  const double least = 0.01 * radius_;
  for (double at = from; at <= to;) {
    const Eigen::Vector3d place = point + at * beam;
    double distance = std::abs(part_.surface.closest_to(place).distance);
    if (stage_) distance = std::min(distance, std::abs(stage_->surface.closest_to(place).distance));
    if (distance < radius_) return false;
    // The rod is a cylinder: at `distance` from the axis it stays clear for sqrt(distance^2 - radius^2).
    at += std::max(least, std::sqrt(distance * distance - radius_ * radius_));
  }
  return true;
}

bool ScanClearance::sees(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const {
  constexpr double kOffTheSurface = 0.02;  // mm, beyond the chord error of meshes
  const double far = working_distance_ + length_;
  return !part_.tracer.first(point, beam, kOffTheSurface, far) &&
         !(stage_ && stage_->tracer.first(point, beam, 0, far));
}

bool ScanClearance::probe_fits(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const {
  return rod_is_clear(point, beam, working_distance_, working_distance_ + length_);
}

ScanClearance::Verdict ScanClearance::measuring(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const {
  if (!sees(point, beam)) return Verdict::beam_hidden;
  if (probe_fits(point, beam)) return Verdict::free;
  return rod_is_clear(point, beam, 2 * working_distance_, 2 * working_distance_ + length_) ? Verdict::working_distance
                                                                                           : Verdict::probe_too_near;
}

bool ScanClearance::draws_back(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, double back) const {
  return rod_is_clear(point, beam, working_distance_, working_distance_ + length_ + back);
}

bool ScanClearance::passing(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const {
  const double far = working_distance_ + length_;
  return !part_.tracer.first(point, beam, 0, far) && !(stage_ && stage_->tracer.first(point, beam, 0, far)) &&
         probe_fits(point, beam);
}

}  // namespace abbe
