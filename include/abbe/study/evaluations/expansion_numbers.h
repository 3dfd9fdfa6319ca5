#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/formats/evaluations/temperature_record.h"
#include "abbe/study/evaluations/test_number.h"
#include "abbe/verify/evaluations/differential_expansion.h"

namespace abbe {

/// What a user states of the temperatures at a test of lengths, each in the unit of its option; not a number: not
/// stated. Uncertainties are standard ones.
struct ExpansionNumbers {
  double machine_coefficient = kNotStated;  ///< --machine-expansion-um-per-m-K
  double machine_coefficient_uncertainty = kNotStated;
  double machine_temperature = kNotStated;  ///< --machine-temperature-degC
  double machine_temperature_uncertainty = kNotStated;
  double machine_fixed = kNotStated;           ///< --machine-fixed-mm
  double instrument_coefficient = kNotStated;  ///< --instrument-expansion-um-per-m-K, as the next four
  double instrument_coefficient_uncertainty = kNotStated;
  double instrument_temperature = kNotStated;
  double instrument_temperature_uncertainty = kNotStated;
  double instrument_fixed = kNotStated;
  double common_temperature_uncertainty = kNotStated;  ///< --u-common-temperature-K
};

/// Those of a positioning test; its coefficients are among positioning_contributions().
std::span<const TestNumber<ExpansionNumbers>> positioning_expansion_numbers();
/// Those of a circular test, which has no fixed points.
std::span<const TestNumber<ExpansionNumbers>> circular_expansion_numbers();

/// The expansion that numbers state, and its temperatures.
/// @throws InputError for numbers that have no effect without others
struct StatedExpansion {
  DifferentialExpansion expansion;
  BodyTemperatures at;  ///< as stated by numbers; 20 degC of a body without a temperature
  bool has_machine = false, has_instrument = false;
};

/// @param machine_elsewhere, instrument_elsewhere  whether the temperature of the body comes from somewhere else
/// @returns nothing if no temperature is stated
/// @throws InputError for numbers that have no effect without others, naming the option
std::optional<StatedExpansion> stated_expansion(const ExpansionNumbers& numbers, bool machine_elsewhere = false,
                                                bool instrument_elsewhere = false);

}  // namespace abbe
