#include "abbe/identify/trust/independent_readings.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

constexpr double kOwnShare = 1e-9;      // variance that the fit of the set-ups leaves a residual: less is rounding
constexpr double kIndependent = 1e-10;  // of scaled columns

/// The range of a symmetric, positive semi-definite matrix A = S V E V' S, scaled to a unit diagonal.
struct ScaledRange {
  Eigen::VectorXd scale;    ///< of S; 0 where the diagonal of A is
  Eigen::MatrixXd vectors;  ///< V, [n, rank]
  Eigen::VectorXd values;   ///< of E, [rank]
};

ScaledRange scaled_range(const Eigen::MatrixXd& matrix) {
  ScaledRange range;
  range.scale = matrix.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = range.scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const SymmetricEigen<> eigen(inverse.asDiagonal() * matrix * inverse.asDiagonal());
  const double least = kIndependent * std::max(eigen.eigenvalues().maxCoeff(), 0.0);
  Index first = 0;
  while (first < matrix.rows() && eigen.eigenvalues()[first] <= least) ++first;
  range.vectors = eigen.eigenvectors().rightCols(matrix.rows() - first);
  range.values = eigen.eigenvalues().tail(matrix.rows() - first);
  return range;
}

/// F with A = F F'.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& matrix) {
  const ScaledRange range = scaled_range(matrix);
  return range.scale.asDiagonal() * range.vectors * range.values.cwiseSqrt().asDiagonal();
}

/// W with W'AW = I that spans the range of A in scaled coordinates.
Eigen::MatrixXd whitening_of(const Eigen::MatrixXd& matrix) {
  const ScaledRange range = scaled_range(matrix);
  const Eigen::VectorXd inverse = range.scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  return inverse.asDiagonal() * range.vectors * range.values.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Everything by the uncertain combinations of the errors, z with covariance I, and by whitened unknowns of the
/// set-ups.
struct Directions {
  Eigen::MatrixXd errors;  ///< [machine parameters, z]
  Eigen::MatrixXd setups;  ///< [unknowns, t]
  Eigen::MatrixXd across;  ///< [t, z] change of the fitted set-ups with the errors
};

struct ReadingNorm {
  std::size_t observations = 0, reading = 0;
  double norm = 0;
  std::size_t components = 0, within = 0;
};

ReadingNorm norm_of(const Eigen::VectorXd& residual, const Eigen::MatrixXd& by_errors,
                    const Eigen::MatrixXd& by_setups) {
  const Index rows = residual.size();
  const Eigen::MatrixXd spread =
      Eigen::MatrixXd::Identity(rows, rows) - by_setups * by_setups.transpose() + by_errors * by_errors.transpose();
  ReadingNorm result;
  for (Index row = 0; row < rows; ++row) {
    if (spread(row, row) < kOwnShare) continue;
    ++result.components;
    result.within += std::abs(residual[row]) <= 2 * std::sqrt(spread(row, row)) ? 1U : 0U;
  }
  const SymmetricEigen<> eigen(spread);
  double square = 0;
  for (Index i = 0; i < rows; ++i) {
    if (eigen.eigenvalues()[i] < kOwnShare) continue;
    const double along = eigen.eigenvectors().col(i).dot(residual);
    square += along * along / eigen.eigenvalues()[i];
  }
  result.norm = std::sqrt(square);
  return result;
}

}  // namespace

IndependentReadings judge_independent_readings(const Problem& problem, const Eigen::MatrixXd& covariance, int threads) {
  Problem all = problem;
  all.machine_parameters.clear();
  for (Index p = 0; p < covariance.rows(); ++p) {
    if (covariance(p, p) > 0) all.machine_parameters.push_back(static_cast<std::size_t>(p));
  }
  const std::vector<std::size_t>& uncertain = all.machine_parameters;
  const auto machine = static_cast<Index>(uncertain.size());
  const Eigen::VectorXd at = present_values(all);
  const Index unknowns = at.size() - machine;
  const ReadingStream stream(all, threads);
  const NormalEquations sums = stream.sums(at, Loss{}, Wanted::normal);

  Directions directions;
  directions.errors = machine > 0 ? root_of(covariance(uncertain, uncertain)) : Eigen::MatrixXd(0, 0);
  directions.setups =
      unknowns > 0 ? whitening_of(sums.normal.bottomRightCorner(unknowns, unknowns)) : Eigen::MatrixXd(0, 0);
  directions.across =
      directions.setups.transpose() * sums.normal.bottomLeftCorner(unknowns, machine) * directions.errors;
  const Index z = directions.errors.cols(), t = directions.setups.cols();

  Eigen::MatrixXd normal(z + t, z + t);
  normal.topLeftCorner(z, z) =
      directions.errors.transpose() * sums.normal.topLeftCorner(machine, machine) * directions.errors +
      Eigen::MatrixXd::Identity(z, z);
  normal.bottomLeftCorner(t, z) = directions.across;
  normal.topRightCorner(z, t) = directions.across.transpose();
  normal.bottomRightCorner(t, t).setIdentity();
  Eigen::VectorXd gradient(z + t);
  gradient << directions.errors.transpose() * sums.gradient.head(machine),
      directions.setups.transpose() * sums.gradient.tail(unknowns);

  IndependentReadings result;
  result.chi_square = 2 * sums.cost;
  if (z + t > 0) result.chi_square -= gradient.dot(Ldlt<>(normal).solve(gradient));
  result.chi_square = std::max(result.chi_square, 0.0);
  const double count = static_cast<double>(stream.residual_count()) + prior_residual_count(all);
  result.residuals = static_cast<std::size_t>(std::lround(count));
  result.degrees_of_freedom = count - static_cast<double>(t);
  if (result.degrees_of_freedom > 0) {
    result.p_value = chi_square_exceedance(result.chi_square, result.degrees_of_freedom);
  }

  std::vector<std::vector<ReadingNorm>> pieces(stream.piece_count());
  stream.for_each(true, Loss{}, [&](std::size_t piece, const ResidualBlock& block, double) {
    const Index rows = block.rows;
    Eigen::MatrixXd by_errors(rows, machine), by_setups(rows, unknowns);
    Eigen::VectorXd residual(rows);
    const std::vector<std::uint8_t>& use = all.observations[block.observations].use;
    for (std::size_t k = 0; k < block.count; ++k) {
      if (!use.empty() && use[block.first + k] == 0) continue;
      by_errors.setZero();
      by_setups.setZero();
      for (Index row = 0; row < rows; ++row) {
        const std::size_t index = static_cast<std::size_t>(row) * block.count + k;
        residual[row] = block.residuals[index];
        for (std::size_t c = 0; c < block.estimates->size(); ++c) {
          const auto column = static_cast<Index>((*block.estimates)[c]);
          const double value = block.jacobian[c * block.stride + index];
          (column < machine ? by_errors(row, column) : by_setups(row, column - machine)) = value;
        }
      }
      const Eigen::MatrixXd setups = by_setups * directions.setups;
      ReadingNorm one = norm_of(residual, by_errors * directions.errors - setups * directions.across, setups);
      one.observations = block.observations;
      one.reading = block.first + k;
      pieces[piece].push_back(one);
    }
  });
  for (const SelectedObservations& selected : all.observations) {
    result.norm.emplace_back(selected.observations->reading_count(), -1.0);
  }
  for (const std::vector<ReadingNorm>& piece : pieces) {
    for (const ReadingNorm& one : piece) {
      result.norm[one.observations][one.reading] = one.norm;
      result.components += one.components;
      result.components_within += one.within;
    }
  }
  return result;
}

}  // namespace abbe
