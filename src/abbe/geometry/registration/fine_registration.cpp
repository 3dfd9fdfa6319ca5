#include "abbe/geometry/registration/fine_registration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "abbe/geometry/bounding_box.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/even_choice.h"
#include "abbe/geometry/registration/registration_pass.h"
#include "abbe/geometry/registration/seen_motions.h"
#include "abbe/geometry/registration/undetermined_motions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/geometry/surface/hilbert_order.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kMadToDeviation = 1.482602218505602;
/// Points from which the seen motions are told.
constexpr Index kPointsForRank = 20000;
/// From so many points on, only distances near the expected median are kept, of which the first is off by about 1 %.
constexpr Index kManyPoints = 100000;
constexpr double kFirstWidth = 0.1, kLeastWidth = 0.02, kMostWidth = 0.5;  ///< half, of the median
constexpr double kFarAway = 0.002;  ///< of the extent: nearer, a curved surface is its tangent plane

/// Weight and slope of the influence function at a distance.
struct Weight {
  double weight = 1, slope = 1;
};
Weight weight_at(RegistrationLoss loss, double distance, double scale) {
  if (loss == RegistrationLoss::least_squares) return {};
  const double u = distance / (scale * (loss == RegistrationLoss::welsch ? kWelschTuning : kTukeyTuning)),
               square = u * u;
  if (loss == RegistrationLoss::welsch) {
    const double weight = std::exp(-square);
    return {weight, weight * (1 - 2 * square)};
  }
  if (square >= 1) return {0, 0};
  return {(1 - square) * (1 - square), (1 - square) * (1 - 5 * square)};
}

class Fit {
 public:
  Fit(const Matrix3Xd& points, const ClosestPointFinder& surface, const SmoothSurface& smooth,
      const FineRegistrationOptions& options)
      : points_(points),
        order_(order_of(points, options.threads)),
        surface_(surface),
        smooth_(smooth),
        options_(options),
        sums_((static_cast<std::size_t>(points.cols()) + kBlock - 1) / kBlock),
        distances_(sums_.size()),
        ordered_(sums_.size()),
        hints_(static_cast<std::size_t>(points.cols()), ClosestPointFinder::kNoHint) {
    // Column by column: sums along the rows of so many columns would read the points three times.
    const auto count = static_cast<double>(points.cols());
    Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
    for (Index i = 0; i < points.cols(); ++i) sum += points.col(i);
    middle_ = sum / count;
    for (Index i = 0; i < points.cols(); ++i) squares += (points.col(i) - middle_).cwiseAbs2();
    extent_ = std::sqrt(squares.sum() / count);
  }

  double extent() const { return extent_; }
  Vector3d reference(const RigidTransform& pose) const { return pose * middle_; }

  /// A guess of the scale of the next pass. With a good one, the median of many distances is quick to find.
  void expect_scale(double scale) { expected_median_ = scale / kMadToDeviation; }

  /// One pass over all points: distances, and the sums at this scale.
  WeightedSums pass(const RigidTransform& pose, double scale) {
    pose_ = pose;
    scale_ = scale;
    median_.reset();
    window_ = {};
    if (expected_median_ > 0 && points_.cols() >= kManyPoints) {
      window_ = {(1 - width_) * expected_median_, (1 + width_) * expected_median_};
    }
    return pass_again();
  }

  /// Robust standard deviation of the distances of the last pass.
  double scale() {
    if (median_) return kMadToDeviation * *median_;
    median_ = median_distance(distances_);
    if (!median_) {
      window_ = {};
      pass_again();
      median_ = median_distance(distances_);
    }
    if (expected_median_ > 0) {
      width_ = std::clamp(4 * std::abs(*median_ / expected_median_ - 1), kLeastWidth, kMostWidth);
    }
    expected_median_ = *median_;
    return kMadToDeviation * *median_;
  }

