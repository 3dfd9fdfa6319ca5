// Readings for `abbe evaluate`: any bytes give readings or an InputError, for every kind; what was read is finite and
// can be evaluated.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/evaluations/evaluation_rotation_file.h"
#include "abbe/formats/evaluations/evaluation_thermal_file.h"
#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/machine/linkage_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/verify/evaluations/circular_diagnosis.h"
#include "abbe/verify/evaluations/squareness.h"
#include "abbe/verify/thermal/etve.h"
#include "abbe/verify/thermal/spindle_distortion.h"

namespace {

void require_finite(const std::vector<abbe::PositioningReading>& readings) {
  for (const abbe::PositioningReading& reading : readings) {
    if (!std::isfinite(reading.target) || !std::isfinite(reading.deviation)) std::abort();
  }
}

void positioning(std::string_view text) {
  const abbe::PositioningFile file = abbe::parse_positioning(text, "fuzz.csv");
  require_finite(file.readings);
  const abbe::PositioningEvaluation result = abbe::evaluate_positioning(file.readings);
  if (result.accuracy.figure.is_evaluated() && !(result.accuracy.figure.value >= result.systematic.figure.value)) {
    std::abort();
  }
}

void diagonals(std::string_view text) {
  const auto all = abbe::parse_diagonals(text, "fuzz.csv");
  for (const abbe::DiagonalReadings& diagonal : all) require_finite(diagonal.readings);
  if (abbe::evaluate_diagonals(all).diagonals.size() != all.size()) std::abort();
}

void circular(std::string_view text) {
  constexpr double kRadius = 150;
  const abbe::CircularFile file = abbe::parse_circular(text, "fuzz.csv", kRadius);
  abbe::CircularOptions options;
  options.nominal_radius = kRadius;
  // The minimum zone of many readings would make the fuzzer slow.
  if (file.paths[0].count() + file.paths[1].count() < 12) options.centre = abbe::CircularCentre::minimum_zone;
  const abbe::CircularResult result = abbe::circular_deviations(file.paths, options);
  for (const abbe::CircularDeviation& path : result.paths) {
    if (!std::isfinite(path.circular) || path.circular < 0 || !std::isfinite(path.circular_uncertainty)) std::abort();
  }
  const abbe::CircularDiagnosis diagnosis = abbe::circular_diagnosis(file.paths, {.nominal_radius = kRadius});
  for (const abbe::CircularCauseValue& cause : diagnosis.causes) {
    if (!std::isfinite(cause.value) || !std::isfinite(cause.uncertainty)) std::abort();
  }
}

void rotation(std::string_view text) {
  const abbe::RotationReadings readings = abbe::parse_rotation(text, "fuzz.csv");
  const abbe::RotationResult result = abbe::rotation_error_motions(readings, {.plane_distance = 80});
  for (const abbe::AxisErrorMotion& motion : result.motions) {
    if (!std::isfinite(motion.total_value) || !std::isfinite(motion.asynchronous_value)) std::abort();
  }
}

void straightness(std::string_view text) {
  const abbe::LineReadings line = abbe::parse_straightness(text, "fuzz.csv");
  const auto value = [&](abbe::ReferenceLine reference) {
    const abbe::Straightness result = abbe::straightness(line.positions, line.deviations, reference, 1e-4);
    if (!std::isfinite(result.value) || !std::isfinite(result.slope_uncertainty)) std::abort();
    return result.value;
  };
  const double least = value(abbe::ReferenceLine::least_squares);
  double largest = 0;
  for (const double deviation : line.deviations) largest = std::max(largest, std::abs(deviation));
  // Rounding of the readings themselves.
  if (value(abbe::ReferenceLine::minimum_zone) > least + 1e-9 * largest) std::abort();
}

void squareness(std::string_view text) {
  const auto lines = abbe::parse_squareness(text, "fuzz.csv");
  const abbe::Squareness result =
      abbe::squareness({lines[0].positions, lines[0].deviations}, {lines[1].positions, lines[1].deviations});
  if (!std::isfinite(result.value) || !std::isfinite(result.uncertainty)) std::abort();
}

void linkage(std::string_view text) {
  const abbe::LinkageReadings readings = abbe::parse_linkage(text, "fuzz.csv");
  // What is written is read back as it was.
  const abbe::LinkageReadings back = abbe::parse_linkage(abbe::linkage_text(readings), "again.csv");
  if (back.focus_width != readings.focus_width || back.circle_marks != readings.circle_marks) std::abort();
  const abbe::LinkageEvaluation result = abbe::evaluate_linkage(readings, {});
  if (result.status != abbe::LinkageStatus::ok) return;
  for (const double value : result.linkage.values()) {
    if (!std::isfinite(value)) std::abort();
  }
}

/// A table that another program wrote keeps its lines.
void readable(std::string_view text) {
  const std::vector<abbe::CsvColumn> wanted = {{"position", abbe::Quantity::length},
                                               {"deviation", abbe::Quantity::length},
                                               {"angle", abbe::Quantity::angle, false, false},
                                               {"line", abbe::Quantity::dimensionless, true, false}};
  const std::optional<std::string> plain = abbe::plain_table(text, "fuzz.csv", wanted, {});
  if (!plain) return;
  const std::size_t open = text.empty() || text.ends_with('\n') ? 0 : 1;
  if (std::count(plain->begin(), plain->end(), '\n') !=
      std::count(text.begin(), text.end(), '\n') + static_cast<std::ptrdiff_t>(open)) {
    std::abort();
  }
}

void require_response(const abbe::FirstOrderResponse& response) {
  if (response.status != abbe::ResponseStatus::done) return;
  if (!(response.time_constant > 0) || !std::isfinite(response.uncertainty) || !std::isfinite(response.change)) {
    std::abort();
  }
}

void thermal(std::string_view text) {
  const abbe::ThermalReadings readings = abbe::parse_thermal(text, "fuzz.csv");
  const abbe::EtveEvaluation etve = abbe::evaluate_etve(readings, {}, 100);
  for (const abbe::EtveSensor& one : etve.sensors) {
    if (!std::isfinite(one.etve.value) || one.hourly.value > one.etve.value * (1 + 1e-9)) std::abort();
  }
  const abbe::WarmingRun run{etve.from, etve.to, etve.to};
  if (!abbe::unread_sensor(readings, run).empty()) return;
  for (const auto& one : abbe::evaluate_spindle_distortion(readings, run, {}, 100).sensors) {
    require_response(one.warming);
  }
}

void axis_distortion(std::string_view text) {
  const abbe::AxisDistortionReadings readings = abbe::parse_axis_distortion(text, "fuzz.csv");
  for (const abbe::AxisExpansion& one : abbe::evaluate_axis_distortion(readings, {}).expansions) {
    if (!std::isfinite(one.range.value) || !std::isfinite(one.expansion)) std::abort();
    require_response(one.response);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // One line for every kind of evaluation.
  for (const auto read : {positioning, diagonals, circular, rotation, straightness, squareness, linkage, readable,
                          thermal, axis_distortion}) {
    try {
      read(text);
    } catch (const abbe::InputError&) {
    }
  }
  return 0;
}
