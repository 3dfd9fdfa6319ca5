#include "abbe/verify/evaluations/conformity.h"

#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kLeastProbability = 0.95;

/// Probability above z standard deviations; keeps its digits far from the mean.
double upper_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

}  // namespace

double conformance_probability(double value, double standard_uncertainty, double tolerance) {
  const double magnitude = std::abs(value);
  if (!(standard_uncertainty > 0)) return magnitude <= tolerance ? 1 : 0;
  const double beyond = upper_tail((tolerance - magnitude) / standard_uncertainty) +
                        upper_tail((tolerance + magnitude) / standard_uncertainty);
  return std::fmax(0.0, 1 - beyond);
}

Conformity conformity(double value, double standard_uncertainty, double tolerance) {
  const double magnitude = std::abs(value);
  const double guard = kGuardFactor * standard_uncertainty;
  if (magnitude - guard > tolerance) return Conformity::nonconformity_proven;
  if (magnitude + guard > tolerance) return Conformity::not_proven;
  // Beyond the nearer limit lie less than 5 % now; both together may still have more.
  const bool is_probable = conformance_probability(value, standard_uncertainty, tolerance) >= kLeastProbability;
  return is_probable ? Conformity::proven : Conformity::not_proven;
}

}  // namespace abbe
