#include "abbe/verify/thermal/spindle_distortion.h"

#include <algorithm>
#include <utility>

namespace abbe {

std::string unread_sensor(const ThermalReadings& readings, const SpindleRun& run) {
  for (const auto* const all : {&readings.displacements, &readings.angles}) {
    for (const TimeSeries& series : *all) {
      if (series.from() > run.start || series.to() < run.stop) return series.name;
    }
  }
  return "";
}

SpindleDistortion evaluate_spindle_distortion(const ThermalReadings& readings, const SpindleRun& run,
                                              const ThermalUncertainty& uncertainty, double plane_distance) {
  SpindleDistortion result{run, {}, readings.temperatures};
  for (ThermalSensor& sensor : thermal_sensors(readings, uncertainty, plane_distance)) {
    const TimeSeries& series = sensor.series;
    // Tilts are known at the times at which both sensors were read, which may be fewer.
    const double start = std::clamp(run.start, series.from(), series.to());
    const double stop = std::clamp(run.stop, start, series.to());
    SpindleSensor one;
    one.value_at_start = value_at(series, start);
    one.first_hour = first_hour_figure(sensor, start, stop);
    one.running = range_figure(sensor, start, stop);
    one.change_at_stop = value_at(series, stop) - one.value_at_start;
    one.change_at_end = series.values.back() - one.value_at_start;
    one.warming = first_order_response(series, start, stop, sensor.reading_uncertainty);
    if (run.has_cooling() && series.to() > stop) {
      one.cooling = range_figure(sensor, stop, series.to());
      one.recovery = first_order_response(series, stop, series.to(), sensor.reading_uncertainty);
    }
    one.sensor = std::move(sensor);
    result.sensors.push_back(std::move(one));
  }
  return result;
}

}  // namespace abbe
