#pragma once

namespace abbe {

/// What a measured value proves about a specification (ISO 14253-1).
enum class Conformity {
  not_judged,            ///< there is no tolerance, no value or no uncertainty
  proven,                ///< conformity is proven
  nonconformity_proven,  ///< nonconformity is proven
  not_proven             ///< neither is: the value is too close to the limit for its uncertainty
};

/// Guard band in standard uncertainties: 95 % of a normal distribution lie below its mean plus 1.65 of them, so that a
/// statement is wrong with a probability of at most 5 %. ISO 14253-1:2017 (default conformance probability limit of
/// 95 %); JCGM 106:2012, 8.3.
inline constexpr double kGuardFactor = 1.65;

/// Verdict on a value whose magnitude is limited: with g = 1.65 u, conformity is proven if |value| + g <= tolerance,
/// nonconformity if |value| - g > tolerance. Where the tolerance is so small against u that the true value could lie
/// beyond both limits, conformity also needs a probability of 95 % between them.
///
/// Value, uncertainty and tolerance have the same unit.
/// @param standard_uncertainty  u, not below zero
/// @param tolerance             largest permitted magnitude
Conformity conformity(double value, double standard_uncertainty, double tolerance);

/// Probability that the magnitude of the true value is at most the tolerance: normal distribution about the value.
/// JCGM 106:2012, 7.3 and 7.4. Without uncertainty it is 0 or 1.
double conformance_probability(double value, double standard_uncertainty, double tolerance);

}  // namespace abbe
