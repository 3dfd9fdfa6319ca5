#include "abbe/instruments/reading_covariance.h"

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

constexpr double kLeastPivot = 1e-7;

}  // namespace

Eigen::MatrixXd covariance_of(const InstrumentReadings& readings, std::size_t components, std::size_t reading) {
  const auto n = static_cast<Eigen::Index>(components);
  Eigen::MatrixXd covariance(n, n);
  for (std::size_t row = 0; row < components; ++row) {
    for (std::size_t column = 0; column < components; ++column) {
      covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          readings.covariance[covariance_place(components, row, column)][reading];
    }
  }
  return covariance;
}

std::optional<Eigen::MatrixXd> inverse_covariance_factor(const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = covariance.rows();
  if (!(covariance.diagonal().minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Cholesky factor(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.diagonal().minCoeff() > kLeastPivot)) return std::nullopt;
  return Eigen::MatrixXd(factor.half_solve(Eigen::MatrixXd::Identity(n, n)) * scale.asDiagonal());
}

}  // namespace abbe
