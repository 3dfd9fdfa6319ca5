#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

/// Probabilities and quantiles, by Boost.Math in double precision. Nothing throws. Degrees of freedom are above 0 and
/// need not be whole; what is not, or a probability outside its range, gives NaN.

/// Regularised incomplete beta function I_x(a, b); a, b > 0; 0 for x <= 0, 1 for x >= 1.
double incomplete_beta(double a, double b, double x);

/// Probability that a chi-square variable of `degrees_of_freedom` exceeds `value`; 1 unless value > 0.
double chi_square_exceedance(double value, double degrees_of_freedom);

/// Value that a chi-square variable exceeds with this probability, 0 < exceedance < 1.
double chi_square_quantile(double exceedance, double degrees_of_freedom);

/// Value that a ratio of two independent mean squares of normal variables of one variance exceeds with this
/// probability (Fisher's F), 0 < exceedance < 1.
/// @param upper, lower  degrees of freedom of the numerator and of the denominator, both > 0
double fisher_quantile(double exceedance, double upper, double lower);

/// Probability that Student's t with `degrees_of_freedom` exceeds `t` (one-sided).
double student_exceedance(double t, double degrees_of_freedom);
/// Value that Student's t exceeds with this probability, 0 < exceedance < 1.
double student_quantile(double exceedance, double degrees_of_freedom);

/// Probability that independent values have so large a sum by chance if their expected sum is `expected` or less:
/// Student's t of their mean, one-sided, with the scatter that they show. 1 for fewer than three values.
double sum_exceedance(std::span<const double> values, double expected);

/// Natural logarithm of the probability of `marked_drawn` or more marked items in a draw of `drawn` without replacement
/// from `all` items of which `marked` are marked. Of many items the probability itself may be too small for a double.
double log_hypergeometric_exceedance(std::size_t all, std::size_t marked, std::size_t drawn, std::size_t marked_drawn);

/// Probabilities of several tests, adjusted so that each may be compared with the level of the family: whoever rejects
/// where the adjusted one is at most a level rejects any true hypothesis with at most that probability, however the
/// tests depend on each other. The smallest is multiplied by the number of tests, the next by one less, and so on; none
/// is below the one before it, none above 1.
/// Source: S. Holm, A simple sequentially rejective multiple test procedure, Scand. J. Statist. 6 (1979) 65.
std::vector<double> holm_adjusted(std::span<const double> probabilities);

}  // namespace abbe
