#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/verify/thermal/time_series.h"

namespace abbe {

/// One hour, s.
inline constexpr double kHour = 3600;

/// Readings of a thermal test: what each sensor read, under the name of its own.
struct ThermalReadings {
  std::vector<TimeSeries> displacements;  ///< mm
  std::vector<TimeSeries> angles;         ///< rad
  std::vector<TimeSeries> temperatures;   ///< degC
};

/// Standard uncertainties of one reading, independent of the others; 0: not stated.
struct ThermalUncertainty {
  double displacement = 0;  ///< mm
  double angle = 0;         ///< rad
  double temperature = 0;   ///< K
};

/// A displacement or an angle over time.
struct ThermalSensor {
  TimeSeries series;
  bool is_angle = false;
  double reading_uncertainty = 0;  ///< standard, mm or rad; 0: not stated
};

/// All displacements and angles; behind them the tilts by the readings in two planes.
///
/// With sensors X1 and X2 along X, the second in a plane further along Z by `plane_distance`, the tilt about Y is
/// B = (X2 - X1) / distance; with Y1 and Y2 the tilt about X is A = (Y1 - Y2) / distance, both at the times at which
/// both sensors were read. There are none without a distance, without two such times, or if the readings have an angle
/// of that name themselves.
/// @param plane_distance  mm; 0: not known
std::vector<ThermalSensor> thermal_sensors(const ThermalReadings& readings, const ThermalUncertainty& uncertainty,
                                           double plane_distance);

/// Whether sensors in two planes would show a tilt if their distance were known.
bool has_two_planes(const ThermalReadings& readings);

enum class ThermalStatus : std::uint8_t {
  not_run,
  done,
  too_short,  ///< the readings do not last as long as the figure asks
  gap         ///< there is no reading for more than half that time
};

/// A range or change over a time, or why there is none.
struct ThermalFigure {
  ThermalStatus status = ThermalStatus::not_run;
  double value = 0;        ///< with `done`: mm, rad or K
  double uncertainty = 0;  ///< standard: of the difference of two readings; 0: not stated
  bool is_evaluated() const { return status == ThermalStatus::done; }
};

/// Range of a sensor between two times; with `done` always.
ThermalFigure range_figure(const ThermalSensor& sensor, double from, double to);
/// Range within the first hour of a time, if that lasts so long.
ThermalFigure first_hour_figure(const ThermalSensor& sensor, double from, double to);
/// Largest range within any hour of the readings.
ThermalFigure hourly_figure(const ThermalSensor& sensor);
/// Largest change within any hour of the readings, from its beginning to its end, K.
ThermalFigure hourly_change(const TimeSeries& temperature, double reading_uncertainty);

}  // namespace abbe
