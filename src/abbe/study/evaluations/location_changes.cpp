#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/identify/distributions.h"
#include "abbe/study/evaluations/location_cycles.h"

namespace abbe {
namespace {

/// Probability that noise alone makes the values of the cycles differ as much.
double probability_of_no_change(const LocationSeries& series, double factor) {
  double weights = 0, sum = 0;
  for (std::size_t c = 0; c < series.values.size(); ++c) {
    const double weight = 1 / (series.uncertainty[c] * series.uncertainty[c]);
    weights += weight;
    sum += weight * series.values[c];
  }
  double chi_square = 0;
  for (std::size_t c = 0; c < series.values.size(); ++c) {
    const double deviation = (series.values[c] - sum / weights) / (factor * series.uncertainty[c]);
    chi_square += deviation * deviation;
  }
  return chi_square_exceedance(chi_square, static_cast<double>(series.values.size() - 1));
}

}  // namespace

LocationDistortion evaluate_location_distortion(const LocationErrorsOverTime& found, const WarmingRun& run) {
  LocationDistortion result{.run = run, .cycles = found.cycles, .temperatures = found.temperatures};
  std::vector<double> times;
  double freedom = -static_cast<double>(found.common_parameters);
  for (const LocationCycle& cycle : found.cycles) {
    times.push_back(cycle.time);
    result.chi_square += cycle.chi_square;
    freedom += cycle.degrees_of_freedom;
  }
  if (freedom > 0) {
    result.degrees_of_freedom = freedom;
    result.misfit_probability = chi_square_exceedance(result.chi_square, freedom);
    result.uncertainty_factor = std::max(1.0, std::sqrt(result.chi_square / freedom));
  }
  for (const LocationSeries& series : found.locations) {
    const double largest = *std::max_element(series.uncertainty.begin(), series.uncertainty.end());
    ThermalSensor sensor{{series.name, times, series.values}, series.is_angle, result.uncertainty_factor * largest};
    result.locations.push_back(warming_of(std::move(sensor), run));
    result.no_change.push_back(probability_of_no_change(series, result.uncertainty_factor));
  }
  return result;
}

}  // namespace abbe