  SeenMotions seen_motions(const RigidTransform& pose, double scale) {
    const Index stride = std::max<Index>(1, points_.cols() / kPointsForRank), together = kBlock * stride;
    std::vector<std::vector<MotionRow>> rows(static_cast<std::size_t>((points_.cols() + together - 1) / together));
    MotionPass pass{.points = static_cast<std::size_t>(points_.cols()), .rows = rows};
    pass.fingerprint = [&] { return fingerprint("seen motions", pose, {scale, 0, 0}); };
    pass.compute = [&](std::size_t block) {
      const Index first = static_cast<Index>(block) * together;
      const Index count = (std::min(together, points_.cols() - first) + stride - 1) / stride;
      Matrix3Xd moved(3, count);
      std::vector<SurfacePoint> found(static_cast<std::size_t>(count));
      std::vector<std::uint32_t> hints(found.size());
      for (Index k = 0; k < count; ++k) {
        moved.col(k) = pose * Vector3d(points_.col(number(first + k * stride)));
        hints[static_cast<std::size_t>(k)] = hints_[static_cast<std::size_t>(first + k * stride)];
      }
      surface_.closest_block(moved, found.data(), hints.data());
      for (const SurfacePoint& at : found) {
        if (at.on_border) continue;
        // The part's own normal at the foot: facets would tell about turns of a cylinder that the part does not show.
        const Vector6d row = gradient_of(smooth_.normal(at.triangle, at.point), at.point - reference(pose));
        rows[block].push_back({weight_at(options_.loss, at.distance, scale).weight, row});
      }
    };
    do_motion_pass(pass, options_.work, options_.threads);
    return seen_motions_of(rows);
  }

  Vector6d unscaled(Vector6d motion) const {
    motion.head<3>() /= extent_;
    return motion;
  }

 private:
  static constexpr Index kBlock = ClosestPointFinder::kBlock;
  static constexpr Index kSlice = 256;  ///< points of a block that stay in the first cache, with what is found

  WeightedSums pass_again() {
    for (WeightedSums& sums : sums_) sums = {};
    RegistrationPass pass{.points = static_cast<std::size_t>(points_.cols()), .sums = sums_, .distances = distances_};
    pass.fingerprint = [this] { return fingerprint("pass", pose_, {scale_, window_.low, window_.high}); };
    pass.compute = [this](std::size_t block) { compute(block); };
    do_pass(pass, options_.work, options_.threads);
    // In the order of the blocks, so that the sum does not depend on the threads.
    WeightedSums all;
    for (const WeightedSums& some : sums_) all += some;
    return all;
  }

  void compute(std::size_t block) {
    const Index first = static_cast<Index>(block) * kBlock, count = std::min(kBlock, points_.cols() - first);
    Matrix3Xd& own = ordered_[block];
    if (own.cols() == 0) {
      own.resize(3, count);
      for (Index i = 0; i < count; ++i) own.col(i) = points_.col(number(first + i));
    }
    const Vector3d middle = reference(pose_);
    BlockDistances& distances = distances_[block];
    distances.within.clear();
    distances.below = distances.all = 0;
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kSlice> moved;
    std::array<SurfacePoint, kSlice> found;
    for (Index from = 0; from < count; from += kSlice) {
      const Index some = std::min(kSlice, count - from);
      moved.noalias() = pose_.rotation * own.middleCols(from, some);
      moved.colwise() += pose_.translation;
      surface_.closest_block(moved, found.data(), hints_.data() + first + from);
      for (Index i = 0; i < some; ++i) {
        const SurfacePoint& at = found[static_cast<std::size_t>(i)];
        if (at.on_border) {
          ++sums_[block].beyond_border;
          continue;
        }
        add(at, moved.col(i), moved.col(i) - middle, scale_, &sums_[block]);
        const double distance = std::abs(at.distance);
        ++distances.all;
        if (distance < window_.low) ++distances.below;
        if (distance >= window_.low && distance <= window_.high) distances.within.push_back(distance);
      }
    }
  }

  /// Of the point at a place in the order.
  Index number(Index i) const { return order_.empty() ? i : Index{order_[static_cast<std::size_t>(i)]}; }

  /// Of a pass, without the surface, which the caller knows.
  std::uint64_t fingerprint(std::string_view pass, const RigidTransform& pose, const std::array<double, 3>& limits) {
    if (!of_points_) {
      of_points_ = digest_of_many(std::as_bytes(std::span(points_.data(), static_cast<std::size_t>(points_.size()))));
    }
    Digest digest;
    digest.add_text(pass);
    digest.add_text(vector_instructions());
    digest.add(*of_points_);
    digest.add_numbers({pose.rotation.data(), 9});
    digest.add_numbers({pose.translation.data(), 3});
    digest.add_numbers(limits);
    digest.add_number(options_.noise_mm);
    digest.add(static_cast<std::uint64_t>(options_.loss) * 2 + (options_.adaptive_distance ? 1 : 0));
    return digest.value();
  }

