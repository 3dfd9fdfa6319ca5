#include "abbe/identify/trust/monte_carlo_comparison.h"

#include <algorithm>
#include <cmath>

#include "abbe/identify/distributions.h"

namespace abbe {

MonteCarloComparison compare_with_covariance(const Identification& identification, const MonteCarloResult& simulated,
                                             double significance) {
  MonteCarloComparison comparison;
  const Eigen::VectorXd& uncertainties = identification.standard_uncertainties;
  if (simulated.status != MonteCarloStatus::done || simulated.samples < 2 ||
      simulated.mean.size() != uncertainties.size()) {
    return comparison;
  }
  comparison.samples = simulated.samples;
  for (Eigen::Index p = 0; p < uncertainties.size(); ++p) {
    const double u = uncertainties[p];
    // What the gauge fixes is certain by convention: there is nothing to simulate.
    if (!(u > 0)) continue;
    UncertaintyRatio entry;
    entry.parameter = static_cast<std::size_t>(p);
    entry.ratio = std::sqrt(std::max(simulated.covariance(p, p), 0.0)) / u;
    entry.shift = (simulated.mean[p] - identification.estimates[p]) / u;
    comparison.parameters.push_back(entry);
  }
  if (comparison.parameters.empty()) return comparison;

  const double m = static_cast<double>(simulated.samples);
  const double tail = significance / (4 * static_cast<double>(comparison.parameters.size()));
  comparison.ratio_low = std::sqrt(chi_square_quantile(1 - tail, m - 1) / (m - 1));
  comparison.ratio_high = std::sqrt(chi_square_quantile(tail, m - 1) / (m - 1));
  comparison.shift_limit = std::sqrt(chi_square_quantile(2 * tail, 1) / m);
  comparison.smallest_ratio = comparison.largest_ratio = comparison.parameters.front().ratio;
  for (const UncertaintyRatio& entry : comparison.parameters) {
    comparison.smallest_ratio = std::min(comparison.smallest_ratio, entry.ratio);
    comparison.largest_ratio = std::max(comparison.largest_ratio, entry.ratio);
    comparison.largest_shift = std::max(comparison.largest_shift, std::abs(entry.shift));
    const bool within = entry.ratio >= comparison.ratio_low && entry.ratio <= comparison.ratio_high &&
                        std::abs(entry.shift) <= comparison.shift_limit;
    if (!within) ++comparison.beyond;
  }
  return comparison;
}

}  // namespace abbe
