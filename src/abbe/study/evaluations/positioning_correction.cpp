#include "abbe/study/evaluations/positioning_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr double kColdest = -273.15;

/// Where the temperatures of one body come from, if not from a number.
struct TemperatureSource {
  const std::vector<double>* column = nullptr;  ///< of the readings
  const TimeSeries* record = nullptr;
  bool any() const { return column != nullptr || record != nullptr; }
};

TemperatureSource source_of(const std::vector<double>& column, const std::optional<TimeSeries>* record,
                            const char* name, const std::string& file) {
  TemperatureSource source;
  if (!column.empty()) source.column = &column;
  if (record != nullptr && *record) source.record = &**record;
  if (source.column != nullptr && source.record != nullptr) {
    throw InputError({.file = file, .field = fmt::format("{}_degC", name)},
                     "is a column of the readings and of --temperatures", "one of them");
  }
  return source;
}

double temperature_at(const TemperatureSource& source, double stated, const PositioningTest& test, std::size_t reading,
                      const std::string& file) {
  if (source.record == nullptr) return source.column != nullptr ? (*source.column)[reading] : stated;
  const double time = test.readings.time[reading];
  if (time < source.record->from() || time > source.record->to()) {
    throw InputError({.file = file, .field = "time"},
                     fmt::format("reading {} was taken at {:.6g} min, and the temperatures of {} are those from {:.6g} "
                                 "to {:.6g} min",
                                 reading + 1, time / 60, test.temperatures->file, source.record->from() / 60,
                                 source.record->to() / 60),
                     "temperatures over the time of all readings, counted from the same moment");
  }
  return value_at(*source.record, time);
}

/// A standard uncertainty that is stated as the full width of a range or by itself.
double uncertainty_of(double stated, double range, const char* option, const char* range_option) {
  if (std::isnan(stated)) return range / std::sqrt(12.0);
  if (range > 0) throw InputError({.field = option}, fmt::format("is given together with {}", range_option), "one");
  return stated;
}

/// Coefficients and ranges are among the contributions; in the units of the options.
ExpansionNumbers numbers_of(const PositioningTest& test) {
  ExpansionNumbers numbers = test.expansion;
  const PositioningUncertaintyInput& input = test.linear;
  if (input.machine_expansion != 0) numbers.machine_coefficient = 1e6 * input.machine_expansion;
  if (input.device_expansion != 0) numbers.instrument_coefficient = 1e6 * input.device_expansion;
  return numbers;
}

void take_ranges(const PositioningTest& test, StatedExpansion& stated) {
  const PositioningUncertaintyInput& input = test.linear;
  const ExpansionNumbers& numbers = test.expansion;
  const double per_um = 1e-6;
  ExpandingBody &machine = stated.expansion.machine, &instrument = stated.expansion.instrument;
  if (stated.has_machine) {
    machine.coefficient_uncertainty =
        uncertainty_of(per_um * numbers.machine_coefficient_uncertainty, input.machine_expansion_range,
                       "--u-machine-expansion-um-per-m-K", "--machine-expansion-range-um-per-m-K");
    machine.temperature_uncertainty =
        uncertainty_of(numbers.machine_temperature_uncertainty, input.machine_temperature_range,
                       "--u-machine-temperature-K", "--machine-temperature-range-K");
  }
  if (stated.has_instrument) {
    instrument.coefficient_uncertainty =
        uncertainty_of(per_um * numbers.instrument_coefficient_uncertainty, input.device_expansion_range,
                       "--u-instrument-expansion-um-per-m-K", "--instrument-expansion-range-um-per-m-K");
    instrument.temperature_uncertainty =
        uncertainty_of(numbers.instrument_temperature_uncertainty, input.device_temperature_range,
                       "--u-instrument-temperature-K", "--instrument-temperature-range-K");
  }
}

