#pragma once

#include <optional>
#include <vector>

#include "abbe/verify/thermal/length_temperature.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

/// Change of a displacement or angle while only the environment changes.
struct EtveSensor {
  ThermalSensor sensor;
  SeriesRange range;     ///< over all its readings
  ThermalFigure etve;    ///< ETVE over the test: the value of `range`
  ThermalFigure hourly;  ///< the largest within an hour
};

/// A temperature during the test.
struct EtveTemperature {
  TimeSeries series;
  SeriesRange range;
  ThermalFigure variation;  ///< range over the test, K
  ThermalFigure rate;       ///< largest change within an hour, K
  double mean = 0;          ///< over time, degC
};

/// Environmental temperature variation error (ISO 230-3).
struct EtveEvaluation {
  std::vector<EtveSensor> sensors;
  std::vector<EtveTemperature> temperatures;
  double from = 0, to = 0;                          ///< s: first and last reading of any sensor
  std::optional<LengthTemperatureInput> length_of;  ///< as it was asked and filled in
  std::optional<LengthUncertainty> length;          ///< of a measured length, if it was asked

  double duration() const { return to - from; }
  /// Largest ETVE of a displacement, mm; 0: there is none.
  double largest_displacement() const;
  /// Mean of all temperatures over the test, degC. @pre there is a temperature
  double mean_temperature() const;
};

/// Source: ISO 230-3:2020 by its public scope and terms; definitions in docs/evaluate-thermal.md.
/// @param readings  one displacement or angle at least, each with one reading at least
/// @param plane_distance  as thermal_sensors() takes it
EtveEvaluation evaluate_etve(const ThermalReadings& readings, const ThermalUncertainty& uncertainty,
                             double plane_distance);

}  // namespace abbe
