#include "abbe/report/drawings/deviation_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "abbe/verify/evaluations/statistics.h"
#include "abbe/verify/evaluations/values_at_places.h"

namespace abbe {

Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> deviation_colours(std::span<const double> deviation_mm,
                                                                 double range_mm) {
  // Equal in lightness at both ends, so that a grey print shows amounts.
  constexpr std::array<double, 3> kInside = {33, 102, 172}, kOutside = {178, 24, 43};
  constexpr double kZero = 225;
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> colours(3, static_cast<Eigen::Index>(deviation_mm.size()));
  for (std::size_t i = 0; i < deviation_mm.size(); ++i) {
    const double share = std::clamp(deviation_mm[i] / range_mm, -1.0, 1.0);
    const std::array<double, 3>& end = share < 0 ? kInside : kOutside;
    std::uint8_t* const colour = colours.data() + 3 * i;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = kZero + std::abs(share) * (end[k] - kZero);
      // It lies between 24 and 225, where this is lround(), which is a call for each value.
      colour[k] = static_cast<std::uint8_t>(value + 0.5);  // NOLINT(bugprone-incorrect-roundings): see above
    }
  }
  return colours;
}

DeviationAmounts deviation_amounts(std::span<const double> deviation_mm) {
  if (deviation_mm.empty()) return {};
  std::vector<double> amounts;
  amounts.reserve(deviation_mm.size());
  for (const double value : deviation_mm) amounts.push_back(std::abs(value));
  constexpr double kShown = 0.98;
  const double place = kShown * static_cast<double>(amounts.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(below);
  const std::array<std::size_t, 3> places = {amounts.size() / 2, below, std::min(below + 1, amounts.size() - 1)};
  const std::vector<double> found = values_at_places(amounts, places);
  return {found[0], share == 0 ? found[1] : found[1] + share * (found[2] - found[1])};
}

double colour_range_mm(std::span<const double> deviation_mm) {
  return colour_range_of_amount(deviation_amounts(deviation_mm).for_colours_mm);
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
