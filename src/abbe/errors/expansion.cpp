#include "abbe/errors/expansion.h"

#include <algorithm>
#include <cmath>

#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr double kShortestScale = 1000;  // mm: there a coefficient in um is one in um/(m K)
constexpr double kParallel = 1e-12;

Eigen::Index main_direction(const Axis& axis) {
  Eigen::Index along = 0;
  axis.direction.cwiseAbs().maxCoeff(&along);
  return along;
}

bool is_parallel(const Axis& axis) { return std::abs(std::abs(axis.direction[main_direction(axis)]) - 1) < kParallel; }

bool is_temperature(const MachineState& state) { return is_input(state.kind) && state.unit == "degC"; }

}  // namespace

ExpansionProblem expansion_problem(const Machine& machine, std::size_t axis, std::size_t state) {
  const Axis& one = machine.axes.at(axis);
  if (one.kind != AxisKind::linear) return {"axis", "the scale of a rotary axis does not expand", "a linear axis"};
  if (!is_parallel(one)) {
    return {"axis", "the axis is parallel to none of X, Y, Z, so that its expansion has several components",
            "error motions with a state for " + one.name};
  }
  if (!is_temperature(machine.states.at(state))) {
    return {"state", machine.states[state].name + " is not a temperature",
            "a measured state with the unit degC, or a lag of one"};
  }
  return {};
}

ExpansionDirection expansion_direction(const Axis& axis) {
  const Eigen::Index along = main_direction(axis);
  return {static_cast<Component>(along), axis.sense() * (axis.direction[along] < 0 ? -1.0 : 1.0)};
}

Basis expansion_basis(const Axis& axis, double fixed_point) {
  const double needed = std::max(std::abs(axis.travel_min - fixed_point), std::abs(axis.travel_max - fixed_point));
  double length = kShortestScale;
  while (length < needed) length *= 2;
  Basis basis;
  basis.kind = BasisKind::monomial;
  basis.order = 1;
  basis.from = fixed_point - length;
  basis.to = fixed_point + length;
  return basis;
}

double expansion_scale(const Machine& machine, const ErrorMotion& term) {
  return expansion_direction(machine.axes.at(term.axis)).sign * 0.5 * (term.basis.to - term.basis.from);
}

std::vector<ErrorMotion> expansion_terms(const Machine& machine, const ScaleExpansion& expansion) {
  const Axis& axis = machine.axes.at(expansion.axis);
  ErrorMotion term;
  term.axis = expansion.axis;
  term.component = expansion_direction(axis).component;
  term.basis = expansion_basis(axis, expansion.fixed_point);
  term.state = expansion.state;
  const double scale = expansion_scale(machine, term);
  term.coefficients = {0, scale * expansion.coefficient};
  if (expansion.standard_uncertainty > 0) {
    term.standard_uncertainty = {0, std::abs(scale) * expansion.standard_uncertainty};
  }
  std::vector<ErrorMotion> terms = {term};
  if (expansion.temperature_uncertainty > 0 || expansion.thermometer_uncertainty > 0) {
    term.state = kNoState;
    term.coefficients = {0, 0};
    const double size = std::hypot(expansion.coefficient, expansion.standard_uncertainty);
    const double kelvin = expansion.thermometer_uncertainty > 0
                              ? std::hypot(expansion.temperature_uncertainty, expansion.thermometer_uncertainty)
                              : expansion.temperature_uncertainty;
    term.standard_uncertainty = {0, std::abs(scale) * size * kelvin};
    terms.push_back(term);
  }
  return terms;
}

double thermometer_effect(const Machine& machine, const ScaleExpansion& expansion) {
  const Axis& axis = machine.axes.at(expansion.axis);
  const Basis basis = expansion_basis(axis, expansion.fixed_point);
  const double scale = expansion_direction(axis).sign * 0.5 * (basis.to - basis.from);
  return scale * expansion.coefficient * expansion.thermometer_uncertainty;
}

std::optional<ScaleExpansion> expansion_of(const Machine& machine, const ErrorMotion& term) {
  if (term.state == kNoState || term.basis.kind != BasisKind::monomial || term.coefficients.size() != 2) return {};
  if (term.coefficients[0] != 0 || !expansion_problem(machine, term.axis, term.state).problem.empty()) return {};
  if (!term.standard_uncertainty.empty() && term.standard_uncertainty[0] != 0) return {};
  const Axis& axis = machine.axes[term.axis];
  if (term.component != expansion_direction(axis).component) return {};
  ScaleExpansion expansion;
  expansion.axis = term.axis;
  expansion.state = term.state;
  expansion.fixed_point = 0.5 * (term.basis.from + term.basis.to);
  const Basis basis = expansion_basis(axis, expansion.fixed_point);
  const double near = 1e-9 * (basis.to - basis.from);
  if (std::abs(basis.from - term.basis.from) > near || std::abs(basis.to - term.basis.to) > near) return {};
  const double scale = expansion_scale(machine, term);
  expansion.coefficient = term.coefficients[1] / scale;
  if (!term.standard_uncertainty.empty()) {
    expansion.standard_uncertainty = term.standard_uncertainty[1] / std::abs(scale);
  }
  return expansion;
}

bool is_expansion_temperature(const Machine& machine, const ErrorSet& errors, std::size_t motion) {
  const ErrorMotion& one = errors.motions.at(motion);
  if (one.state != kNoState || one.basis.kind != BasisKind::monomial) return false;
  return std::any_of(errors.motions.begin(), errors.motions.end(), [&](const ErrorMotion& other) {
    return other.axis == one.axis && other.component == one.component && other.basis == one.basis &&
           expansion_of(machine, other).has_value();
  });
}

}  // namespace abbe
