#include "abbe/study/evaluations/thermal_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/thermal_report.h"
#include "abbe/study/evaluations/evaluated.h"

namespace abbe {
namespace {

constexpr double kMostMicro = 1e6, kMostLength = 1e6, kMostKelvin = 1e3, kMostExpansion = 1e4, kMostMinutes = 1e7;
constexpr const char* kPlaneWords = "Distance along Z from the plane of X1 and Y1 to that of X2 and Y2: for tilts";
constexpr const char* kReadingWords = "Standard uncertainty of one reading of a displacement";
constexpr const char* kAngleWords = "Standard uncertainty of one reading of an angle";

bool is_stated(double value) { return !std::isnan(value); }

double stated_or_zero(double value) { return is_stated(value) ? value : 0; }

/// The temperature of a body: stated, or the mean of all that were read.
double body_temperature(double stated, const EtveEvaluation& evaluation, const char* option) {
  if (is_stated(stated)) return stated;
  if (!evaluation.temperatures.empty()) return evaluation.mean_temperature();
  throw InputError({.field = option}, "is not stated, and the readings have no temperature",
                   "a temperature in degC, or a column such as air_degC");
}

/// What was asked about a length; nothing if it was not.
std::optional<LengthTemperatureInput> length_input(const EtveTest& test, const EtveEvaluation& evaluation) {
  const bool has_workpiece = is_stated(test.workpiece_expansion), has_scale = is_stated(test.scale_expansion);
  for (const TestNumber<EtveTest>& number : etve_numbers()) {
    const std::string_view option = number.option;
    const bool of_workpiece = option.find("workpiece") != std::string_view::npos;
    if (!of_workpiece && option.find("scale") == std::string_view::npos) continue;
    if (!is_stated(test.*number.value)) continue;
    if (!is_stated(test.length)) {
      throw InputError({.field = number.option}, "has no effect without a length", "also --length-mm");
    }
    if (of_workpiece ? has_workpiece : has_scale) continue;
    throw InputError({.field = number.option}, "has no effect without the coefficient of expansion",
                     of_workpiece ? "also --workpiece-expansion-um-per-m-K" : "also --scale-expansion-um-per-m-K");
  }
  if (!is_stated(test.length)) return std::nullopt;
  if (!has_workpiece && !has_scale) {
    throw InputError({.field = "--length-mm"}, "has no effect without a coefficient of expansion",
                     "also --workpiece-expansion-um-per-m-K, --scale-expansion-um-per-m-K or both");
  }
  LengthTemperatureInput input;
  input.length = test.length;
  input.environmental_variation = evaluation.largest_displacement();
  if (has_workpiece) {
    input.workpiece_expansion = test.workpiece_expansion;
    input.workpiece_expansion_uncertainty = stated_or_zero(test.workpiece_expansion_uncertainty);
    input.workpiece_temperature =
        body_temperature(test.workpiece_temperature, evaluation, "--workpiece-temperature-degC");
    input.workpiece_temperature_uncertainty = stated_or_zero(test.workpiece_temperature_uncertainty);
  }
  if (has_scale) {
    input.scale_expansion = test.scale_expansion;
    input.scale_expansion_uncertainty = stated_or_zero(test.scale_expansion_uncertainty);
    input.scale_temperature = body_temperature(test.scale_temperature, evaluation, "--scale-temperature-degC");
    input.scale_temperature_uncertainty = stated_or_zero(test.scale_temperature_uncertainty);
  }
  return input;
}

void require_thermal_readings(const ThermalReadings& readings, const std::string& file) {
  const auto is_empty = [](const TimeSeries& series) { return series.time.empty(); };
  const bool any_empty = std::any_of(readings.displacements.begin(), readings.displacements.end(), is_empty) ||
                         std::any_of(readings.angles.begin(), readings.angles.end(), is_empty) ||
                         std::any_of(readings.temperatures.begin(), readings.temperatures.end(), is_empty);
  require_readings(!any_empty && !(readings.displacements.empty() && readings.angles.empty()), file);
}

bool lacks_distance(double plane_distance, const ThermalReadings& readings) {
  return !is_stated(plane_distance) && has_two_planes(readings);
}

/// The times of rotation, as stated or as read.
WarmingRun run_of(const SpindleDistortionTest& test, const std::string& file) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const auto* const all : {&test.readings.displacements, &test.readings.angles}) {
    for (const TimeSeries& series : *all) {
      first = std::min(first, series.from());
      last = std::max(last, series.to());
    }
  }
  const WarmingRun run{is_stated(test.start) ? test.start : first, is_stated(test.stop) ? test.stop : last, last};
  if (!(run.stop > run.start)) {
    throw InputError(
        {.file = file, .field = is_stated(test.stop) ? "--stop-min" : "--start-min"},
        fmt::format("the spindle stops at {:.6g} min and starts at {:.6g} min", run.stop / 60, run.start / 60),
        "a stop after the start, on the time scale of the file");
  }
  const std::string unread = unread_sensor(test.readings, run);
  if (unread.empty()) return run;
  throw InputError(
      {.file = file, .field = unread},
      fmt::format("was not read from {:.6g} to {:.6g} min, while the spindle rotates", run.start / 60, run.stop / 60),
      "readings from the start to the stop; --start-min and --stop-min say when that is");
}

}  // namespace

