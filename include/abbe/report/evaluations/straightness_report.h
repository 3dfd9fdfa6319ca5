#pragma once

#include <array>
#include <string>

#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/squareness.h"
#include "abbe/verify/evaluations/straightness.h"

namespace abbe {

/// Straightness error of a line by ISO 230-1, by both reference lines.
/// @param file    name of the readings, without its folder
/// @param least, zone  of these readings: by least squares, by the minimum zone
/// @param shown   the reference line of the plot
/// @param stated  an uncertainty of the readings was stated
EvaluationReport straightness_report(const std::string& file, const LineReadings& line, const Straightness& least,
                                     const Straightness& zone, ReferenceLine shown, bool stated);

/// Squareness error between two lines by ISO 230-1. @param result  of these lines with these options
EvaluationReport squareness_report(const std::string& file, const std::array<LineReadings, 2>& lines,
                                   const Squareness& result, const SquarenessOptions& options);

}  // namespace abbe
