#pragma once

#include <string>
#include <vector>

#include "abbe/verify/thermal/first_order_response.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

/// When the spindle rotates: the times of a test, s, as the readings count them.
struct SpindleRun {
  double start = 0;  ///< it begins to rotate
  double stop = 0;   ///< it stops, after the start; the last reading if it never does
  double end = 0;    ///< last reading; later than the stop if the spindle cools
  bool has_cooling() const { return end > stop; }
};

/// Displacement or tilt caused by a rotating spindle. Changes are from the value at the start.
struct SpindleSensor {
  ThermalSensor sensor;
  double value_at_start = 0;    ///< mm or rad, as read
  ThermalFigure first_hour;     ///< range within the first 60 min of rotation
  ThermalFigure running;        ///< range over the whole time of rotation
  ThermalFigure cooling;        ///< range after the stop; not_run without cooling
  double change_at_stop = 0;    ///< mm or rad
  double change_at_end = 0;     ///< mm or rad
  FirstOrderResponse warming;   ///< while it rotates
  FirstOrderResponse recovery;  ///< after the stop; not_run without cooling
};

struct SpindleDistortion {
  SpindleRun run;
  std::vector<SpindleSensor> sensors;
  std::vector<TimeSeries> temperatures;
};

/// Whether each sensor was read from the start to the stop: at or before the start, at or after the stop.
/// @return name of the first that was not; empty: all were
std::string unread_sensor(const ThermalReadings& readings, const SpindleRun& run);

/// Thermal distortion by a rotating spindle (ISO 230-3).
/// Source: ISO 230-3:2020 by its public scope and terms; definitions in docs/evaluate-thermal.md.
/// @param run  as unread_sensor() allows
/// @param plane_distance  as thermal_sensors() takes it
SpindleDistortion evaluate_spindle_distortion(const ThermalReadings& readings, const SpindleRun& run,
                                              const ThermalUncertainty& uncertainty, double plane_distance);

}  // namespace abbe
