#pragma once

#include <string>
#include <vector>

#include "abbe/verify/thermal/warming.h"

namespace abbe {

/// Displacements and tilts caused by a rotating spindle.
struct SpindleDistortion {
  WarmingRun run;
  std::vector<WarmingSensor> sensors;
  std::vector<TimeSeries> temperatures;
};

/// Whether each sensor was read from the start to the stop: at or before the start, at or after the stop.
/// @return name of the first that was not; empty: all were
std::string unread_sensor(const ThermalReadings& readings, const WarmingRun& run);

/// Thermal distortion by a rotating spindle (ISO 230-3).
/// Source: ISO 230-3:2020 by its public scope and terms; definitions in docs/evaluate-thermal.md.
/// @param run  as unread_sensor() allows
/// @param plane_distance  as thermal_sensors() takes it
SpindleDistortion evaluate_spindle_distortion(const ThermalReadings& readings, const WarmingRun& run,
                                              const ThermalUncertainty& uncertainty, double plane_distance);

}  // namespace abbe
