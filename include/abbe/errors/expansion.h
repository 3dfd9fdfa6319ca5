#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Reference temperature of lengths (ISO 1), degC.
inline constexpr double kReferenceTemperature = 20;

/// Thermal expansion of the scale (or the screw) of a linear axis.
///
/// A scale that is warmer than the reference temperature is too long: at the command q the axis stands at q + alpha
/// (T - T0) (q - q0). T is the value of a state, T0 its reference (20 degC by default, ISO 1:2022), q0 the fixed point.
/// docs/conventions.md derives the sign of the error motion.
struct ScaleExpansion {
  std::size_t axis = 0;                ///< index into Machine::axes
  std::size_t state = kNoState;        ///< temperature of the scale: measured or lag, degC
  double coefficient = 0;              ///< alpha, 1/K
  double standard_uncertainty = 0;     ///< of the coefficient, 1/K; 0: not stated
  double temperature_uncertainty = 0;  ///< of the temperature that the state gives, standard, K; 0: not stated
  /// Expansions of the same thermometer (or reference of several thermometers) share an error of their temperatures;
  /// empty: none do. The standard uncertainty of that error, K, is no part of `temperature_uncertainty`.
  std::string thermometer{};
  double thermometer_uncertainty = 0;
  double fixed_point = 0;  ///< q0, mm: command at which the scale is where it is at the reference
};

/// Why an axis, a state or a number cannot make an expansion, and what could; empty: it can.
struct ExpansionProblem {
  std::string field;  ///< "axis", "state"
  std::string problem, expected;
};
ExpansionProblem expansion_problem(const Machine& machine, std::size_t axis, std::size_t state);

/// Component of the error motion of an expansion, and its sign: +1 or -1 for one that makes the axis move too far.
struct ExpansionDirection {
  Component component = Component::X;
  double sign = 1;
};
/// @param axis  linear and parallel to X, Y or Z
ExpansionDirection expansion_direction(const Axis& axis);

/// Functions 1 and s = (q - fixed point)/R. R is 1000 mm or the next of 2000, 4000, ... mm that covers the travel: a
/// coefficient of s in um is alpha in um/(m K), or 2, 4, ... times that. The first one is no part of an expansion.
Basis expansion_basis(const Axis& axis, double fixed_point);

/// What a coefficient of expansion (1/K) is multiplied with for that of s in the error motion: R with a sign, mm.
double expansion_scale(const Machine& machine, const ErrorMotion& term);

/// Error motions of an expansion: one with the state. If the uncertainty of its temperature is stated, also one without
/// a state, whose value is zero and whose uncertainty is what that of the temperature makes: with both, the variance of
/// alpha (T - T0) is u^2(alpha) (T - T0)^2 + (alpha^2 + u^2(alpha)) u^2(T), exact for independent alpha and T. The part
/// of the thermometer is in u(T).
std::vector<ErrorMotion> expansion_terms(const Machine& machine, const ScaleExpansion& expansion);

/// What one standard uncertainty of the thermometer changes the coefficient of s of the term without a state by, mm,
/// with a sign: scale alpha u. Terms of the same thermometer have the product of both as their covariance, which is
/// exact for independent coefficients.
double thermometer_effect(const Machine& machine, const ScaleExpansion& expansion);

/// Back from an error motion with a state to the expansion that it is; nothing if it is none.
std::optional<ScaleExpansion> expansion_of(const Machine& machine, const ErrorMotion& term);

/// Whether an error motion is the one without a state beside an expansion, for the uncertainty of its temperature.
bool is_expansion_temperature(const Machine& machine, const ErrorSet& errors, std::size_t motion);

}  // namespace abbe