  Vector6d gradient_of(const Vector3d& direction, const Vector3d& arm) const {
    Vector6d row;
    row << arm.cross(direction) / extent_, direction;
    return row;
  }

  void add(const SurfacePoint& at, const Vector3d& point, const Vector3d& arm, double scale, WeightedSums* sums) const {
    const Weight w = weight_at(options_.loss, at.distance, scale);
    sums->weight += w.weight;
    sums->weighted_square += w.weight * at.distance * at.distance;
    if (w.weight < 1e-6) return;
    if (w.weight > 0.01) ++sums->used;
    const bool edge = at.feature != SurfaceFeature::face;
    const double distance = std::abs(at.distance);
    // The gradient of the distance; at an edge it is the line to it, not a normal of a face.
    Vector3d direction = at.normal;
    if (edge && distance > 1e-9 * extent_) direction = (point - at.point) / at.distance;
    const Vector6d row = gradient_of(direction, arm);
    const Matrix6d product = row * row.transpose();
    sums->gradient += w.weight * at.distance * row;
    sums->hessian += w.weight * product;
    sums->slope += w.slope * product;
    sums->square += w.weight * w.weight *
                    (options_.noise_mm > 0 ? options_.noise_mm * options_.noise_mm : at.distance * at.distance) *
                    product;
    if (options_.adaptive_distance && distance > kFarAway * extent_)
      add_curvature(at, arm, w.weight, edge, direction, sums);
  }

  /// The part of the second derivative of half the squared distance that lies in the tangent plane: d / (d - rho) along
  /// each principal direction, kept positive.
  void add_curvature(const SurfacePoint& at, const Vector3d& arm, double weight, bool edge, const Vector3d& direction,
                     WeightedSums* sums) const {
    if (edge) {
      // Across an edge the radius is zero. Along it nothing is lost by counting it in too: steps are shorter only.
      for (int k = 0; k < 3; ++k) {
        const Vector3d axis = Vector3d::Unit(k) - direction[k] * direction;
        const Vector6d row = gradient_of(axis, arm);
        sums->hessian += weight * row * row.transpose();
      }
      return;
    }
    const SmoothSurface::Curvature curvature = smooth_.curvature(at.triangle);
    for (int k = 0; k < 2; ++k) {
      const double bend = at.distance * curvature.value[k];
      if (!(bend > 0)) continue;
      const Vector6d row = gradient_of(curvature.direction[k], arm);
      sums->hessian += weight * bend / (1 + bend) * row * row.transpose();
    }
  }

  /// Neighbours follow each other, which the search for closest points is fastest with; a motion changes nothing in it.
  static std::vector<std::uint32_t> order_of(const Matrix3Xd& points, int threads) {
    if (points.cols() <= kBlock || points.cols() > Index{0xffffffff}) return {};
    const Eigen::AlignedBox3d box = bounding_box(points);
    return hilbert_order(points, box.min(), box.max(), threads);
  }

  const Matrix3Xd& points_;
  std::vector<std::uint32_t> order_;  // of the points; empty: their own
  const ClosestPointFinder& surface_;
  const SmoothSurface& smooth_;
  FineRegistrationOptions options_;
  std::vector<WeightedSums> sums_;         // [blocks]
  std::vector<BlockDistances> distances_;  // [blocks]
  std::vector<Matrix3Xd> ordered_;         // [blocks] points in their order, of those that were computed here
  std::vector<std::uint32_t> hints_;
  RigidTransform pose_;  // of the last pass, with its scale and window
  double scale_ = 0;
  DistanceWindow window_;
  std::optional<double> median_;
  double expected_median_ = 0, width_ = kFirstWidth;
  Vector3d middle_;
  double extent_ = 0;
  std::optional<std::uint64_t> of_points_;
};

/// Robust standard deviation of the distances at the start; some of very many points tell it.
double start_scale(const Matrix3Xd& points, const ClosestPointFinder& surface, const SmoothSurface& smooth,
                   const RigidTransform& pose, const FineRegistrationOptions& options, double extent) {
  const Matrix3Xd some = EvenChoice(points.cols(), kPointsForRank).of(points);
  Fit fit(some, surface, smooth, options);
  fit.pass(pose, extent);
  return fit.scale();
}

}  // namespace

RigidTransform small_motion(const Vector6d& motion, const Vector3d& reference) {
  const Eigen::Matrix3d rotation = rotation_from_vector(motion.head<3>());
  return {rotation, reference - rotation * reference + motion.tail<3>()};
}

