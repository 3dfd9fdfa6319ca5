#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Deviation of the present values from a joint prior, and where its estimated parameters stand.
struct JointDeviation {
  Eigen::VectorXd deviation;
  std::vector<Index> estimates;  // -1: not estimated
};

JointDeviation joint_deviation(const Problem& problem, const JointPrior& prior, const Eigen::VectorXd& estimates) {
  JointDeviation result;
  result.deviation.resize(static_cast<Index>(prior.parameters.size()));
  const std::size_t count = estimated_count(problem);
  const std::vector<double> machine = problem.errors.parameters();
  for (std::size_t i = 0; i < prior.parameters.size(); ++i) {
    const ParameterId& id = prior.parameters[i];
    const std::size_t found = find_estimated(problem, id);
    double value = 0;
    if (found < count)
      value = estimates[static_cast<Index>(found)];
    else
      value = id.is_machine() ? machine[id.index]
                              : problem.observations[id.observations].observations->unknown_values()[id.index];
    const Index k = static_cast<Index>(i);
    result.deviation[k] = prior.value[k] - value;
    result.estimates.push_back(found < count ? static_cast<Index>(found) : Index{-1});
  }
  return result;
}

}  // namespace

void add_priors(const Problem& problem, const Eigen::VectorXd& estimates, NormalEquations& sums) {
  const std::size_t count = estimated_count(problem);
  for (const Prior& prior : problem.priors) {
    const std::size_t found = find_estimated(problem, prior.parameter);
    if (found >= count) continue;
    const Index k = static_cast<Index>(found);
    const double residual = (prior.value - estimates[k]) / prior.standard_uncertainty;
    sums.cost += residual * residual / 2;
    if (sums.gradient.size() > 0) sums.gradient[k] += residual / prior.standard_uncertainty;
    if (sums.normal.size() > 0) sums.normal(k, k) += 1 / (prior.standard_uncertainty * prior.standard_uncertainty);
  }
  for (const JointPrior& prior : problem.joint_priors) {
    const JointDeviation at = joint_deviation(problem, prior, estimates);
    const Eigen::VectorXd force = prior.information * at.deviation;
    sums.cost += at.deviation.dot(force) / 2;
    for (std::size_t i = 0; i < at.estimates.size(); ++i) {
      if (at.estimates[i] < 0) continue;
      if (sums.gradient.size() > 0) sums.gradient[at.estimates[i]] += force[static_cast<Index>(i)];
      if (sums.normal.size() == 0) continue;
      for (std::size_t j = 0; j < at.estimates.size(); ++j)
        if (at.estimates[j] >= 0)
          sums.normal(at.estimates[i], at.estimates[j]) +=
              prior.information(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
}

Eigen::MatrixXd prior_rows(const Problem& problem) {
  const Index p = static_cast<Index>(estimated_count(problem));
  std::vector<Eigen::RowVectorXd> rows;
  for (const Prior& prior : problem.priors) {
    const Index k = static_cast<Index>(find_estimated(problem, prior.parameter));
    if (k >= p) continue;
    rows.push_back(Eigen::RowVectorXd::Zero(p));
    rows.back()[k] = 1 / prior.standard_uncertainty;
  }
  for (const JointPrior& prior : problem.joint_priors) {
    // The root of a semi-definite matrix, taken in scaled parameters because mm and rad differ by orders of magnitude.
    const Eigen::VectorXd scale =
        prior.information.diagonal().unaryExpr([](double value) { return value > 0 ? 1 / std::sqrt(value) : 1.0; });
    const Eigen::MatrixXd scaled = scale.asDiagonal() * prior.information * scale.asDiagonal();
    const SymmetricEigen<> eigen(scaled);
    for (Index i = 0; i < scaled.rows(); ++i) {
      const double value = eigen.eigenvalues()[i];
      if (value <= 1e-15 * static_cast<double>(scaled.rows())) continue;
      rows.push_back(Eigen::RowVectorXd::Zero(p));
      for (std::size_t j = 0; j < prior.parameters.size(); ++j) {
        const Index k = static_cast<Index>(find_estimated(problem, prior.parameters[j]));
        const Index jj = static_cast<Index>(j);
        if (k < p) rows.back()[k] += std::sqrt(value) * eigen.eigenvectors()(jj, i) / scale[jj];
      }
    }
  }
  Eigen::MatrixXd result(static_cast<Index>(rows.size()), p);
  for (std::size_t i = 0; i < rows.size(); ++i) result.row(static_cast<Index>(i)) = rows[i];
  return result;
}

double prior_residual_count(const Problem& problem) {
  const std::size_t count = estimated_count(problem);
  double residuals = 0;
  for (const Prior& prior : problem.priors) residuals += find_estimated(problem, prior.parameter) < count ? 1 : 0;
  for (const JointPrior& prior : problem.joint_priors) residuals += prior.residual_count;
  return residuals;
}

}  // namespace abbe
