#include "abbe/geometry/best_fit_transform.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d scatter(std::span<const Vector3d> points, std::span<const double> weights, const Vector3d& centre) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    if (weight > 0) sum += weight * (points[i] - centre) * (points[i] - centre).transpose();
  }
  return sum;
}

}  // namespace

const char* best_fit_status_name(BestFitStatus status) {
  switch (status) {
    case BestFitStatus::ok:
      return "ok";
    case BestFitStatus::too_few_points:
      return "too few points";
    case BestFitStatus::coincident:
      return "all points coincide";
    case BestFitStatus::collinear:
      return "all points on one line";
    case BestFitStatus::no_consensus:
      return "no consensus";
    case BestFitStatus::not_run:
      break;
  }
  return "not run";
}

double extent_of_points(std::span<const Vector3d> points) {
  if (points.empty()) return 0;
  const double count = static_cast<double>(points.size());
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point / count;
  double sum = 0;
  for (const Vector3d& point : points) sum += (point - mean).squaredNorm();
  return std::sqrt(sum / count);
}

Matrix3d rotation_from_correlation(const Matrix3d& correlation) {
  const SingularValues<3> svd(correlation);
  Vector3d signs = Vector3d::Ones();
  if (svd.u().determinant() * svd.v().determinant() < 0) signs.z() = -1;
  return svd.u() * signs.asDiagonal() * svd.v().transpose();
}

BestFitTransform best_fit_transform(std::span<const Vector3d> source, std::span<const Vector3d> target,
                                    std::span<const double> weights, double collinear_extent) {
  assert(source.size() == target.size());
  assert(weights.empty() || weights.size() == source.size());
  BestFitTransform fit;
  double total = 0;
  std::size_t used = 0;
  Vector3d source_centre = Vector3d::Zero(), target_centre = Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    if (weight <= 0) continue;
    total += weight;
    source_centre += weight * source[i];
    target_centre += weight * target[i];
    ++used;
  }
  if (used < 3) {
    fit.status = BestFitStatus::too_few_points;
    return fit;
  }
  source_centre /= total;
  target_centre /= total;

  Matrix3d correlation = Matrix3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    if (weight > 0) correlation += weight * (target[i] - target_centre) * (source[i] - source_centre).transpose();
  }
  fit.target_from_source.rotation = rotation_from_correlation(correlation);
  fit.target_from_source.translation = target_centre - fit.target_from_source.rotation * source_centre;

  double squares = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    if (weight > 0) squares += weight * (target[i] - fit.target_from_source * source[i]).squaredNorm();
  }
  fit.rms = std::sqrt(squares / total);

  const SymmetricEigen<3> principal(scatter(source, weights, source_centre) / total);
  // Along the principal directions once more: square roots of eigenvalues would stop at 1e-8 of the first extent.
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    if (weight > 0) {
      fit.extent += weight * (principal.eigenvectors().transpose() * (source[i] - source_centre)).cwiseAbs2();
    }
  }
  fit.extent = (fit.extent / total).cwiseSqrt().reverse().eval();
  // Rounding of coordinates far from the origin looks like extent.
  const double rounding = 1e-14 * (source_centre.norm() + fit.extent.x());
  if (fit.extent.x() <= std::max(rounding, collinear_extent)) {
    fit.status = BestFitStatus::coincident;
  } else if (fit.extent.y() <= std::max({rounding, 1e-9 * fit.extent.x(), collinear_extent})) {
    fit.status = BestFitStatus::collinear;
    fit.undetermined_direction = fit.target_from_source.rotation * principal.eigenvectors().col(2);
    int largest = 0;
    fit.undetermined_direction.cwiseAbs().maxCoeff(&largest);
    if (fit.undetermined_direction[largest] < 0) fit.undetermined_direction *= -1;
  } else {
    fit.status = BestFitStatus::ok;
  }
  return fit;
}

}  // namespace abbe
