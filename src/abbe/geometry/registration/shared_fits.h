#pragma once

// Internal to geometry: several registrations that do not depend on each other, as numbered work.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "abbe/geometry/registration/fine_registration.h"

namespace abbe {

/// A start of a fit, and the limit of its scale (FineRegistrationOptions::largest_scale_mm).
struct FitStart {
  RigidTransform mesh_from_scan;
  double largest_scale_mm = 0;
};

/// register_finely() from each start, on one thread each; shared as the options say. Every process has all results.
std::vector<FineRegistration> register_from_each(const Eigen::Matrix3Xd& points, const ClosestPointFinder& surface,
                                                 const SmoothSurface& smooth, std::span<const FitStart> starts,
                                                 const FineRegistrationOptions& options);

}  // namespace abbe
