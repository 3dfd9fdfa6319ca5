#include <algorithm>
#include <cmath>

#include "abbe/geometry/column_norms.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/identify/gauge.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
// Singular values relative to the largest.
constexpr double kUnseen = 5e-14;
constexpr double kWeak = 3e-8;
// Eigenvalues of J'J relative to the largest: clear of rounding above, nothing but rounding below.
constexpr double kClearlySeen = 1e-9;
constexpr double kSeen = 1e-12;  // a hundred times above rounding
constexpr double kRounding = 1e-14;
constexpr double kQuickFactor = 5e8;  // products

}  // namespace

NullSpace find_null_space(const Problem& problem, const Eigen::VectorXd& estimates, int threads) {
  const ReadingStream stream(problem, threads);
  return find_null_space(stream, estimates, stream.sums(estimates, Loss{}, Wanted::normal));
}

NullSpace find_null_space(const ReadingStream& stream, const Eigen::VectorXd& estimates, const NormalEquations& sums) {
  NullSpace result;
  const Index p = estimates.size();
  result.column_norms = sums.normal.diagonal().cwiseMax(0.0).cwiseSqrt();
  result.singular_values = Eigen::VectorXd::Zero(p);
  if (p == 0) return result;
  drop_rounding_columns(result.column_norms);
  const Eigen::VectorXd inverse = result.column_norms.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 0.0; });
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * sums.normal * inverse.asDiagonal();
  SymmetricEigen<> eigen(scaled, Eigen::EigenvaluesOnly);
  const auto singular_values = [&] {
    const double largest = std::max(eigen.eigenvalues()[p - 1], 1e-300);
    for (Index i = 0; i < p; ++i)
      result.singular_values[i] = std::sqrt(std::max(0.0, eigen.eigenvalues()[p - 1 - i] / largest));
  };
  singular_values();
  result.rank = static_cast<std::size_t>(p);
  const auto relative = [&](Index i) { return eigen.eigenvalues()[i] / std::max(eigen.eigenvalues()[p - 1], 1e-300); };
  // Small problems can afford more digits of the singular values.
  const double work = static_cast<double>(stream.residual_count()) * static_cast<double>(p * p);
  const double seen_above = work < kQuickFactor ? kClearlySeen : kSeen;
  if (relative(0) > seen_above) {
    result.basis.resize(p, 0);
    return result;
  }

  Eigen::MatrixXd vectors;  // of the unseen directions, scaled
  bool ambiguous = false;
  for (Index i = 0; i < p; ++i) ambiguous = ambiguous || (relative(i) > kRounding && relative(i) < seen_above);
  // Rounding hides what lies below 1e-7 in J'J. The orthogonal factor shows it; with very many readings it takes
  // seconds, and then only an open question is worth them.
  if (ambiguous || work < kQuickFactor) {
    const Eigen::MatrixXd factor = stream.orthogonal_factor(estimates, Loss{}) * inverse.asDiagonal();
    const RightSingular svd = right_singular(factor);
    result.refined = true;
    result.singular_values = svd.values / std::max(svd.values[0], 1e-300);
    vectors = svd.vectors;
  } else {
    eigen = SymmetricEigen<>(scaled);
    singular_values();
    vectors = eigen.eigenvectors().rowwise().reverse();
    for (Index i = 0; i < p; ++i)
      if (result.singular_values[i] * result.singular_values[i] < kRounding) result.singular_values[i] = 0;
  }
  Index seen = p, clearly_seen = p;
  while (seen > 0 && !(result.singular_values[seen - 1] > kUnseen)) --seen;
  while (clearly_seen > 0 && !(result.singular_values[clearly_seen - 1] > kWeak)) --clearly_seen;
  result.rank = static_cast<std::size_t>(seen);
  result.weak = static_cast<std::size_t>(seen - clearly_seen);
  result.basis = vectors.rightCols(p - clearly_seen);
  if (result.basis.cols() == 0) return result;
  // Parameters without any influence have no scale; their direction is the parameter itself.
  for (Index i = 0; i < p; ++i) result.basis.row(i) *= result.column_norms[i] > 0 ? inverse[i] : 1.0;
  return result;
}

}  // namespace abbe
