#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/registration/pose_difference.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/smooth_surface.h"

namespace abbe {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// How much a point far from the surface counts.
enum class RegistrationLoss { least_squares, welsch, tukey };
/// Tuning constants, in standard deviations: 95 % of the efficiency of least squares for normally distributed
/// distances. Source: Holland and Welsch, Comm. Stat. A6 (1977) 813.
inline constexpr double kWelschTuning = 2.985, kTukeyTuning = 4.685;

struct FineRegistrationOptions {
  RegistrationLoss loss = RegistrationLoss::welsch;
  /// Second-order form of the squared distance (adaptive distance function) instead of that to the tangent plane.
  bool adaptive_distance = true;
  double noise_mm = 0;          ///< standard uncertainty of a point along the normal; 0: from the residuals
  double largest_scale_mm = 0;  ///< the scale of the loss is not taken larger than this at the start; 0: no limit
  int iterations = 100;
  double movement_mm = 0;  ///< done when no point of the scan moves more; 0: 1e-9 of the extent of the scan
  int threads = 0;         ///< 0: all; the result does not depend on it
  /// Who makes the passes over large scans; empty: this process. Every process gets the result. Its fingerprints do not
  /// know the surface.
  WorkDriver work{};
};

enum class FineRegistrationStatus { not_run, ok, too_few_points, not_converged, undetermined };
/// In words: "the scan does not determine the pose".
const char* registration_status_name(FineRegistrationStatus status);

/// Rigid motion that lays a scan on a surface.
struct FineRegistration {
  FineRegistrationStatus status = FineRegistrationStatus::not_run;
  RigidTransform mesh_from_scan;
  int iterations = 0;
  double scale_mm = 0;    ///< robust standard deviation of the distances: 1.4826 times the median of their amounts
  double rms_mm = 0;      ///< root mean square distance of the points, weighted as in the last step
  double weight_sum = 0;  ///< of the weights, 0 .. 1 per point
  Eigen::Index used = 0;  ///< points with a weight above 0.01
  Eigen::Index beyond_border = 0;  ///< points nearest to the edge of an open mesh, which are left out
  /// Of a rotation vector (rad) about `reference` and a translation (mm) applied after mesh_from_scan, frame of the
  /// mesh; without the undetermined motions.
  Matrix6d covariance = Matrix6d::Zero();
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< middle of the points, frame of the mesh, mm
  std::vector<UndeterminedMotion> undetermined;
};

/// Iteratively reweighted Gauss-Newton steps on the exact distances of the points to the surface.
///
/// @param points          [3, n] mm, frame of the scan
/// @param mesh_from_scan  start
/// Sources: Pottmann, Huang, Yang, Hu, Int. J. Comput. Vis. 67 (2006) 277 (second-order distance); Ding, Liu, Sun,
/// Meas. Sci. Technol. 30 (2019) 075003 (reweighted with it); Huber and Ronchetti, Robust Statistics (2009) 7.6
/// (covariance).
FineRegistration register_finely(const Eigen::Matrix3Xd& points, const ClosestPointFinder& surface,
                                 const SmoothSurface& smooth, const RigidTransform& mesh_from_scan,
                                 const FineRegistrationOptions& options = {});

/// Small motion (rotation vector about `reference`, rad; translation, mm) as a transform.
RigidTransform small_motion(const Vector6d& motion, const Eigen::Vector3d& reference);

}  // namespace abbe
