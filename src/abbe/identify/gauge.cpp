#include "abbe/identify/gauge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/conventional_gauge.h"
#include "abbe/identify/gauge_convention.h"
#include "abbe/identify/parameter_words.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
// Entries of a direction that are named, relative to its largest scaled entry.
constexpr double kInseparableEntry = 0.02;
constexpr std::size_t kMostInseparableNamed = 8;
// Parameters that lie in a space equally but for rounding: the first is taken.
constexpr double kAlike = 1e-6;

Eigen::VectorXd usable_scale(const Eigen::VectorXd& column_norms) {
  return column_norms.unaryExpr([](double norm) { return norm > 0 ? norm : 1.0; });
}

/// Which parameters the constraint does not tell apart.
void describe(const std::vector<EstimatedParameter>& parameters, const Eigen::VectorXd& scale,
              GaugeConstraint& constraint) {
  const std::string& quantity = constraint.quantity;
  constraint.inseparable = largest_entries(constraint.direction.cwiseProduct(scale), kInseparableEntry);
  const double own = constraint.functional.cwiseAbs().maxCoeff();
  std::string others;
  std::size_t named = 0;
  for (const std::size_t i : constraint.inseparable) {
    // What the quantity itself consists of is no other; a combination without a name is all of its parts.
    if (!quantity.empty() && std::abs(constraint.functional[static_cast<Index>(i)]) > 1e-9 * own) continue;
    if (named++ < kMostInseparableNamed) others += (others.empty() ? "" : ", ") + parameters[i].name;
  }
  if (named > kMostInseparableNamed) others += fmt::format(" and {} more", named - kMostInseparableNamed);
  if (quantity.empty()) {
    constraint.inseparable_words = fmt::format("a combination of {} is not seen by the readings", others);
    return;
  }
  constraint.inseparable_words = others.empty() ? fmt::format("{} is not seen by the readings", quantity)
                                                : fmt::format("{} is not separable from {}", quantity, others);
}

/// An orthonormal basis of the space of the given orthonormal columns that does not depend on which basis was given:
/// the projection of the parameter that lies in it most, then the same in what is left. An SVD gives any rotation of
/// it, and another one with every compiler.
Eigen::MatrixXd nearest_to_parameters(Eigen::MatrixXd space) {
  Eigen::MatrixXd result(space.rows(), space.cols());
  for (Index k = 0; k < result.cols(); ++k) {
    const Eigen::VectorXd part = space.rowwise().squaredNorm();
    const double most = part.maxCoeff();
    Index nearest = 0;
    while (part[nearest] < (1 - kAlike) * most) ++nearest;
    result.col(k) = space * space.row(nearest).transpose().normalized();
    const Qr qr(space.row(nearest).transpose());
    space = qr.rotated_from_right(space).rightCols(space.cols() - 1).eval();
  }
  return result;
}

}  // namespace