/// A body whose coefficient is stated takes part in the correction.
void require_both(const PositioningTest& test, const StatedExpansion& stated) {
  const auto require = [](bool has_temperature, double coefficient, const char* option, const char* column) {
    if (has_temperature || coefficient == 0) return;
    throw InputError({.field = option}, "is missing, but readings are corrected to 20 degC and this body expands",
                     fmt::format("a temperature in degC, or a column {}", column));
  };
  require(stated.has_machine, test.linear.machine_expansion, "--machine-temperature-degC", "machine_degC");
  require(stated.has_instrument, test.linear.device_expansion, "--instrument-temperature-degC", "instrument_degC");
  if (test.linear.temperature_from_20_C != 0) {
    throw InputError({.field = "--temperature-from-20C-K"}, "is given together with a temperature",
                     "one of them: with temperatures, readings are corrected to 20 degC");
  }
}

/// Of contributions to all readings at once: over the distance of the outer targets.
double over_travel(const ExpansionContribution& contribution) {
  const auto [low, high] = std::minmax_element(contribution.standard.begin(), contribution.standard.end());
  return 2 * (*high - *low);
}

PositioningCorrection correction_of(const PositioningTest& test, const StatedExpansion& stated,
                                    const std::vector<BodyTemperatures>& at,
                                    const std::vector<PositioningReading>& corrected) {
  PositioningCorrection result;
  result.expansion = stated.expansion;
  result.has_machine = stated.has_machine;
  result.has_instrument = stated.has_instrument;
  result.lowest = result.highest = at.front();
  for (std::size_t i = 0; i < at.size(); ++i) {
    result.lowest.machine = std::min(result.lowest.machine, at[i].machine);
    result.lowest.instrument = std::min(result.lowest.instrument, at[i].instrument);
    result.highest.machine = std::max(result.highest.machine, at[i].machine);
    result.highest.instrument = std::max(result.highest.instrument, at[i].instrument);
  }
  result.as_read = evaluate_positioning(test.readings.readings);
  const auto contributions = expansion_contributions(corrected, stated.expansion, at);
  result.expanded = expanded_by_expansion(corrected, contributions);
  for (const ExpansionContribution& one : contributions) {
    result.contributions.push_back({one.name, over_travel(one)});
  }
  return result;
}

}  // namespace

PositioningUncertaintyInput without_expansion(PositioningUncertaintyInput input) {
  input.machine_temperature_range = input.machine_expansion_range = 0;
  input.device_temperature_range = input.device_expansion_range = 0;
  return input;
}

std::optional<CorrectedPositioning> corrected_positioning(const PositioningTest& test, const std::string& file) {
  const PositioningFile& readings = test.readings;
  const TemperatureRecord* const record = test.temperatures ? &*test.temperatures : nullptr;
  const TemperatureSource machine =
      source_of(readings.machine_temperature, record != nullptr ? &record->machine : nullptr, "machine", file);
  const TemperatureSource instrument =
      source_of(readings.instrument_temperature, record != nullptr ? &record->instrument : nullptr, "instrument", file);
  std::optional<StatedExpansion> stated = stated_expansion(numbers_of(test), machine.any(), instrument.any());
  if (!stated) return std::nullopt;
  if (readings.rotary) {
    throw InputError({}, "a temperature was given for a rotary axis", "no temperatures of a rotary axis");
  }
  if (record != nullptr && readings.time.empty()) {
    throw InputError({.file = file, .field = "time_min"}, "missing column",
                     "when each reading was taken, for the temperatures of " + record->file);
  }
  require_both(test, *stated);
  take_ranges(test, *stated);
  std::vector<BodyTemperatures> at;
  for (std::size_t i = 0; i < readings.readings.size(); ++i) {
    at.push_back({temperature_at(machine, stated->at.machine, test, i, file),
                  temperature_at(instrument, stated->at.instrument, test, i, file)});
    if (!(at.back().machine >= kColdest && at.back().instrument >= kColdest)) {
      throw InputError({.file = file, .field = "machine_degC, instrument_degC"},
                       fmt::format("reading {} has a temperature below absolute zero", i + 1), "degC");
    }
  }
  CorrectedPositioning result;
  result.readings = corrected_to_reference_temperature(readings.readings, stated->expansion, at);
  result.correction = correction_of(test, *stated, at, result.readings);
  return result;
}

}  // namespace abbe
