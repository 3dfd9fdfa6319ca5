#include "abbe/study/evaluations/expansion_numbers.h"

#include <array>
#include <cmath>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using Numbers = ExpansionNumbers;

constexpr double kColdestBody = -273.15, kWarmestBody = 1e3, kLargestCoefficient = 1e4, kLongest = 1e6;

constexpr TestNumber<Numbers> kMachineCoefficient = {"--machine-expansion-um-per-m-K",
                                                     &Numbers::machine_coefficient,
                                                     1e-6,
                                                     -kLargestCoefficient,
                                                     kLargestCoefficient,
                                                     "Expansion coefficient of the machine's scales"};
constexpr TestNumber<Numbers> kInstrumentCoefficient = {"--instrument-expansion-um-per-m-K",
                                                        &Numbers::instrument_coefficient,
                                                        1e-6,
                                                        -kLargestCoefficient,
                                                        kLargestCoefficient,
                                                        "Expansion coefficient of the ball bar or grid encoder"};

/// Numbers of one body, by which messages name what is missing.
struct BodyNumbers {
  const char *name, *coefficient, *temperature;
  double Numbers::*coefficient_value;
  double Numbers::*temperature_value;
  std::array<std::pair<const char*, double Numbers::*>, 3> others;
};

constexpr BodyNumbers kMachine = {"machine",
                                  "--machine-expansion-um-per-m-K",
                                  "--machine-temperature-degC",
                                  &Numbers::machine_coefficient,
                                  &Numbers::machine_temperature,
                                  {{{"--u-machine-expansion-um-per-m-K", &Numbers::machine_coefficient_uncertainty},
                                    {"--u-machine-temperature-K", &Numbers::machine_temperature_uncertainty},
                                    {"--machine-fixed-mm", &Numbers::machine_fixed}}}};
constexpr BodyNumbers kInstrument = {
    "instrument",
    "--instrument-expansion-um-per-m-K",
    "--instrument-temperature-degC",
    &Numbers::instrument_coefficient,
    &Numbers::instrument_temperature,
    {{{"--u-instrument-expansion-um-per-m-K", &Numbers::instrument_coefficient_uncertainty},
      {"--u-instrument-temperature-K", &Numbers::instrument_temperature_uncertainty},
      {"--instrument-fixed-mm", &Numbers::instrument_fixed}}}};

bool is_given(double value) { return !std::isnan(value); }

double given_or_zero(double value, double unit) { return is_given(value) ? value * unit : 0; }

/// @returns whether the body has a temperature. @throws InputError
bool check_body(const Numbers& numbers, const BodyNumbers& body, bool elsewhere) {
  const bool has_temperature = elsewhere || is_given(numbers.*body.temperature_value);
  if (elsewhere && is_given(numbers.*body.temperature_value)) {
    throw InputError({.field = body.temperature}, "is given together with a column of this temperature",
                     "only one of them");
  }
  for (const auto& [option, value] : body.others) {
    if (has_temperature || !is_given(numbers.*value)) continue;
    throw InputError({.field = option}, std::string("has no effect without the temperature of the ") + body.name,
                     std::string("also ") + body.temperature + ", or a column " + body.name + "_degC");
  }
  if (has_temperature && !is_given(numbers.*body.coefficient_value)) {
    throw InputError({.field = body.coefficient},
                     std::string("is missing, but the ") + body.name + " has a temperature",
                     "its coefficient of expansion");
  }
  return has_temperature;
}

}  // namespace

