#include "abbe/verify/evaluations/positioning_uncertainty.h"

#include <cmath>
#include <numbers>

namespace abbe {
namespace {

/// Expanded uncertainty (k = 2) of a rectangular distribution of this full width.
double expanded_of_range(double range) { return range * std::numbers::inv_sqrt3; }

double square(double value) { return value * value; }

}  // namespace

bool PositioningUncertaintyInput::is_empty() const {
  return instrument == 0 && instrument_per_length == 0 && setup == 0 && misalignment_range == 0 &&
         machine_temperature_range == 0 && machine_expansion_range == 0 && device_temperature_range == 0 &&
         device_expansion_range == 0 && environmental_variation == 0;
}

PositioningUncertainty positioning_uncertainty(const PositioningUncertaintyInput& input,
                                               const PositioningEvaluation& evaluation, bool rotary) {
  const double length = evaluation.span();
  PositioningUncertainty result;
  double squares = 0;
  const auto add = [&](const char* name, double expanded) {
    if (expanded == 0) return;
    result.contributions.push_back({name, expanded});
    squares += square(expanded);
  };
  add("instrument", input.instrument + (rotary ? 0 : input.instrument_per_length * length));
  add("set-up", input.setup);
  if (!rotary && length > 0) {
    // The beam is longer than the travel by offset^2 / (2 length): from 0 to that of the largest offset.
    add("misalignment", expanded_of_range(square(input.misalignment_range) / (2 * length)));
    add("temperature of the machine",
        expanded_of_range(input.machine_temperature_range) * input.machine_expansion * length);
    add("temperature of the instrument",
        expanded_of_range(input.device_temperature_range) * input.device_expansion * length);
    const double away = std::abs(input.temperature_from_20_C);
    add("expansion of the machine", expanded_of_range(input.machine_expansion_range) * away * length);
    add("expansion of the instrument", expanded_of_range(input.device_expansion_range) * away * length);
  }
  const double environment = expanded_of_range(input.environmental_variation);
  if (environment > 0) result.contributions.push_back({"environment, of one reading", environment});
  const double runs = evaluation.fewest_runs > 0 ? static_cast<double>(evaluation.fewest_runs) : 1;
  // Two means of n readings differ by sqrt(2 / n) times one reading; two bidirectional means by sqrt(1 / n).
  const double two_means = 2 * square(environment) / runs;
  // Drift widens 2 s at both ends of a span, together 4 s, by at most 4 u = 2 U.
  const double widths = square(2 * environment);
  result.mean_bidirectional = std::sqrt(squares + square(environment) / runs);
  result.systematic = std::sqrt(squares + two_means);
  result.accuracy = std::sqrt(squares + two_means + widths);
  result.reversal = std::sqrt(two_means);
  result.unidirectional_repeatability = 2 * environment;
  result.repeatability = std::sqrt(widths + two_means);
  return result;
}

}  // namespace abbe
