#include "abbe/verify/thermal/spindle_distortion.h"

#include <utility>

namespace abbe {

std::string unread_sensor(const ThermalReadings& readings, const WarmingRun& run) {
  for (const auto* const all : {&readings.displacements, &readings.angles}) {
    for (const TimeSeries& series : *all) {
      if (series.from() > run.start || series.to() < run.stop) return series.name;
    }
  }
  return "";
}

SpindleDistortion evaluate_spindle_distortion(const ThermalReadings& readings, const WarmingRun& run,
                                              const ThermalUncertainty& uncertainty, double plane_distance) {
  SpindleDistortion result{run, {}, readings.temperatures};
  // Tilts are known at the times at which both sensors were read, which may be fewer.
  for (ThermalSensor& sensor : thermal_sensors(readings, uncertainty, plane_distance)) {
    result.sensors.push_back(warming_of(std::move(sensor), run));
  }
  return result;
}

}  // namespace abbe
