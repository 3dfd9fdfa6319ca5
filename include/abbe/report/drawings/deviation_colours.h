#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace abbe {

/// Colours of signed deviations: blue inside of the material, grey at zero, red outside, full at +- the range.
/// @param range_mm  above zero
/// @return [3, n] red, green, blue
Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> deviation_colours(std::span<const double> deviation_mm, double range_mm);

/// Of the amounts of deviations: half of them, and 98 % of them, are smaller. Zeros if there are none.
struct DeviationAmounts {
  double middle_mm = 0, for_colours_mm = 0;
};
DeviationAmounts deviation_amounts(std::span<const double> deviation_mm);

/// A range that shows most of them: the 98th percentile of the amounts, rounded up to 1, 2 or 5 times a power of ten;
/// 0.001 mm if there are none but zeros.
double colour_range_mm(std::span<const double> deviation_mm);
/// The same from that percentile, mm.
double colour_range_of_amount(double most);

}  // namespace abbe
