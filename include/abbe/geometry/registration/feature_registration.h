#pragma once

#include <Eigen/Core>
#include <stop_token>
#include <vector>

#include "abbe/geometry/fits/shapes.h"
#include "abbe/geometry/registration/fine_registration.h"
#include "abbe/geometry/stopped.h"

namespace abbe {

struct FeatureRegistrationOptions {
  RegistrationLoss loss = RegistrationLoss::welsch;  ///< least_squares or welsch, with the scale from the median
  double noise_mm = 0;  ///< standard uncertainty of a point along the normal; 0: from the residuals
  int iterations = 100;
  std::stop_token stop{};  ///< looked at in every iteration: throws Stopped
};

/// As register_finely(), but on ideal features (planes, spheres, cylinders) instead of triangles: exact where a part's
/// drawing gives them, and where triangles would have to be very small.
///
/// @param points    [3, n] mm, frame of the scan
/// @param features  in the frame of the part
/// @param labels    [n] feature of each point; or empty: the nearest one in each step
/// @param start     part from scan
/// @returns `mesh_from_scan` is part from scan
FineRegistration register_to_features(const Eigen::Matrix3Xd& points, const std::vector<Shape>& features,
                                      const std::vector<std::size_t>& labels, const RigidTransform& start,
                                      const FeatureRegistrationOptions& options = {});

}  // namespace abbe
