#include "abbe/identify/covariance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

bool is_constrained(const ConstrainedSpace* space) { return space && space->directions.rows() > 0; }

// Normal matrix of the free variables with unit diagonal, and the scale that makes it so; false if a column is zero.
bool scaled_reduced(const Eigen::MatrixXd& normal, const ConstrainedSpace* space, Eigen::MatrixXd& scaled,
                    Eigen::VectorXd& inverse_scale) {
  scaled =
      is_constrained(space) ? Eigen::MatrixXd(space->directions.transpose() * (normal * space->directions)) : normal;
  if (!scaled.allFinite() || (scaled.size() > 0 && !(scaled.diagonal().minCoeff() > 0))) return false;
  inverse_scale = scaled.diagonal().cwiseSqrt().cwiseInverse();
  scaled = (inverse_scale.asDiagonal() * scaled * inverse_scale.asDiagonal()).eval();
  return true;
}

// Z D^-1 (root of the inverse): the covariance is its product with its transpose.
Eigen::MatrixXd to_estimates(const Eigen::MatrixXd& root, const Eigen::VectorXd& inverse_scale,
                             const ConstrainedSpace* space) {
  const Eigen::MatrixXd free = inverse_scale.asDiagonal() * root;
  return is_constrained(space) ? Eigen::MatrixXd(space->directions * free) : free;
}

}  // namespace

bool covariance_of_estimates(const Eigen::MatrixXd& normal, const ConstrainedSpace* space,
                             Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd scaled;
  Eigen::VectorXd inverse_scale;
  covariance.resize(0, 0);
  if (!scaled_reduced(normal, space, scaled, inverse_scale)) return false;
  const Cholesky factor(scaled);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::MatrixXd inverse = factor.solve_columns(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  covariance = inverse_scale.asDiagonal() * inverse * inverse_scale.asDiagonal();
  if (is_constrained(space)) covariance = (space->directions * covariance * space->directions.transpose()).eval();
  covariance = ((covariance + covariance.transpose()) / 2).eval();
  return true;
}

bool covariance_from_factor(const Eigen::MatrixXd& factor, const ConstrainedSpace* space, Eigen::MatrixXd& covariance) {
  covariance.resize(0, 0);
  Eigen::MatrixXd free = is_constrained(space) ? Eigen::MatrixXd(factor * space->directions) : factor;
  const Eigen::VectorXd norms = free.colwise().norm();
  if (!free.allFinite() || !(norms.minCoeff() > 0)) return false;
  const Eigen::VectorXd inverse_scale = norms.cwiseInverse();
  free = (free * inverse_scale.asDiagonal()).eval();
  const Index n = free.cols();
  const PivotedQr qr(free);
  const Eigen::MatrixXd triangle = qr.upper(n);
  if (!(std::abs(triangle(n - 1, n - 1)) > 5e-14 * std::abs(triangle(0, 0)))) return false;
  const Eigen::MatrixXd root =
      qr.columns() * Eigen::MatrixXd(triangle.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n)));
  const Eigen::MatrixXd estimates = to_estimates(root, inverse_scale, space);
  covariance = estimates * estimates.transpose();
  return true;
}

Observability observability_of(const Eigen::MatrixXd& normal, const ConstrainedSpace* space,
                               std::size_t reading_count) {
  Observability result;
  Eigen::MatrixXd scaled;
  Eigen::VectorXd inverse_scale;
  if (!scaled_reduced(normal, space, scaled, inverse_scale) || scaled.rows() == 0 || reading_count == 0) return result;
  const SymmetricEigen<> eigen(scaled, Eigen::EigenvaluesOnly);
  const Eigen::VectorXd singular = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Index n = singular.size();
  if (!(singular[0] > 0)) return result;
  result.o1 =
      std::exp(singular.array().log().sum() / static_cast<double>(n)) / std::sqrt(static_cast<double>(reading_count));
  result.o2 = singular[0] / singular[n - 1];
  result.o3 = singular[0];
  result.condition = singular[n - 1] / singular[0];
  return result;
}

std::vector<std::vector<Correlation>> largest_correlations(const Eigen::MatrixXd& covariance, std::size_t count) {
  const Index n = covariance.rows();
  std::vector<std::vector<Correlation>> result(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    if (!(covariance(i, i) > 0)) continue;
    std::vector<Correlation>& list = result[static_cast<std::size_t>(i)];
    for (Index j = 0; j < n; ++j)
      if (j != i && covariance(j, j) > 0)
        list.push_back(
            {static_cast<std::size_t>(j), covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j))});
    std::stable_sort(list.begin(), list.end(),
                     [](const Correlation& a, const Correlation& b) { return std::abs(a.value) > std::abs(b.value); });
    if (list.size() > count) list.resize(count);
  }
  return result;
}

}  // namespace abbe