std::vector<GaugeConstraint> fix_gauge(const Problem& problem, const NullSpace& null_space,
                                       const Eigen::VectorXd& start, GaugeChoice choice, GaugeOrder order,
                                       const Eigen::VectorXd* found) {
  std::vector<GaugeConstraint> constraints;
  std::vector<std::string> quantities;
  const Index p = start.size(), q = null_space.basis.cols();
  if (q == 0 || choice == GaugeChoice::none) return constraints;
  const Eigen::VectorXd scale = usable_scale(null_space.column_norms);
  const Eigen::MatrixXd open = scale.asDiagonal() * null_space.basis;  // orthonormal
  Eigen::MatrixXd taken(q, 0);  // orthonormal, the part of the null space that is fixed

  if (choice == GaugeChoice::iso) {
    const std::vector<GaugeCandidate> candidates = gauge_candidates(problem, start);
    ConventionalGauge gauge(candidates, scale, open);
    for (const std::size_t i : gauge.chosen(order)) {
      GaugeConstraint constraint;
      constraint.words = candidates[i].words;
      constraint.functional = candidates[i].functional;
      constraint.value = candidates[i].value;
      if (found != nullptr && candidates[i].exchangeable) {
        constraint.words = candidates[i].quantity + " stays as the fit found it";
        constraint.value = constraint.functional.dot(*found);
      }
      constraints.push_back(std::move(constraint));
      quantities.push_back(candidates[i].quantity);
    }
    taken = gauge.fixed();
  }
  if (taken.cols() < q) {
    const Index rest = q - taken.cols();
    Eigen::MatrixXd left = Eigen::MatrixXd::Identity(q, q);
    if (taken.cols() > 0) {
      left = Qr(taken).rotated(left);
    }
    const Eigen::MatrixXd scaled = nearest_to_parameters(open * left.rightCols(rest));
    for (Index i = 0; i < rest; ++i) {
      GaugeConstraint constraint;
      constraint.functional = scaled.col(i).cwiseProduct(scale);
      constraint.value = constraint.functional.dot(start);
      constraint.words = fmt::format("unseen direction {}: smallest change from the start", i + 1);
      constraint.by_convention = choice == GaugeChoice::minimum_norm;
      constraints.push_back(std::move(constraint));
      quantities.emplace_back();
    }
  }

  Eigen::MatrixXd functionals(q, p);
  for (Index i = 0; i < q; ++i) functionals.row(i) = constraints[static_cast<std::size_t>(i)].functional;
  const Eigen::MatrixXd directions = null_space.basis * FullLu<>(functionals * null_space.basis).inverse();
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  for (Index i = 0; i < q; ++i) {
    GaugeConstraint& constraint = constraints[static_cast<std::size_t>(i)];
    constraint.direction = directions.col(i);
    constraint.quantity = quantities[static_cast<std::size_t>(i)];
    describe(parameters, scale, constraint);
  }
  return constraints;
}

ConstrainedSpace constrained_space(const std::vector<GaugeConstraint>& constraints, const Eigen::VectorXd& start,
                                   const Eigen::VectorXd& column_norms) {
  ConstrainedSpace space;
  space.particular = start;
  const Index q = static_cast<Index>(constraints.size()), p = start.size();
  if (q == 0) return space;
  const Eigen::VectorXd scale = usable_scale(column_norms);
  Eigen::MatrixXd functionals(q, p);  // in scaled parameters, rows of unit length
  Eigen::VectorXd values(q);
  for (Index i = 0; i < q; ++i) {
    const GaugeConstraint& constraint = constraints[static_cast<std::size_t>(i)];
    const Eigen::VectorXd scaled = constraint.functional.cwiseQuotient(scale);
    functionals.row(i) = scaled / scaled.norm();
    values[i] = constraint.value / scaled.norm();
    space.particular += constraint.direction * (constraint.value - constraint.functional.dot(start));
  }
  // Elimination instead of an orthogonal basis: a parameter that one equation sets alone comes out exactly.
  const FullLu<> lu(functionals);
  const Eigen::VectorXi columns = lu.columns();
  Eigen::MatrixXd pivot(q, q), free(q, p - q);
  for (Index i = 0; i < q; ++i) pivot.col(i) = functionals.col(columns[i]);
  for (Index i = q; i < p; ++i) free.col(i - q) = functionals.col(columns[i]);
  const PartialLu solver(pivot);
  const Eigen::MatrixXd eliminated = p > q ? Eigen::MatrixXd(-solver.solve_columns(free)) : Eigen::MatrixXd(q, 0);
  space.directions = Eigen::MatrixXd::Zero(p, p - q);
  for (Index j = 0; j < p - q; ++j) {
    space.directions(columns[q + j], j) = 1 / scale[columns[q + j]];
    for (Index i = 0; i < q; ++i)
      space.directions(columns[i], j) = std::abs(eliminated(i, j)) > 1e-14 ? eliminated(i, j) / scale[columns[i]] : 0.0;
  }
  // Rounding of the move along the unseen directions.
  Eigen::VectorXd scaled = space.particular.cwiseProduct(scale);
  const Eigen::VectorXd correction = solver.solve(values - functionals * scaled);
  for (Index i = 0; i < q; ++i) space.particular[columns[i]] += correction[i] / scale[columns[i]];
  return space;
}

}  // namespace abbe
