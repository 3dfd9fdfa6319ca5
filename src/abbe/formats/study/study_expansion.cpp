#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/expansion.h"
#include "abbe/formats/machine/expansion_fields.h"
#include "abbe/formats/study/study_parts.h"
#include "abbe/formats/study/study_quantity.h"

namespace abbe {
namespace {

/// The same number in mm of the error motion.
SetupNumber scaled(const SetupNumber& number, double scale) {
  SetupNumber result = number;
  result.value *= scale;
  result.standard_uncertainty *= std::abs(scale);
  if (result.truth) *result.truth *= scale;
  return result;
}

SetupNumber read_coefficient(TomlTable& table, const Simulation* simulation) {
  const std::optional<double> otherwise = table.has("estimate_coefficient") ? std::optional<double>(0.0) : std::nullopt;
  const SetupNumber number =
      read_setup_number(table, "coefficient", Quantity::expansion, Knowledge::exact, simulation != nullptr, otherwise);
  refuse_large_expansion(table, number.value);
  if (number.truth && !simulation->generator) {
    table.fail_quantity("true_coefficient", Quantity::expansion, "is given beside a file of true errors",
                        "[[expansion]] in that file");
  }
  return number;
}

/// Parameters of one name and basis would have the same names.
void refuse_same_parameters(const TomlTable& table, const Machine& machine, const IdentifiedMotion& term,
                            const IdentificationPlan& plan) {
  for (const IdentifiedMotion& other : plan.motions) {
    if (other.axis != term.axis || other.component != term.component || other.state != term.state) continue;
    if (other.basis.kind != term.basis.kind) continue;
    const std::string name = error_motion_name(machine, term.axis, term.component, term.state);
    if (other.expansion) table.fail("axis", name + " has an expansion already", "one for each scale and state");
    table.fail("axis", fmt::format("{} is identified as \"{}\" too", name, basis_kind_name(term.basis.kind)),
               "basis = \"legendre\" in that [[identify.motion]]");
  }
}

}  // namespace

void read_identified_expansions(TomlTable& identify, const Machine& machine, const Simulation* simulation,
                                IdentificationPlan& plan) {
  for (TomlTable& table : identify.tables("expansion")) {
    ScaleExpansion expansion = read_expansion_place(table, machine);
    const SetupNumber coefficient = read_coefficient(table, simulation);
    table.finish();
    expansion.coefficient = coefficient.value;
    expansion.standard_uncertainty = coefficient.standard_uncertainty;
    if (!expansion.thermometer.empty() && !(expansion.temperature_uncertainty > 0)) {
      table.fail("temperature_standard_uncertainty_K", "is missing or zero beside a thermometer",
                 "the temperature error of this scale besides the one that its thermometer shares");
    }
    if (expansion.temperature_uncertainty > 0 && coefficient.knowledge == Knowledge::open) {
      table.fail_quantity("temperature_standard_uncertainty", Quantity::temperature_difference,
                          "has an effect of unknown size where the coefficient is not known",
                          "coefficient_um_per_m_K with coefficient_standard_uncertainty_um_per_m_K");
    }
    for (const ErrorMotion& term : expansion_terms(machine, expansion)) {
      IdentifiedMotion motion{term.axis, term.component, term.basis, term.basis.order, term.state, false};
      const bool is_temperature = term.state == kNoState;
      motion.expansion = {is_temperature ? SetupNumber::within(0, term.standard_uncertainty[1])
                                         : scaled(coefficient, expansion_scale(machine, term)),
                          is_temperature, is_temperature ? expansion.thermometer : "",
                          is_temperature ? thermometer_effect(machine, expansion) : 0};
      refuse_same_parameters(table, machine, motion, plan);
      plan.motions.push_back(std::move(motion));
    }
  }
}

}  // namespace abbe
