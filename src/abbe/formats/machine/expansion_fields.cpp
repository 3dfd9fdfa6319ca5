#include "abbe/formats/machine/expansion_fields.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/machine/state.h"

namespace abbe {

ScaleExpansion read_expansion_place(TomlTable& table, const Machine& machine) {
  ScaleExpansion expansion;
  const std::string axis = table.text("axis");
  expansion.axis = machine.find_axis(axis);
  if (expansion.axis == Machine::npos) {
    table.fail("axis", fmt::format("\"{}\" is not an axis of this machine", axis), axis_names(machine));
  }
  const std::string state = table.text("state");
  expansion.state = find_state(machine, state);
  if (expansion.state == kNoState) {
    table.fail("state", fmt::format("\"{}\" is not a state of this machine", state),
               "a measured state with the unit degC in the machine file");
  }
  const ExpansionProblem problem = expansion_problem(machine, expansion.axis, expansion.state);
  if (!problem.problem.empty()) table.fail(problem.field, problem.problem, problem.expected);
  expansion.fixed_point = table.number_or("fixed_point", Quantity::length, 0);
  expansion.temperature_uncertainty =
      table.size_or("temperature_standard_uncertainty", Quantity::temperature_difference, 0);
  expansion.thermometer = table.text_or("thermometer", "");
  expansion.thermometer_uncertainty =
      table.size_or("thermometer_standard_uncertainty", Quantity::temperature_difference, 0);
  if (expansion.thermometer.empty() && expansion.thermometer_uncertainty > 0) {
    table.fail("thermometer", "is missing beside its uncertainty",
               "a name that the expansions of all scales with this thermometer or reference have");
  }
  if (!expansion.thermometer.empty() && !(expansion.thermometer_uncertainty > 0)) {
    table.fail("thermometer_standard_uncertainty_K", "is missing or zero beside the thermometer",
               "the standard uncertainty that all temperatures of this thermometer share");
  }
  return expansion;
}

void refuse_large_expansion(const TomlTable& table, double coefficient) {
  if (std::abs(coefficient) <= kLargestExpansion) return;
  table.fail_quantity("coefficient", Quantity::expansion, "is too large", "at most 1000 um/(m K); steel has 11");
}

ScaleExpansion read_expansion(TomlTable& table, const Machine& machine) {
  ScaleExpansion expansion = read_expansion_place(table, machine);
  expansion.coefficient = table.number("coefficient", Quantity::expansion);
  refuse_large_expansion(table, expansion.coefficient);
  expansion.standard_uncertainty = table.size_or("coefficient_standard_uncertainty", Quantity::expansion, 0);
  table.finish();
  return expansion;
}

Eigen::MatrixXd covariance_with_thermometers(const Machine& machine, const ErrorSet& errors,
                                             const std::vector<ScaleExpansion>& expansions, std::size_t first) {
  Eigen::MatrixXd covariance;
  struct Shared {
    const ScaleExpansion* expansion;
    Eigen::Index parameter;
  };
  std::vector<Shared> before;
  for (const ScaleExpansion& expansion : expansions) {
    const std::vector<ErrorMotion> terms = expansion_terms(machine, expansion);
    for (const ErrorMotion& term : terms) first += term.coefficients.size();
    if (expansion.thermometer.empty()) continue;
    const Shared one{&expansion, static_cast<Eigen::Index>(first) - 1};
    for (const Shared& other : before) {
      if (other.expansion->thermometer != expansion.thermometer) continue;
      if (covariance.size() == 0) covariance = stated_variances(errors);
      const double product = thermometer_effect(machine, expansion) * thermometer_effect(machine, *other.expansion);
      covariance(one.parameter, other.parameter) = covariance(other.parameter, one.parameter) = product;
    }
    before.push_back(one);
  }
  return covariance;
}

std::string expansion_comment(const Machine& machine, const ErrorMotion& term) {
  const std::optional<ScaleExpansion> expansion = expansion_of(machine, term);
  if (!expansion) return {};
  return fmt::format("  # scale of {}: {:.6g} um/(m K), fixed at {:.6g} mm", machine.axes[term.axis].name,
                     1e6 * expansion->coefficient, expansion->fixed_point);
}

}  // namespace abbe
