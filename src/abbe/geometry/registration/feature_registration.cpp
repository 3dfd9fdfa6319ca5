#include "abbe/geometry/registration/feature_registration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/registration/undetermined_motions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

/// Outward unit normal of a feature at a point beside it: gradient of distance().
Eigen::Vector3d normal_at(const Shape& shape, const Eigen::Vector3d& p) {
  if (shape.kind == ShapeKind::plane) return shape.direction;
  Eigen::Vector3d from = p - shape.point;
  if (shape.kind == ShapeKind::cylinder) from -= shape.direction.dot(from) * shape.direction;
  return from.normalized();
}

double median_amount(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

FineRegistration register_to_features(const Eigen::Matrix3Xd& points, const std::vector<Shape>& features,
                                      const std::vector<std::size_t>& labels, const RigidTransform& start,
                                      const FeatureRegistrationOptions& options) {
  for (const Shape& shape : features) {
    if (shape.kind != ShapeKind::plane && shape.kind != ShapeKind::sphere && shape.kind != ShapeKind::cylinder) {
      throw std::invalid_argument("register_to_features: planes, spheres and cylinders only");
    }
  }
  const Eigen::Index n = points.cols();
  if (!labels.empty() && static_cast<Eigen::Index>(labels.size()) != n) {
    throw std::invalid_argument("register_to_features: as many labels as points");
  }
  FineRegistration result;
  result.mesh_from_scan = start;
  if (n < 6 || features.empty()) {
    result.status = FineRegistrationStatus::too_few_points;
    return result;
  }
  std::vector<double> distances(static_cast<std::size_t>(n)), weights(static_cast<std::size_t>(n), 1.0);
  Eigen::Matrix3Xd placed(3, n), normals(3, n);
  const auto measure = [&] {
    result.reference.setZero();
    for (Eigen::Index i = 0; i < n; ++i) {
      placed.col(i) = result.mesh_from_scan * Eigen::Vector3d(points.col(i));
      result.reference += placed.col(i) / static_cast<double>(n);
      std::size_t feature = 0;
      if (!labels.empty()) {
        feature = labels[static_cast<std::size_t>(i)];
      } else {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < features.size(); ++k) {
          const double amount = std::abs(distance(features[k], placed.col(i)));
          if (amount < nearest) nearest = amount, feature = k;
        }
      }
      distances[static_cast<std::size_t>(i)] = distance(features[feature], placed.col(i));
      normals.col(i) = normal_at(features[feature], placed.col(i));
    }
    result.scale_mm = 1.4826 * median_amount(distances);
    result.weight_sum = 0;
    result.used = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (options.loss != RegistrationLoss::least_squares && result.scale_mm > 0) {
        const double z = distances[i] / (kWelschTuning * result.scale_mm);
        weights[i] = std::exp(-z * z);
      }
      result.weight_sum += weights[i];
      result.used += weights[i] > 0.01 ? 1 : 0;
    }
  };
  const auto row_of = [&](Eigen::Index i) {
    Vector6d row;
    row << (placed.col(i) - result.reference).cross(normals.col(i)), normals.col(i);
    return row;
  };

  measure();
  double extent = 0;
  for (Eigen::Index i = 0; i < n; ++i) extent = std::max(extent, (placed.col(i) - result.reference).norm());
  bool converged = false;
  Matrix6d normal_matrix;
  for (; result.iterations < options.iterations && !converged; ++result.iterations) {
    stop_if_asked(options.stop);
    normal_matrix.setZero();
    Vector6d right = Vector6d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector6d row = row_of(i);
      const double weight = weights[static_cast<std::size_t>(i)];
      normal_matrix += weight * row * row.transpose();
      right -= weight * distances[static_cast<std::size_t>(i)] * row;
    }
    // Rotations in units of the extent, so that the eigenvalues compare like with like.
    Matrix6d scale = Matrix6d::Identity();
    scale.topLeftCorner<3, 3>() /= std::max(extent, 1e-12);
    const SymmetricEigen<6> spectrum(scale * normal_matrix * scale);
    const double least = 1e-9 * spectrum.eigenvalues()[5];
    if (!(spectrum.eigenvalues()[0] > least)) {
      result.status = FineRegistrationStatus::undetermined;
      const Eigen::Index unseen = 6 - (spectrum.eigenvalues().array() > least).count();
      result.undetermined = undetermined_motions(spectrum.eigenvectors().leftCols(unseen), extent, result.reference);
      return result;
    }
    const Vector6d step = scale * (spectrum.eigenvectors() * (spectrum.eigenvalues().cwiseInverse().asDiagonal() *
                                                              (spectrum.eigenvectors().transpose() * (scale * right))));
    result.mesh_from_scan = small_motion(step, result.reference) * result.mesh_from_scan;
    const double moved = step.head<3>().norm() * extent + step.tail<3>().norm();
    measure();
    converged = moved <= 1e-12 * (extent + result.reference.norm());
    if (!converged && result.iterations > 20 && moved <= 1e-9 * extent) converged = true;
  }
  result.status = converged ? FineRegistrationStatus::ok : FineRegistrationStatus::not_converged;
  double squares = 0;
  Matrix6d information = Matrix6d::Zero(), scores = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double weight = weights[static_cast<std::size_t>(i)], r = distances[static_cast<std::size_t>(i)];
    const double z = options.loss == RegistrationLoss::least_squares || !(result.scale_mm > 0)
                         ? 0.0
                         : r / (kWelschTuning * result.scale_mm);
    const Vector6d row = row_of(i);
    squares += weight * r * r;
    information += weight * (1 - 2 * z * z) * row * row.transpose();  // derivative of the score
    scores +=
        weight * weight * (options.noise_mm > 0 ? options.noise_mm * options.noise_mm : r * r) * row * row.transpose();
  }
  result.rms_mm = std::sqrt(squares / std::max(result.weight_sum, 1e-300));
  const Ldlt<6> solver(information);
  result.covariance = solver.solve_columns(solver.solve_columns(scores).transpose());
  return result;
}

}  // namespace abbe
