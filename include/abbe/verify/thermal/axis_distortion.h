#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/verify/thermal/first_order_response.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

/// What was read at one target position of a linear axis, approached from one side, over the time of a test.
struct AxisTargetReadings {
  double target = 0;                      ///< mm
  std::string approach;                   ///< "+", "-"; empty: the readings do not say
  TimeSeries deviation;                   ///< actual minus target, mm
  std::vector<TimeSeries> displacements;  ///< across the axis, mm: those that were read
  std::vector<TimeSeries> angles;         ///< rad
};

struct AxisDistortionReadings {
  std::vector<AxisTargetReadings> targets;  ///< ascending, two at least; for each both approaches or one
  std::vector<TimeSeries> temperatures;     ///< degC
};

/// Change of one quantity at one target.
struct AxisTargetSensor {
  ThermalSensor sensor;
  bool is_deviation = false;  ///< along the axis
  ThermalFigure change;       ///< range over all readings there
  double change_at_end = 0;   ///< last reading less the first, mm or rad
};

struct AxisTarget {
  double target = 0;       ///< mm
  std::size_t number = 0;  ///< from 1, ascending
  std::string approach;    ///< as in the readings
  std::vector<AxisTargetSensor> sensors;
};

/// Change of the distance of the outer targets: what the scale, or the screw, of the axis expands.
struct AxisExpansion {
  std::string approach;
  double length = 0;                 ///< nominal distance of the outer targets, mm
  TimeSeries distance;               ///< deviation at the last target less that at the first, less its first value, mm
  ThermalFigure range;               ///< of that
  double expansion = 0;              ///< slope of the changes at all targets over the targets, at the last time; mm/mm
  double expansion_uncertainty = 0;  ///< standard, from the stated uncertainty of a reading; 0: not stated
  FirstOrderResponse response;       ///< of the distance
};

struct AxisDistortion {
  std::vector<AxisTarget> targets;
  std::vector<AxisExpansion> expansions;  ///< one, or one per approach; none if the times have none in common
  std::vector<TimeSeries> temperatures;
  double from = 0, to = 0;  ///< s: first and last reading at any target
};

/// Thermal distortion by a moving linear axis (ISO 230-3).
///
/// Targets are read at different times; between two readings of a target its deviation changes in proportion to the
/// time. Distances are therefore known from the time at which every target has been read once to the time after which
/// some target is not read again. Source: ISO 230-3:2020 by its public scope and terms; docs/evaluate-thermal.md.
AxisDistortion evaluate_axis_distortion(const AxisDistortionReadings& readings, const ThermalUncertainty& uncertainty);

}  // namespace abbe