std::span<const TestNumber<EtveTest>> etve_numbers() {
  using Test = EtveTest;
  static constexpr auto numbers = std::to_array<TestNumber<Test>>({
      {"--plane-distance-mm", &Test::plane_distance, 1, 0.001, kMostLength, kPlaneWords},
      {"--u-reading-um", &Test::displacement_uncertainty, 1e-3, 0, kMostMicro, kReadingWords},
      {"--u-reading-urad", &Test::angle_uncertainty, 1e-6, 0, kMostMicro, kAngleWords},
      {"--u-reading-K", &Test::temperature_uncertainty, 1, 0, kMostKelvin,
       "Standard uncertainty of one reading of a temperature"},
      {"--length-mm", &Test::length, 1, 0.001, kMostLength,
       "Length whose uncertainty by temperature is evaluated, with the options below"},
      {"--workpiece-expansion-um-per-m-K", &Test::workpiece_expansion, 1e-6, -kMostExpansion, kMostExpansion,
       "Expansion coefficient of the workpiece"},
      {"--u-workpiece-expansion-um-per-m-K", &Test::workpiece_expansion_uncertainty, 1e-6, 0, kMostExpansion,
       "Standard uncertainty of that coefficient"},
      {"--workpiece-temperature-degC", &Test::workpiece_temperature, 1, -273.15, 1e4,
       "Mean temperature of the workpiece; default: mean of all temperatures of the file"},
      {"--u-workpiece-temperature-K", &Test::workpiece_temperature_uncertainty, 1, 0, kMostKelvin,
       "Standard uncertainty of that temperature"},
      {"--scale-expansion-um-per-m-K", &Test::scale_expansion, 1e-6, -kMostExpansion, kMostExpansion,
       "Expansion coefficient of the scale that measures the length"},
      {"--u-scale-expansion-um-per-m-K", &Test::scale_expansion_uncertainty, 1e-6, 0, kMostExpansion,
       "Standard uncertainty of that coefficient"},
      {"--scale-temperature-degC", &Test::scale_temperature, 1, -273.15, 1e4,
       "Mean temperature of the scale; default: mean of all temperatures of the file"},
      {"--u-scale-temperature-K", &Test::scale_temperature_uncertainty, 1, 0, kMostKelvin,
       "Standard uncertainty of that temperature"},
  });
  return numbers;
}

std::span<const TestNumber<SpindleDistortionTest>> spindle_distortion_numbers() {
  using Test = SpindleDistortionTest;
  static constexpr auto numbers = std::to_array<TestNumber<Test>>({
      {"--start-min", &Test::start, 60, -kMostMinutes, kMostMinutes,
       "The spindle begins to rotate, by the time of the file; default: first reading"},
      {"--stop-min", &Test::stop, 60, -kMostMinutes, kMostMinutes,
       "The spindle stops, and cools from then on; default: last reading"},
      {"--plane-distance-mm", &Test::plane_distance, 1, 0.001, kMostLength, kPlaneWords},
      {"--u-reading-um", &Test::displacement_uncertainty, 1e-3, 0, kMostMicro, kReadingWords},
      {"--u-reading-urad", &Test::angle_uncertainty, 1e-6, 0, kMostMicro, kAngleWords},
  });
  return numbers;
}

std::span<const TestNumber<AxisDistortionTest>> axis_distortion_numbers() {
  using Test = AxisDistortionTest;
  static constexpr auto numbers = std::to_array<TestNumber<Test>>({
      {"--u-reading-um", &Test::displacement_uncertainty, 1e-3, 0, kMostMicro, kReadingWords},
      {"--u-reading-urad", &Test::angle_uncertainty, 1e-6, 0, kMostMicro, kAngleWords},
  });
  return numbers;
}

Evaluation evaluated(const EtveTest& test, const std::string& file) {
  require_thermal_readings(test.readings, file);
  EtveEvaluation evaluation = evaluate_etve(
      test.readings, {test.displacement_uncertainty, test.angle_uncertainty, test.temperature_uncertainty},
      stated_or_zero(test.plane_distance));
  evaluation.length_of = length_input(test, evaluation);
  if (evaluation.length_of) evaluation.length = length_uncertainty(*evaluation.length_of);
  Evaluation result;
  result.report = etve_report(file_name(file), evaluation, lacks_distance(test.plane_distance, test.readings));
  result.found = std::move(evaluation);
  return result;
}

Evaluation evaluated(const SpindleDistortionTest& test, const std::string& file) {
  require_thermal_readings(test.readings, file);
  SpindleDistortion distortion = evaluate_spindle_distortion(test.readings, run_of(test, file),
                                                             {test.displacement_uncertainty, test.angle_uncertainty, 0},
                                                             stated_or_zero(test.plane_distance));
  Evaluation result;
  result.report =
      spindle_distortion_report(file_name(file), distortion, lacks_distance(test.plane_distance, test.readings));
  result.found = std::move(distortion);
  return result;
}

Evaluation evaluated(const AxisDistortionTest& test, const std::string& file) {
  const auto has_none = [](const AxisTargetReadings& target) { return target.deviation.time.empty(); };
  const auto& targets = test.readings.targets;
  require_readings(!targets.empty() && std::none_of(targets.begin(), targets.end(), has_none), file);
  AxisDistortion distortion =
      evaluate_axis_distortion(test.readings, {test.displacement_uncertainty, test.angle_uncertainty, 0});
  Evaluation result;
  result.report = axis_distortion_report(file_name(file), distortion);
  result.found = std::move(distortion);
  return result;
}

}  // namespace abbe
