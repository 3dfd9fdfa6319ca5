#include "abbe/compensate/correction_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/stated_uncertainty.h"

namespace abbe {

std::vector<double> propagated_uncertainty(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                           const std::function<std::vector<double>(const ErrorSet&)>& values) {
  const std::vector<double> at = values(errors);
  const std::vector<double> parameters = errors.parameters();
  const auto count = static_cast<Eigen::Index>(at.size());
  std::vector<Eigen::Index> uncertain;
  for (Eigen::Index p = 0; p < covariance.rows(); ++p) {
    if (covariance(p, p) > 0) uncertain.push_back(p);
  }
  const auto size = static_cast<Eigen::Index>(uncertain.size());
  Eigen::MatrixXd slopes(count, size), chosen(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::Index p = uncertain[static_cast<std::size_t>(k)];
    const double step = std::sqrt(covariance(p, p));
    std::vector<double> shifted = parameters;
    shifted[static_cast<std::size_t>(p)] += step;
    ErrorSet changed = errors;
    changed.set_parameters(shifted);
    const std::vector<double> there = values(changed);
    for (Eigen::Index v = 0; v < count; ++v) {
      const auto i = static_cast<std::size_t>(v);
      slopes(v, k) = (there[i] - at[i]) / step;
    }
    for (Eigen::Index l = 0; l < size; ++l) chosen(k, l) = covariance(p, uncertain[static_cast<std::size_t>(l)]);
  }
  std::vector<double> uncertainty(at.size(), 0.0);
  if (size == 0) return uncertainty;
  const Eigen::MatrixXd product = slopes * chosen;
  for (Eigen::Index v = 0; v < count; ++v) {
    uncertainty[static_cast<std::size_t>(v)] = std::sqrt(std::max(0.0, product.row(v).dot(slopes.row(v))));
  }
  return uncertainty;
}

Eigen::MatrixXd stated_variances(const ErrorSet& errors) {
  const std::vector<double> uncertainty = stated_uncertainties(errors);
  if (std::all_of(uncertainty.begin(), uncertainty.end(), [](double u) { return u == 0; })) return {};
  const auto size = static_cast<Eigen::Index>(uncertainty.size());
  return Eigen::VectorXd(Eigen::VectorXd::Map(uncertainty.data(), size).cwiseAbs2()).asDiagonal();
}

}  // namespace abbe
