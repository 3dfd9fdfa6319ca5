#include "abbe/verify/thermal/thermal_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace abbe {
namespace {

/// Times of a file in minutes or hours are rounded, s.
constexpr double kSameTime = 1e-6;

const TimeSeries* series_named(const std::vector<TimeSeries>& all, const char* name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const TimeSeries& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// A tilt and the sensors of which it is the difference, divided by the distance of the planes.
struct TiltSensors {
  const char* name;
  const char* plus;
  const char* minus;
};

constexpr TiltSensors kTilts[] = {{"A", "Y1", "Y2"}, {"B", "X2", "X1"}};

/// Whether an hour of readings from a time on supports a figure.
ThermalStatus status_of_hour(const TimeSeries& series, double from, double to) {
  if (to - from < kHour - kSameTime) return ThermalStatus::too_short;
  return longest_gap(series, from, to) > kHour / 2 + kSameTime ? ThermalStatus::gap : ThermalStatus::done;
}

double uncertainty_of_difference(double reading) { return std::numbers::sqrt2 * reading; }

}  // namespace

bool has_two_planes(const ThermalReadings& readings) {
  return std::any_of(std::begin(kTilts), std::end(kTilts), [&](const TiltSensors& tilt) {
    return series_named(readings.displacements, tilt.plus) && series_named(readings.displacements, tilt.minus) &&
           !series_named(readings.angles, tilt.name);
  });
}

std::vector<ThermalSensor> thermal_sensors(const ThermalReadings& readings, const ThermalUncertainty& uncertainty,
                                           double plane_distance) {
  std::vector<ThermalSensor> sensors;
  for (const TimeSeries& series : readings.displacements) sensors.push_back({series, false, uncertainty.displacement});
  for (const TimeSeries& series : readings.angles) sensors.push_back({series, true, uncertainty.angle});
  if (plane_distance == 0) return sensors;
  for (const TiltSensors& tilt : kTilts) {
    const TimeSeries* const plus = series_named(readings.displacements, tilt.plus);
    const TimeSeries* const minus = series_named(readings.displacements, tilt.minus);
    if (!plus || !minus || series_named(readings.angles, tilt.name)) continue;
    TimeSeries series = difference_of(*plus, *minus, tilt.name);
    if (series.time.size() < 2) continue;
    for (double& value : series.values) value /= plane_distance;
    const double u = uncertainty_of_difference(uncertainty.displacement) / plane_distance;
    sensors.push_back({std::move(series), true, u});
  }
  return sensors;
}

ThermalFigure range_figure(const ThermalSensor& sensor, double from, double to) {
  return {ThermalStatus::done, range_between(sensor.series, from, to).value(),
          uncertainty_of_difference(sensor.reading_uncertainty)};
}

ThermalFigure first_hour_figure(const ThermalSensor& sensor, double from, double to) {
  const double hour = std::min(from + kHour, to);
  const ThermalStatus status = status_of_hour(sensor.series, from, hour);
  if (status != ThermalStatus::done) return {status};
  return range_figure(sensor, from, hour);
}

ThermalFigure hourly_figure(const ThermalSensor& sensor) {
  const TimeSeries& series = sensor.series;
  const ThermalStatus status = status_of_hour(series, series.from(), series.to());
  if (status != ThermalStatus::done) return {status};
  return {status, largest_range_within(series, std::min(kHour, series.duration())),
          uncertainty_of_difference(sensor.reading_uncertainty)};
}

ThermalFigure hourly_change(const TimeSeries& temperature, double reading_uncertainty) {
  const ThermalStatus status = status_of_hour(temperature, temperature.from(), temperature.to());
  if (status != ThermalStatus::done) return {status};
  return {status, largest_change_over(temperature, std::min(kHour, temperature.duration())),
          uncertainty_of_difference(reading_uncertainty)};
}

}  // namespace abbe
