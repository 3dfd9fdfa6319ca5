#pragma once

#include <string>
#include <string_view>

namespace abbe {

/// Largest magnitude accepted from a file, in mm, rad, s or without unit: beyond it a number is a mistake.
inline constexpr double kLargestInput = 1e9;

/// Shortest decimal text that reads back as the same double; independent of the locale.
///
/// With a decimal shift the text is that of value * 10^shift, exact in decimal: 0.0025 mm shifted by 3 is "2.5" um.
/// Reading it back with the opposite shift gives the same bits, which multiplying by 1000 and 0.001 would not.
std::string shortest_text(double value, int decimal_shift = 0);

enum class NumberProblem { none, not_a_number, not_finite, too_large };

/// Correctly rounded value of decimal text times 10^shift; the whole text must be a number. Independent of the locale.
///
/// Accepts "12", "-1.5", "+.5", "1e-3"; refuses "nan", "inf", hexadecimal, spaces and decimal commas.
NumberProblem parse_number(std::string_view text, int decimal_shift, double& value);

}  // namespace abbe
