#pragma once

#include <span>

namespace abbe {

/// Regularised incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a); a > 0, x >= 0.
///
/// Series for x < a + 1, continued fraction (modified Lentz) beyond. Source: DLMF 8.11.4, 8.9.2.
double incomplete_gamma_upper(double a, double x);

/// Regularised incomplete beta function I_x(a, b); a, b > 0, 0 <= x <= 1. Source: DLMF 8.17.22 (continued fraction).
double incomplete_beta(double a, double b, double x);

/// Probability that a chi-square variable of `degrees_of_freedom` exceeds `value`.
double chi_square_exceedance(double value, double degrees_of_freedom);

/// Value that a chi-square variable exceeds with this probability, 0 < exceedance < 1.
double chi_square_quantile(double exceedance, double degrees_of_freedom);

/// Value that a ratio of two independent mean squares of normal variables of one variance exceeds with this
/// probability (Fisher's F), 0 < exceedance < 1.
/// @param upper, lower  degrees of freedom of the numerator and of the denominator, both > 0
double fisher_quantile(double exceedance, double upper, double lower);

/// Probability that Student's t with `degrees_of_freedom` exceeds `t` (one-sided).
double student_exceedance(double t, double degrees_of_freedom);

/// Probability that independent values have so large a sum by chance if their expected sum is `expected` or less:
/// Student's t of their mean, one-sided, with the scatter that they show. 1 for fewer than three values.
double sum_exceedance(std::span<const double> values, double expected);

}  // namespace abbe