FineRegistration register_finely(const Matrix3Xd& points, const ClosestPointFinder& surface,
                                 const SmoothSurface& smooth, const RigidTransform& mesh_from_scan,
                                 const FineRegistrationOptions& options) {
  FineRegistration result;
  result.mesh_from_scan = mesh_from_scan;
  if (points.cols() < 6) {
    result.status = FineRegistrationStatus::too_few_points;
    return result;
  }
  Fit fit(points, surface, smooth, options);
  const double extent = fit.extent(), movement = options.movement_mm > 0 ? options.movement_mm : 1e-9 * extent;
  if (!(extent > 0)) {
    result.status = FineRegistrationStatus::too_few_points;
    return result;
  }
  RigidTransform& pose = result.mesh_from_scan;
  // A scale below what ends the iteration would only follow roundings.
  const double first_scale = start_scale(points, surface, smooth, pose, options, extent);
  double scale = std::max(first_scale, movement);
  fit.expect_scale(first_scale);
  if (options.largest_scale_mm > 0) scale = std::min(scale, options.largest_scale_mm);
  SeenMotions seen = fit.seen_motions(pose, scale);
  bool converged = false;
  WeightedSums sums;
  for (; result.iterations < options.iterations && !converged; ++result.iterations) {
    sums = fit.pass(pose, scale);
    if (sums.used < 6 || seen.seen.cols() == 0) break;
    const MatrixXd hessian = seen.seen.transpose() * sums.hessian * seen.seen;
    const Ldlt<> solver(hessian);
    Vector6d step = -(seen.seen * solver.solve(seen.seen.transpose() * sums.gradient));
    if (!step.allFinite()) break;
    // Beyond half a radian the tangent planes say nothing.
    step *= std::min(1.0, 0.5 * extent / std::max(step.norm(), 1e-300));
    pose = small_motion(fit.unscaled(step), fit.reference(pose)) * pose;
    const double narrower = std::min(scale, std::max(fit.scale(), movement));
    const bool settled = narrower > 0.999 * scale;
    converged = settled && step.norm() < movement;
    // A scale that goes on creeping down would keep the pose creeping after it.
    if (!settled || result.iterations < 20) scale = narrower;
    if (result.iterations % 5 == 4) seen = fit.seen_motions(pose, scale);
  }
  // Products of many rotations drift from orthogonality.
  pose.rotation = Eigen::Quaterniond(pose.rotation).normalized().toRotationMatrix();
  // After a last step that moved nothing the sums are those of the pose.
  if (!converged) sums = fit.pass(pose, scale);
  seen = fit.seen_motions(pose, scale);
  result.scale_mm = fit.scale();
  result.used = sums.used;
  result.beyond_border = sums.beyond_border;
  result.weight_sum = sums.weight;
  result.rms_mm = sums.weight > 0 ? std::sqrt(sums.weighted_square / sums.weight) : 0;
  result.reference = fit.reference(pose);
  result.undetermined = undetermined_motions(seen.unseen, extent, result.reference);
  const MatrixXd slope = seen.seen.transpose() * sums.slope * seen.seen;
  const Ldlt<> solver(slope);
  if (seen.seen.cols() > 0 && sums.used > 6 && solver.is_positive()) {
    Matrix6d scaling = Matrix6d::Identity();
    scaling.topLeftCorner<3, 3>() /= extent;
    const MatrixXd bread = seen.seen * solver.solve_columns(seen.seen.transpose());
    const double freedom =
        options.noise_mm > 0 ? 1 : static_cast<double>(sums.used) / static_cast<double>(sums.used - seen.seen.cols());
    result.covariance = freedom * scaling * bread * sums.square * bread.transpose() * scaling;
  }
  result.status = sums.used < 6                  ? FineRegistrationStatus::too_few_points
                  : !converged                   ? FineRegistrationStatus::not_converged
                  : !result.undetermined.empty() ? FineRegistrationStatus::undetermined
                                                 : FineRegistrationStatus::ok;
  return result;
}

const char* registration_status_name(FineRegistrationStatus status) {
  switch (status) {
    case FineRegistrationStatus::not_run:
      return "not run";
    case FineRegistrationStatus::ok:
      return "ok";
    case FineRegistrationStatus::too_few_points:
      return "too few points";
    case FineRegistrationStatus::not_converged:
      return "not converged";
    case FineRegistrationStatus::undetermined:
      return "the scan does not determine the pose";
  }
  return "";
}

}  // namespace abbe
