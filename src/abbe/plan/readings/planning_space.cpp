#include "abbe/plan/readings/planning_space.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "abbe/geometry/column_norms.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/plan/readings/all_rows.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kDetermined = 1e-10;
constexpr double kWeakestRounding = 1e-14;

void require_finite(const PlanningCandidates& candidates) {
  if (!candidates.rows.allFinite()) throw std::invalid_argument("planning: a derivative is not finite");
}

void validate(const PlanningCandidates& candidates, const Eigen::MatrixXd& known) {
  const auto fail = [](const char* what) { throw std::invalid_argument(what); };
  if (candidates.count() == 0) fail("planning: no candidates");
  if (candidates.first_row.front() != 0 ||
      candidates.first_row.back() != static_cast<std::size_t>(candidates.rows.rows()))
    fail("planning: rows of the candidates do not add up");
  for (std::size_t i = 0; i < candidates.count(); ++i) {
    if (candidates.first_row[i + 1] <= candidates.first_row[i] ||
        candidates.first_row[i + 1] - candidates.first_row[i] > PlanningCandidates::kMostRows)
      fail("planning: a candidate needs 1 to 16 rows");
  }
  if (!candidates.cost_s.empty() && candidates.cost_s.size() != candidates.count())
    fail("planning: costs are not one per candidate");
  for (const double cost : candidates.cost_s)
    if (!(cost > 0) || !std::isfinite(cost)) fail("planning: a cost is not above zero");
  if (known.rows() > 0 && known.cols() != candidates.rows.cols()) fail("planning: known rows have another length");
  if (!known.allFinite()) fail("planning: a derivative is not finite");
}

void add_known(const PlanningSpace& space, StreamingFactor& stream) {
  for (Index k = 0; k < space.known_rows().rows(); ++k) {
    stream.next() = space.known_rows().row(k);
    stream.add();
  }
}

/// Singular value decomposition of the rows of a choice in seen coordinates, what is known included.
RightSingular decompose(const PlanningSpace& space, std::span<const std::size_t> chosen) {
  const Index v = static_cast<Index>(space.dimension());
  StreamingFactor stream(v);
  add_known(space, stream);
  for (const std::size_t candidate : chosen)
    for (std::size_t k = 0; k < space.row_count(candidate); ++k) {
      stream.next() = Eigen::Map<const Eigen::RowVectorXd>(space.row(space.first_row(candidate) + k), v);
      stream.add();
    }
  return right_singular(stream.factor());
}

std::size_t rank_of(const PlanningSpace& space, const Eigen::VectorXd& singular) {
  const double smallest = singular.size() > 0 ? space.determined() * singular[0] : 0;
  return static_cast<std::size_t>((singular.array() > smallest).count());
}

PlanValue value_of(const PlanningSpace& space, const RightSingular& svd, const Eigen::MatrixXd& functionals) {
  PlanValue value;
  value.rank = rank_of(space, svd.values);
  value.determined = value.rank == space.dimension();
  if (!value.determined) return value;
  value.log_determinant = 2 * svd.values.array().log().sum();
  if (functionals.rows() > 0)
    value.variance =
        (space.functionals(functionals) * svd.vectors * svd.values.cwiseInverse().asDiagonal()).squaredNorm();
  return value;
}

}  // namespace

PlanningSpace::PlanningSpace(const PlanningCandidates& candidates, const Eigen::MatrixXd& known,
                             const WorkInStep& in_step, int threads, double threshold)
    : first_row_(candidates.first_row), cost_s_(candidates.cost_s) {
  validate(candidates, known);
  const Index p = candidates.rows.cols();
  column_norms_ = squares_of_columns(candidates.rows, threads);
  // If all sums are finite, so are all numbers; large numbers may have an infinite sum.
  if (!column_norms_.allFinite()) require_finite(candidates);
  if (known.rows() > 0) column_norms_ += known.colwise().squaredNorm().transpose();
  column_norms_ = column_norms_.cwiseSqrt().eval();
  drop_rounding_columns(column_norms_);
  const Eigen::VectorXd inverse = column_norms_.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 0.0; });

  const RightSingular svd = right_singular(factor_of_rows(candidates.rows, known, inverse, {in_step, threads}));
  const double largest = p > 0 ? std::max(svd.values[0], 1e-300) : 1;
  singular_values_ = svd.values / largest;
  Index v = p;
  while (v > 0 && !(singular_values_[v - 1] > threshold)) --v;
  determined_ = std::max(kDetermined, v > 0 ? kWeakestRounding / singular_values_[v - 1] : 0.0);
  estimates_from_seen_ =
      inverse.asDiagonal() * svd.vectors.leftCols(v) * (singular_values_.head(v) * largest).cwiseInverse().asDiagonal();
  // Parameters without any influence have no scale; their direction is the parameter itself.
  unseen_ = inverse.unaryExpr([](double scale) { return scale > 0 ? scale : 1.0; }).asDiagonal() *
            svd.vectors.rightCols(p - v);

  known_rows_ = known.rows() > 0 ? Eigen::MatrixXd(known * estimates_from_seen_) : Eigen::MatrixXd(0, v);
  known_information_ = known_rows_.transpose() * known_rows_;
  stride_ = padded(static_cast<std::size_t>(v), kLengthMultiple);
  rows_ = multiply_rows(candidates.rows, estimates_from_seen_, {in_step, threads}, stride_);
}

Eigen::MatrixXd PlanningSpace::functionals(const Eigen::MatrixXd& rows) const { return rows * estimates_from_seen_; }

Eigen::VectorXd PlanningSpace::unseen_part(const Eigen::MatrixXd& rows) const {
  const Eigen::VectorXd inverse = column_norms_.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 1.0; });
  const Eigen::VectorXd whole = (rows * inverse.asDiagonal()).rowwise().norm();
  const Eigen::VectorXd part = (rows * unseen_).rowwise().norm();
  return part.binaryExpr(whole, [](double a, double b) { return b > 0 ? a / b : 0.0; });
}

PlanValue value_of(const PlanningSpace& space, std::span<const std::size_t> chosen,
                   const Eigen::MatrixXd& functionals) {
  PlanValue value = value_of(space, decompose(space, chosen), functionals);
  for (const std::size_t candidate : chosen) value.cost += space.cost(candidate);
  return value;
}

PlanValue value_of(const PlanningSpace& space, const PlanningCandidates& others, const Eigen::MatrixXd& functionals) {
  if (others.rows.rows() > 0) {
    validate(others, Eigen::MatrixXd());
    require_finite(others);
  }
  StreamingFactor stream(static_cast<Index>(space.dimension()));
  add_known(space, stream);
  for (Index k = 0; k < others.rows.rows(); ++k) {
    stream.next().noalias() = others.rows.row(k) * space.estimates_from_seen();
    stream.add();
  }
  PlanValue value = value_of(space, right_singular(stream.factor()), functionals);
  for (std::size_t i = 0; i < others.count(); ++i) value.cost += others.cost(i);
  return value;
}

Eigen::MatrixXd planned_covariance(const PlanningSpace& space, std::span<const std::size_t> chosen) {
  const RightSingular svd = decompose(space, chosen);
  if (rank_of(space, svd.values) != space.dimension()) return {};
  const Eigen::MatrixXd root = space.estimates_from_seen() * svd.vectors * svd.values.cwiseInverse().asDiagonal();
  return root * root.transpose();
}

}  // namespace abbe
