#include "abbe/identify/robust_covariance.h"

#include <algorithm>
#include <cmath>

namespace abbe {

LossMoments robust_moments(const Problem& problem, const std::vector<std::vector<double>>& norms,
                           const std::vector<Outlier>& outliers, const Loss& loss, double free_parameters) {
  double slope = 0, square = 0, slope_square = 0, count = 0;
  const auto add = [&](const LossMoments& moments, double residuals) {
    slope += residuals * moments.slope;
    square += residuals * moments.square;
    slope_square += residuals * moments.slope_square;
    count += residuals;
  };
  for (std::size_t o = 0; o < norms.size(); ++o) {
    const int rows = problem.observations[o].observations->rows();
    double good = 0;
    for (const double norm : norms[o]) good += norm >= 0 ? 1 : 0;
    for (const Outlier& outlier : outliers) {
      if (outlier.observations != o) continue;
      good -= 1;
      add(loss_moments_at(loss, rows, outlier.norm), rows);
    }
    add(loss_moments(loss, rows), good * rows);
  }
  if (!(count > 0) || !(slope > 0)) return {};
  const double a = slope / count, c = slope_square / count;
  const double correction = 1 + free_parameters / count * std::max(c / (a * a) - 1, 0.0);
  return {a, correction * correction * square / count, c};
}

Eigen::MatrixXd robust_curvature(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& prior_rows,
                                 const LossMoments& moments) {
  if (prior_rows.rows() == 0) return moments.slope * normal;
  return moments.slope * normal + (1 - moments.slope) * (prior_rows.transpose() * prior_rows);
}

Eigen::MatrixXd robust_factor(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& prior_rows,
                              const LossMoments& moments) {
  Eigen::MatrixXd stacked(factor.rows() + prior_rows.rows(), factor.cols());
  stacked.topRows(factor.rows()) = std::sqrt(moments.slope) * factor;
  // No loss here has a slope above one.
  if (prior_rows.rows() > 0) {
    stacked.bottomRows(prior_rows.rows()) = std::sqrt(std::max(1 - moments.slope, 0.0)) * prior_rows;
  }
  return stacked;
}

void spread_of_robust_estimates(const Eigen::MatrixXd& prior_rows, const LossMoments& moments,
                                Eigen::MatrixXd& covariance) {
  const double ratio = moments.square / moments.slope;
  if (prior_rows.rows() == 0) {
    covariance *= ratio;
    return;
  }
  const Eigen::MatrixXd by_priors = prior_rows * covariance;
  covariance = ratio * covariance + (1 - ratio) * (by_priors.transpose() * by_priors);
}

}  // namespace abbe
