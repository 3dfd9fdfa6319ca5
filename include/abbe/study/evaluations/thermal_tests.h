#pragma once

#include <optional>
#include <span>

#include "abbe/formats/evaluations/evaluation_thermal_file.h"
#include "abbe/formats/study/study.h"
#include "abbe/study/campaign.h"
#include "abbe/study/evaluations/test_number.h"
#include "abbe/verify/thermal/axis_distortion.h"
#include "abbe/verify/thermal/etve.h"
#include "abbe/verify/thermal/location_distortion.h"
#include "abbe/verify/thermal/spindle_distortion.h"

namespace abbe {

// Thermal tests of ISO 230-3 for evaluate_readings(); lengths in mm, angles in rad, times in s, temperatures in degC.
// Definitions: docs/evaluate-thermal.md.

/// Environmental temperature variation error, and the uncertainty of a measured length by temperature.
///
/// Refused: numbers about the length without the length itself or without any uncertainty or coefficient; no
/// temperature of a body that has a coefficient, neither stated nor read.
struct EtveTest {
  ThermalReadings readings;
  double plane_distance = kNotStated;   ///< from the first plane of sensors to the second, along Z
  double displacement_uncertainty = 0;  ///< standard, of a reading, as the next two; 0: not stated
  double angle_uncertainty = 0;
  double temperature_uncertainty = 0;
  double length = kNotStated;               ///< of what is measured
  double workpiece_expansion = kNotStated;  ///< coefficient, 1/K, as its standard uncertainty
  double workpiece_expansion_uncertainty = kNotStated;
  double workpiece_temperature = kNotStated;  ///< mean; not stated: that of all sensors of a temperature
  double workpiece_temperature_uncertainty = kNotStated;
  double scale_expansion = kNotStated;  ///< of the scale that measures it, as the next three
  double scale_expansion_uncertainty = kNotStated;
  double scale_temperature = kNotStated;
  double scale_temperature_uncertainty = kNotStated;
};
std::span<const TestNumber<EtveTest>> etve_numbers();

/// Thermal distortion by a rotating spindle. Refused: a stop that is not after the start, a sensor that was not read
/// from the start to the stop.
struct SpindleDistortionTest {
  ThermalReadings readings;
  double start = kNotStated;  ///< of the rotation, as the file counts its time; else the first reading
  double stop = kNotStated;   ///< else the last reading: there is no cooling
  double plane_distance = kNotStated;
  double displacement_uncertainty = 0;
  double angle_uncertainty = 0;
};
std::span<const TestNumber<SpindleDistortionTest>> spindle_distortion_numbers();

/// Thermal distortion by a moving linear axis.
struct AxisDistortionTest {
  AxisDistortionReadings readings;
  double displacement_uncertainty = 0;
  double angle_uncertainty = 0;
};
std::span<const TestNumber<AxisDistortionTest>> axis_distortion_numbers();

/// Thermal distortion of location errors: the readings of a study whose poses are measured again and again, by any
/// instrument, while the machine is heated and cools.
///
/// Refused: what location_errors_over_time() refuses, a stop that is not after the start, times outside the cycles. A
/// change that is not one of location errors alone makes Evaluation::refused.
struct LocationDistortionTest {
  Study study;
  Campaign campaign;          ///< gather_readings() of the study; its readings have times
  double cycle = kNotStated;  ///< from one cycle to the next; else a pause begins a cycle
  double pause = kNotStated;  ///< a longer time without a reading begins a cycle; else found from the times
  double start = kNotStated;  ///< of the heating, as the readings count their time; else the first cycle
  double stop = kNotStated;   ///< else the last cycle: there is no cooling
};
std::span<const TestNumber<LocationDistortionTest>> location_distortion_numbers();

}  // namespace abbe
