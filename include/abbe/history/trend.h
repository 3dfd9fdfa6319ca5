#pragma once

#include <optional>
#include <vector>

namespace abbe {

/// A value at one time, with its standard uncertainty.
struct TimedValue {
  double time = 0;         ///< in any unit
  double value = 0;        ///< in any unit
  double uncertainty = 0;  ///< > 0, independent of the others
};

/// A straight line through values that scatter more than their uncertainties say.
///
/// value_k = level + slope (time_k - time_last) + e_k with variance u_k^2 + scatter^2, by weighted least squares. The
/// scatter makes the weighted sum of squares equal to its degrees of freedom (Paule and Mandel, J. Res. NBS 87 (1982)
/// 377; DerSimonian and Kacker, Contemp. Clin. Trials 28 (2007) 105); it is 0 if the sum is smaller without it.
struct Trend {
  double level = 0;  ///< at the last time
  double slope = 0;  ///< per unit of time
  double u_level = 0, u_slope = 0;
  double covariance = 0;          ///< of both
  std::optional<double> scatter;  ///< none with two values, which are on a line
  double coverage_factor = 2;     ///< for 95.45 %: of Student's t with n - 2 degrees of freedom if there is a scatter
  std::optional<double> probability;  ///< of so large a slope without a drift

  /// Whether the slope is significant, at 95.45 %.
  bool drifts() const;
  /// Value at a time and its standard uncertainty, without the scatter.
  double at(double time_from_last) const { return level + slope * time_from_last; }
  double u_at(double time_from_last) const;
  /// Expanded uncertainty of a value at a time, with the scatter.
  double expanded_at(double time_from_last) const;
};

/// @param values  two or more, at different times; in the order of time
/// @throws std::invalid_argument otherwise
Trend fit_trend(const std::vector<TimedValue>& values);

/// What the earlier values predict for the time of the last one, and whether the last one agrees.
struct Expected {
  double value = 0;     ///< of the trend of the earlier ones; with one earlier value: that value
  double expanded = 0;  ///< of the difference to the last value: trend, scatter and the last value's own uncertainty
  bool is_within = true;
};
/// @param values  two or more; in the order of time
/// @param wander  variance that the value itself gains per unit of time by a random walk, after the value before the
/// last
Expected expected_last(const std::vector<TimedValue>& values, double wander = 0);

/// Time after the last value when the trend may have left the band of `limit` around what was identified last: the
/// expected change and its expanded uncertainty together reach the limit.
/// @param u_last  standard uncertainty of the last value
/// @param wander  as in expected_last()
/// @return 0: at once; none: not before `longest`
std::optional<double> time_to_limit(const Trend& trend, double u_last, double limit, double longest, double wander = 0);

}  // namespace abbe
