#include "abbe/study/evaluations/axis_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/circular_report.h"
#include "abbe/report/evaluations/diagonals_report.h"
#include "abbe/report/evaluations/positioning_report.h"
#include "abbe/report/evaluations/rotation_report.h"
#include "abbe/report/evaluations/straightness_report.h"
#include "abbe/study/evaluations/circular_correction.h"
#include "abbe/study/evaluations/evaluated.h"
#include "abbe/study/evaluations/positioning_correction.h"

namespace abbe {
namespace {

bool has_lengths_or_temperatures(const PositioningUncertaintyInput& input) {
  return input.instrument_per_length > 0 || input.misalignment_range > 0 || input.machine_temperature_range > 0 ||
         input.machine_expansion_range > 0 || input.device_temperature_range > 0 || input.device_expansion_range > 0;
}

/// What is known of the measurement of such an axis.
const PositioningUncertaintyInput& stated_uncertainty(const PositioningTest& test) {
  const bool rotary = test.readings.rotary;
  if (rotary && (!test.linear.is_empty() || has_lengths_or_temperatures(test.rotary))) {
    throw InputError({}, "an uncertainty in um or by length or temperature was given for a rotary axis",
                     "--instrument-arcsec, --setup-arcsec, --environment-arcsec");
  }
  if (!rotary && !test.rotary.is_empty()) {
    throw InputError({}, "an uncertainty in arcsec was given for a linear axis",
                     "--instrument-um, --setup-um, --environment-um");
  }
  return rotary ? test.rotary : test.linear;
}

std::string plane_of(const CircularTest& test, const std::string& file) {
  const std::string& stated = test.readings.plane;
  if (!test.plane.empty() && test.plane != "XY" && test.plane != "YZ" && test.plane != "ZX") {
    throw InputError({.field = "--plane " + test.plane}, "there is no such plane", "XY, YZ or ZX");
  }
  if (!stated.empty() && !test.plane.empty() && stated != test.plane) {
    throw InputError({.file = file, .field = "--plane " + test.plane},
                     "the coordinates of the file are those of " + stated, "--plane only for files of a ball bar");
  }
  return !test.plane.empty() ? test.plane : !stated.empty() ? stated : "XY";
}

}  // namespace

std::span<const PositioningContribution> positioning_contributions() {
  using Known = PositioningUncertaintyInput;
  constexpr auto kLinear = &PositioningTest::linear, kRotary = &PositioningTest::rotary;
  static constexpr auto contributions = std::to_array<PositioningContribution>({
      {"--instrument-um", kLinear, &Known::instrument, 1e-3,
       "Instrument, expanded (k = 2), part that does not grow with the length"},
      {"--instrument-um-per-m", kLinear, &Known::instrument_per_length, 1e-6,
       "Instrument, expanded (k = 2), part that grows with the length"},
      {"--instrument-arcsec", kRotary, &Known::instrument, kArcsec, "Instrument on a rotary axis, expanded (k = 2)"},
      {"--setup-um", kLinear, &Known::setup, 1e-3, "Mounting, expanded (k = 2)"},
      {"--setup-arcsec", kRotary, &Known::setup, kArcsec, "Mounting or coupling on a rotary axis, expanded (k = 2)"},
      {"--misalignment-mm", kLinear, &Known::misalignment_range, 1,
       "Largest sideways offset of the beam over the measured travel"},
      {"--machine-expansion-um-per-m-K", kLinear, &Known::machine_expansion, 1e-6,
       "Expansion coefficient of the machine"},
      {"--machine-temperature-range-K", kLinear, &Known::machine_temperature_range, 1,
       "Full range in which the machine's temperature is known"},
      {"--machine-expansion-range-um-per-m-K", kLinear, &Known::machine_expansion_range, 1e-6,
       "Full range of that coefficient"},
      {"--instrument-expansion-um-per-m-K", kLinear, &Known::device_expansion, 1e-6,
       "Expansion coefficient of the instrument's scale"},
      {"--instrument-temperature-range-K", kLinear, &Known::device_temperature_range, 1,
       "Full range in which its temperature is known"},
      {"--instrument-expansion-range-um-per-m-K", kLinear, &Known::device_expansion_range, 1e-6,
       "Full range of that coefficient"},
      {"--temperature-from-20C-K", kLinear, &Known::temperature_from_20_C, 1,
       "Largest difference of the temperature from 20 \xC2\xB0\x43"},
      {"--environment-um", kLinear, &Known::environmental_variation, 1e-3,
       "E_VE: range of the indication at rest over the duration of a test"},
      {"--environment-arcsec", kRotary, &Known::environmental_variation, kArcsec, "E_VE on a rotary axis"},
  });
  return contributions;
}

Evaluation evaluated(const PositioningTest& test, const std::string& file) {
  require_readings(!test.readings.readings.empty(), file);
  const PositioningUncertaintyInput& input = stated_uncertainty(test);
  const bool rotary = test.readings.rotary;
  const std::optional<CorrectedPositioning> corrected = corrected_positioning(test, file);
  const PositioningEvaluation evaluation =
      evaluate_positioning(corrected ? corrected->readings : test.readings.readings);
  const PositioningUncertaintyInput known = corrected ? without_expansion(input) : input;
  const PositioningUncertainty uncertainty = positioning_uncertainty(known, evaluation, rotary);
  Evaluation result;
  result.found = evaluation;
  result.report = positioning_report(evaluation, rotary, file, known.is_empty() ? nullptr : &uncertainty,
                                     corrected ? &corrected->correction : nullptr);
  return result;
}

Evaluation evaluated(const DiagonalsTest& test, const std::string& file) {
  const auto has_none = [](const DiagonalReadings& diagonal) { return diagonal.readings.empty(); };
  require_readings(!test.readings.empty() && std::none_of(test.readings.begin(), test.readings.end(), has_none), file);
  DiagonalsEvaluation evaluation = evaluate_diagonals(test.readings);
  Evaluation result;
  result.report = diagonals_report(evaluation, file_name(file));
  result.found = std::move(evaluation);
  return result;
}

Evaluation evaluated(const CircularTest& test, const std::string& file) {
  require_readings(test.readings.paths[0].count() + test.readings.paths[1].count() > 0, file);
  if (!(test.nominal_radius > 0)) {
    throw InputError({.field = "--radius-mm"}, fmt::format("{:g} is not valid", test.nominal_radius),
                     "a length in mm above zero");
  }
  CircularRequest request;
  request.file = file;
  request.plane = plane_of(test, file);
  request.circular = {test.nominal_radius, test.centre, test.reading_uncertainty, test.length_uncertainty};
  request.diagnosis = {test.nominal_radius, test.length_calibrated, test.length_uncertainty, test.reversal_margin};
  request.feed_mm_s = test.feed;
  std::optional<CorrectedCircle> corrected = corrected_circle(test);
  if (corrected) {
    corrected->correction.as_read = circular_deviations(test.readings.paths, request.circular);
    double& of_length = request.circular.length_uncertainty;
    request.diagnosis.length_uncertainty = of_length = std::hypot(of_length, corrected->correction.uncertainty);
  }
  const auto& paths = corrected ? corrected->paths : test.readings.paths;
  CircularEvaluation found{circular_deviations(paths, request.circular), circular_diagnosis(paths, request.diagnosis)};
  Evaluation result;
  result.report =
      circular_report(request, paths, found.deviations, found.diagnosis, corrected ? &corrected->correction : nullptr);
  result.found = std::move(found);
  for (const EvaluationFigure& figure : result.report.figures) {
    if (figure.value || !figure.symbol.starts_with("G_")) continue;
    result.refused = figure.name + ": " + figure.missing;
    break;
  }
  return result;
}

Evaluation evaluated(const RotationTest& test, const std::string& file) {
  require_readings(!test.readings.angle.empty(), file);
  RotationResult motions = rotation_error_motions(test.readings, test.options);
  Evaluation result;
  result.report = rotation_report(file_name(file), test.options, test.readings, motions);
  if (motions.status != RotationStatus::done) {
    const auto& figures = result.report.figures;
    result.refused = figures.empty() ? "there is no probe" : figures.front().missing;
  }
  result.found = std::move(motions);
  return result;
}

Evaluation evaluated(const StraightnessTest& test, const std::string& file) {
  const LineReadings& line = test.readings;
  require_readings(!line.positions.empty(), file);
  const double u = test.reading_uncertainty;
  StraightnessEvaluation found{straightness(line.positions, line.deviations, ReferenceLine::least_squares, u),
                               straightness(line.positions, line.deviations, ReferenceLine::minimum_zone, u)};
  Evaluation result;
  result.report =
      straightness_report(file_name(file), line, found.least_squares, found.minimum_zone, test.reference, u > 0);
  result.found = std::move(found);
  return result;
}

Evaluation evaluated(const SquarenessTest& test, const std::string& file) {
  const auto& lines = test.readings;
  require_readings(!lines[0].positions.empty() && !lines[1].positions.empty(), file);
  Squareness found =
      squareness({lines[0].positions, lines[0].deviations}, {lines[1].positions, lines[1].deviations}, test.options);
  Evaluation result;
  result.report = squareness_report(file_name(file), lines, found, test.options);
  result.found = std::move(found);
  return result;
}

}  // namespace abbe
