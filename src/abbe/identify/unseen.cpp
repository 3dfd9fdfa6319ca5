#include "abbe/identify/unseen.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/geometry/singular_values.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
// A direction is separable if less than this part of it is left unseen.
constexpr double kLeftUnseen = 0.1;
constexpr double kStillZero = 1e-7;
constexpr double kQuarter = 0.25;
constexpr double kNamedEntry = 0.2;
constexpr std::size_t kMostNamed = 4;

/// Rows of the estimates with the measurement's own unknowns taken out: what it says whatever they are.
Eigen::MatrixXd without_own(const PossibleMeasurement& measurement, Index parameters) {
  const Eigen::MatrixXd rows = measurement.rows.leftCols(parameters);
  if (measurement.own == 0) return rows;
  const Eigen::MatrixXd own = measurement.rows.rightCols(static_cast<Index>(measurement.own));
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(own);
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(own.rows(), qr.rank());
  return rows - basis * (basis.transpose() * rows);
}

/// Which part of `direction` (a column of `open`'s space) the rows leave unseen; all in scaled parameters.
double left_unseen(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& open, const Eigen::VectorXd& direction) {
  const Eigen::MatrixXd seen = rows * open;
  const RightSingular svd = right_singular(seen);
  const double limit = kStillZero * std::max(rows.norm(), 1e-300);
  Index rank = 0;
  while (rank < svd.values.size() && svd.values[rank] > limit) ++rank;
  const Eigen::MatrixXd rest = svd.vectors.rightCols(open.cols() - rank);
  return (rest.transpose() * (open.transpose() * direction)).norm() / direction.norm();
}

std::vector<std::size_t> largest_entries(const Eigen::VectorXd& scaled) {
  std::vector<std::size_t> order(static_cast<std::size_t>(scaled.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  const Eigen::VectorXd size = scaled.cwiseAbs();
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return size[static_cast<Index>(a)] > size[static_cast<Index>(b)];
  });
  const double largest = size.maxCoeff();
  while (!order.empty() && size[static_cast<Index>(order.back())] < kNamedEntry * largest) order.pop_back();
  return order;
}

std::string names(const std::vector<EstimatedParameter>& parameters, const std::vector<std::size_t>& which) {
  std::string text;
  for (std::size_t k = 0; k < std::min(which.size(), kMostNamed); ++k)
    text += (k == 0 ? "" : k + 1 == which.size() ? " and " : ", ") + parameters[which[k]].name;
  if (which.size() > kMostNamed) text += fmt::format(" and {} more", which.size() - kMostNamed);
  return text;
}

}  // namespace

std::vector<Advice> unseen_advice(const Problem& problem, const Identification& identification,
                                  const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options) {
  std::vector<Advice> result;
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  const Index p = static_cast<Index>(parameters.size());
  if (identification.covariance.rows() != p || p == 0) return result;
  Eigen::VectorXd typical(p);
  for (Index i = 0; i < p; ++i) {
    const EstimatedParameter& parameter = parameters[static_cast<std::size_t>(i)];
    // What is known of a set-up beforehand is coarse: a weak direction is about the machine.
    const double factor = parameter.id.is_machine() ? 1 : 1e3;
    typical[i] = factor * (parameter.is_angle ? options.typical_angle : options.typical_length);
  }
  std::vector<Eigen::MatrixXd> rows;
  for (const PossibleMeasurement& measurement : possible)
    rows.push_back(without_own(measurement, p) * typical.asDiagonal());

  const std::vector<GaugeConstraint>& constraints = identification.gauge.constraints;
  Eigen::MatrixXd open(p, 0);  // unseen directions in units of typical sizes, orthonormal
  if (!constraints.empty()) {
    // Where the trials are: unseen directions turn a little with the errors.
    Eigen::VectorXd nominal = present_values(problem);
    for (Index i = 0; i < p; ++i)
      if (parameters[static_cast<std::size_t>(i)].id.is_machine()) nominal[i] = 0;
    const NullSpace null_space = find_null_space(problem, nominal);
    set_observations(problem, identification.estimates);
    if (null_space.basis.cols() > 0) {
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(typical.cwiseInverse().asDiagonal() * null_space.basis);
      open = qr.householderQ() * Eigen::MatrixXd::Identity(p, null_space.basis.cols());
    }
  }
  for (const GaugeConstraint& constraint : constraints) {
    Advice advice;
    advice.parameters = constraint.inseparable;
    advice.text = constraint.inseparable_words;
    const Eigen::VectorXd given = constraint.direction.cwiseQuotient(typical);
    const Eigen::VectorXd direction = open * (open.transpose() * given);
    // Not unseen at nominal errors: nothing to try there.
    const bool tried = direction.norm() > 0.9 * given.norm();
    for (std::size_t k = 0; k < possible.size() && tried && !advice.shown; ++k) {
      if (left_unseen(rows[k], open, direction) > kLeftUnseen) continue;
      advice.shown = true;
      advice.remedy = possible[k].words + " would show it";
    }
    if (!advice.shown)
      advice.remedy = possible.empty() || !tried ? "no additional measurement was tried"
                      : constraint.by_convention ? "none is needed: it is a convention (" + constraint.words + ")"
                                                 : "none of the measurements tried would show it";
    result.push_back(std::move(advice));
  }

  const Eigen::MatrixXd covariance =
      typical.cwiseInverse().asDiagonal() * identification.covariance * typical.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  for (Index k = p; k-- > 0;) {
    const double variance = eigen.eigenvalues()[k];
    if (!(variance > options.weak * options.weak)) break;
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    Advice advice;
    advice.unseen = false;
    advice.parameters = largest_entries(direction);
    if (!parameters[advice.parameters.front()].id.is_machine()) continue;
    const bool angle = parameters[advice.parameters.front()].is_angle;
    const double size = std::sqrt(variance) * std::abs(direction[static_cast<Index>(advice.parameters.front())]) *
                        typical[static_cast<Index>(advice.parameters.front())];
    advice.text =
        fmt::format("{}{} {} seen only weakly: standard uncertainty of {} {:.3g} {}",
                    advice.parameters.size() > 1 ? "a combination of " : "", names(parameters, advice.parameters), "is",
                    parameters[advice.parameters.front()].name, (angle ? 1e6 : 1e3) * size, angle ? "urad" : "um");
    for (std::size_t m = 0; m < possible.size() && !advice.shown; ++m) {
      // Variance after adding rows A: d'(C - C A'(I + A C A')^-1 A C) d.
      const Eigen::MatrixXd spread = rows[m] * covariance;
      Eigen::MatrixXd inner = spread * rows[m].transpose();
      inner.diagonal().array() += 1;
      const Eigen::VectorXd seen = spread * direction;
      const double after = variance - seen.dot(inner.llt().solve(seen));
      if (!(after < kQuarter * variance)) continue;
      advice.shown = true;
      advice.remedy = fmt::format("{} would lower it {:.1f} times", possible[m].words,
                                  std::sqrt(variance / std::max(after, 1e-12 * variance)));
    }
    if (!advice.shown) advice.remedy = "more readings of the same kind, or a more accurate instrument";
    result.push_back(std::move(advice));
  }
  return result;
}

}  // namespace abbe