std::span<const TestNumber<ExpansionNumbers>> positioning_expansion_numbers() {
  static constexpr auto numbers = std::to_array<TestNumber<Numbers>>({
      {"--machine-temperature-degC", &Numbers::machine_temperature, 1, kColdestBody, kWarmestBody,
       "Temperature of the axis' scale or screw: deviations are corrected to 20 degC"},
      {"--u-machine-temperature-K", &Numbers::machine_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty of that temperature"},
      {"--u-machine-expansion-um-per-m-K", &Numbers::machine_coefficient_uncertainty, 1e-6, 0, kLargestCoefficient,
       "Standard uncertainty of the coefficient"},
      {"--machine-fixed-mm", &Numbers::machine_fixed, 1, -kLongest, kLongest,
       "Position of the axis at which its scale is fixed (default 0)"},
      {"--instrument-temperature-degC", &Numbers::instrument_temperature, 1, kColdestBody, kWarmestBody,
       "Temperature of the instrument's scale"},
      {"--u-instrument-temperature-K", &Numbers::instrument_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty of that temperature"},
      {"--u-instrument-expansion-um-per-m-K", &Numbers::instrument_coefficient_uncertainty, 1e-6, 0,
       kLargestCoefficient, "Standard uncertainty of its coefficient"},
      {"--instrument-fixed-mm", &Numbers::instrument_fixed, 1, -kLongest, kLongest,
       "Position of the axis at which the instrument was set to zero (default 0)"},
      {"--u-common-temperature-K", &Numbers::common_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty that both temperatures share, such as that of a calibration"},
  });
  return numbers;
}

std::span<const TestNumber<ExpansionNumbers>> circular_expansion_numbers() {
  static constexpr auto numbers = std::to_array<TestNumber<Numbers>>({
      kMachineCoefficient,
      {"--u-machine-expansion-um-per-m-K", &Numbers::machine_coefficient_uncertainty, 1e-6, 0, kLargestCoefficient,
       "Standard uncertainty of that coefficient"},
      {"--machine-temperature-degC", &Numbers::machine_temperature, 1, kColdestBody, kWarmestBody,
       "Temperature of the scales: radii are corrected to 20 degC"},
      {"--u-machine-temperature-K", &Numbers::machine_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty of that temperature"},
      kInstrumentCoefficient,
      {"--u-instrument-expansion-um-per-m-K", &Numbers::instrument_coefficient_uncertainty, 1e-6, 0,
       kLargestCoefficient, "Standard uncertainty of that coefficient"},
      {"--instrument-temperature-degC", &Numbers::instrument_temperature, 1, kColdestBody, kWarmestBody,
       "Temperature of the ball bar or grid encoder"},
      {"--u-instrument-temperature-K", &Numbers::instrument_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty of that temperature"},
      {"--u-common-temperature-K", &Numbers::common_temperature_uncertainty, 1, 0, kWarmestBody,
       "Standard uncertainty that both temperatures share, such as that of a calibration"},
  });
  return numbers;
}

std::optional<StatedExpansion> stated_expansion(const ExpansionNumbers& numbers, bool machine_elsewhere,
                                                bool instrument_elsewhere) {
  StatedExpansion result;
  result.has_machine = check_body(numbers, kMachine, machine_elsewhere);
  result.has_instrument = check_body(numbers, kInstrument, instrument_elsewhere);
  if (!result.has_machine && !result.has_instrument) {
    if (is_given(numbers.common_temperature_uncertainty)) {
      throw InputError({.field = "--u-common-temperature-K"}, "has no effect without a temperature",
                       "also --machine-temperature-degC, --instrument-temperature-degC or both");
    }
    return std::nullopt;
  }
  const auto body_of = [](double coefficient, double u_coefficient, double u_temperature, double fixed) {
    return ExpandingBody{given_or_zero(coefficient, 1e-6), given_or_zero(u_coefficient, 1e-6),
                         given_or_zero(u_temperature, 1), given_or_zero(fixed, 1)};
  };
  if (result.has_machine) {
    result.expansion.machine = body_of(numbers.machine_coefficient, numbers.machine_coefficient_uncertainty,
                                       numbers.machine_temperature_uncertainty, numbers.machine_fixed);
    if (!machine_elsewhere) result.at.machine = numbers.machine_temperature;
  }
  if (result.has_instrument) {
    result.expansion.instrument = body_of(numbers.instrument_coefficient, numbers.instrument_coefficient_uncertainty,
                                          numbers.instrument_temperature_uncertainty, numbers.instrument_fixed);
    if (!instrument_elsewhere) result.at.instrument = numbers.instrument_temperature;
  }
  result.expansion.common_temperature_uncertainty = given_or_zero(numbers.common_temperature_uncertainty, 1);
  return result;
}

}  // namespace abbe
