#pragma once

#include <vector>

#include "abbe/verify/thermal/first_order_response.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

/// When a machine is heated: the times of a test, s, as the readings count them.
struct WarmingRun {
  double start = 0;  ///< the spindle begins to rotate, or the axes to move
  double stop = 0;   ///< it stops, after the start; the last reading if it never does
  double end = 0;    ///< last reading; later than the stop if the machine cools
  bool has_cooling() const { return end > stop; }
};

/// Effect of heating a machine on a displacement, a tilt or a location error. Changes are from the value at the start.
struct WarmingSensor {
  ThermalSensor sensor;
  double value_at_start = 0;    ///< mm or rad, as read
  ThermalFigure first_hour;     ///< range within the first 60 min of heating
  ThermalFigure running;        ///< range over the whole time of heating
  ThermalFigure cooling;        ///< range after the stop; not_run without cooling
  double change_at_stop = 0;    ///< mm or rad
  double change_at_end = 0;     ///< mm or rad
  FirstOrderResponse warming;   ///< while it is heated
  FirstOrderResponse recovery;  ///< after the stop; not_run without cooling
};

/// The figures of one sensor. Times outside its readings are moved to the nearest reading.
WarmingSensor warming_of(ThermalSensor sensor, const WarmingRun& run);

}  // namespace abbe
