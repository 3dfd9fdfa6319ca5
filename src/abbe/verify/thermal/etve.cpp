#include "abbe/verify/thermal/etve.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace abbe {

double EtveEvaluation::largest_displacement() const {
  double largest = 0;
  for (const EtveSensor& one : sensors) {
    if (!one.sensor.is_angle) largest = std::max(largest, one.etve.value);
  }
  return largest;
}

double EtveEvaluation::mean_temperature() const {
  double sum = 0;
  for (const EtveTemperature& one : temperatures) sum += one.mean;
  return sum / static_cast<double>(temperatures.size());
}

EtveEvaluation evaluate_etve(const ThermalReadings& readings, const ThermalUncertainty& uncertainty,
                             double plane_distance) {
  EtveEvaluation result;
  result.from = std::numeric_limits<double>::infinity();
  result.to = -result.from;
  const auto include = [&](const TimeSeries& series) {
    result.from = std::min(result.from, series.from());
    result.to = std::max(result.to, series.to());
  };
  for (ThermalSensor& sensor : thermal_sensors(readings, uncertainty, plane_distance)) {
    include(sensor.series);
    EtveSensor one;
    one.range = range_between(sensor.series, sensor.series.from(), sensor.series.to());
    one.etve = range_figure(sensor, sensor.series.from(), sensor.series.to());
    one.hourly = hourly_figure(sensor);
    one.sensor = std::move(sensor);
    result.sensors.push_back(std::move(one));
  }
  for (const TimeSeries& series : readings.temperatures) {
    include(series);
    EtveTemperature one{series, range_between(series, series.from(), series.to()), {}, {}, mean_over_time(series)};
    one.variation = range_figure({series, false, uncertainty.temperature}, series.from(), series.to());
    one.rate = hourly_change(series, uncertainty.temperature);
    result.temperatures.push_back(std::move(one));
  }
  return result;
}

}  // namespace abbe
