#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "abbe/geometry/registration/fine_registration.h"
#include "abbe/geometry/surface/point_cloud.h"

namespace abbe {

enum class RegistrationStatus {
  not_run,
  ok,
  too_few_points,
  no_start,  ///< no pose brings the scan near the surface
  not_converged,
  undetermined,  ///< some motions of the scan are not seen: FineRegistration::undetermined names them
  ambiguous      ///< other poses fit as well: Registration::alternatives; undetermined motions may come with it
};
const char* registration_status_name(RegistrationStatus status);

struct RegistrationOptions {
  std::optional<RigidTransform> start = std::nullopt;  ///< mesh from scan; without it any pose is found
  RegistrationLoss loss = RegistrationLoss::welsch;
  bool adaptive_distance = true;
  double noise_mm = 0;         ///< standard uncertainty of a point along the normal; 0: from the residuals
  double crease_angle = 0.52;  ///< as SmoothSurface, rad
  std::uint64_t seed = 1;      ///< the same seed gives the same answer, whatever the number of threads
  int threads = 0;
  WorkDriver work{};  ///< as FineRegistrationOptions::work
};

/// Another pose that fits as well as the best one.
struct AlternativePose {
  RigidTransform mesh_from_scan;
  double cost_difference = 0;              ///< mean loss of a point more than with the best pose, loss 0 .. 1
  double cost_difference_uncertainty = 0;  ///< its standard uncertainty, from the pairs of losses of the same points
};

struct Registration {
  RegistrationStatus status = RegistrationStatus::not_run;
  FineRegistration fine;
  double inlier_share = 0;  ///< share of the points nearer than three robust standard deviations
  std::vector<AlternativePose> alternatives;
  std::size_t starts = 0;  ///< rough poses that were refined
};

/// A part to which scans are registered.
class RegistrationTarget {
 public:
  explicit RegistrationTarget(const TriangleMesh& mesh, const RegistrationOptions& options = {});
  ~RegistrationTarget();

  /// Pose of a scan on the part: pairs of points with normals give rough poses, the best of them are refined on some of
  /// the points, the best of these on all. Poses that differ by an undetermined motion only count as one.
  /// @param progress  null, or called with the steps done and all steps
  Registration register_scan(const PointCloud& scan,
                             const std::function<void(std::size_t, std::size_t)>& progress = {}) const;

  const ClosestPointFinder& surface() const;

 private:
  struct Inside;
  std::unique_ptr<const Inside> inside_;
};

}  // namespace abbe
