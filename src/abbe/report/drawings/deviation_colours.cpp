#include "abbe/report/drawings/deviation_colours.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> deviation_colours(std::span<const double> deviation_mm,
                                                                 double range_mm) {
  // Equal in lightness at both ends, so that a grey print shows amounts.
  const Eigen::Vector3d inside(33, 102, 172), zero(225, 225, 225), outside(178, 24, 43);
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> colours(3, static_cast<Eigen::Index>(deviation_mm.size()));
  for (std::size_t i = 0; i < deviation_mm.size(); ++i) {
    const double share = std::clamp(deviation_mm[i] / range_mm, -1.0, 1.0);
    const Eigen::Vector3d colour = zero + std::abs(share) * ((share < 0 ? inside : outside) - zero);
    for (int k = 0; k < 3; ++k) {
      colours(k, static_cast<Eigen::Index>(i)) = static_cast<std::uint8_t>(std::lround(colour[k]));
    }
  }
  return colours;
}

double colour_range_mm(std::span<const double> deviation_mm) {
  std::vector<double> amounts;
  amounts.reserve(deviation_mm.size());
  for (const double value : deviation_mm) amounts.push_back(std::abs(value));
  return colour_range_of_amount(percentile(amounts, 0.98));
}

double colour_range_of_amount(double most) {
  if (!(most > 1e-9)) return 0.001;
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (most <= step * power) return step * power;
  }
  return 10 * power;
}

}  // namespace abbe
