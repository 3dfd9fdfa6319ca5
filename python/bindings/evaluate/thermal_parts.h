#pragma once

// What thermal tests have in common in Python.
#include <fmt/format.h>

#include <map>
#include <span>
#include <string>

#include "abbe/study/evaluations/test_number.h"
#include "abbe/verify/thermal/thermal_sensor.h"
#include "bindings/evaluate/readings.h"

namespace abbe::python {

using OptionNumbers = std::map<std::string, double>;

/// What a sensor read, with the unit of its values.
struct SensorSeries {
  TimeSeries series;
  const char* unit;
};

inline SensorSeries series_of(const ThermalSensor& sensor) { return {sensor.series, sensor.is_angle ? "rad" : "mm"}; }

/// The numbers of a test by the names of the options of the command.
template <class Test>
void enter_numbers(const OptionNumbers& given, std::span<const TestNumber<Test>> known, Test& test) {
  for (const auto& [name, value] : given) {
    const TestNumber<Test>& number = entry_named("options", name, known);
    if (!(value >= number.from && value <= number.to)) {
      throw InputError({.field = "options"}, fmt::format("{} is {}", name, value),
                       fmt::format("a number from {:g} to {:g}", number.from, number.to));
    }
    test.*number.value = value * number.unit;
  }
}

}  // namespace abbe::python
