#pragma once

#include <string>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/thermal/axis_distortion.h"
#include "abbe/verify/thermal/etve.h"
#include "abbe/verify/thermal/location_distortion.h"
#include "abbe/verify/thermal/spindle_distortion.h"

namespace abbe {

// Thermal tests of ISO 230-3. Figures are named after the sensors; docs/evaluate-thermal.md defines them.
// @param file  name of the readings, without its folder
// @param lacks_distance  sensors in two planes would show a tilt if their distance were known

/// Environmental temperature variation error, and the uncertainty of a length if it was asked.
EvaluationReport etve_report(const std::string& file, const EtveEvaluation& evaluation, bool lacks_distance);

/// Thermal distortion by a rotating spindle.
EvaluationReport spindle_distortion_report(const std::string& file, const SpindleDistortion& distortion,
                                           bool lacks_distance);

/// Thermal distortion by a moving linear axis.
EvaluationReport axis_distortion_report(const std::string& file, const AxisDistortion& distortion);

/// Thermal distortion of location errors.
/// @param pause  what told the cycles apart, s: as LocationErrorsOverTime::pause
/// @param left_out  cycles that could not be used, a sentence each
EvaluationReport location_distortion_report(const std::string& file, const LocationDistortion& distortion, double pause,
                                            const std::vector<std::string>& left_out);

/// "P2 from +": a target as the figures call it. @param approach  empty: the readings do not say
std::string axis_target_name(std::size_t number, const std::string& approach);

}  // namespace abbe
