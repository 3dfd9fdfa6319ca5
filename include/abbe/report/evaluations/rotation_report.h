#pragma once

#include <string>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/rotation_error_motion.h"

namespace abbe {

/// Figures, plots and notes of the error motions of an axis of rotation by ISO 230-7.
/// @param file    name of the readings, without its folder
/// @param result  of these readings with these options
EvaluationReport rotation_report(const std::string& file, const RotationOptions& options,
                                 const RotationReadings& readings, const RotationResult& result);

/// First part of the symbols of the figures of an error motion: "radial_x1".
const char* error_motion_symbol(AxisErrorMotionKind kind);

}  // namespace abbe
