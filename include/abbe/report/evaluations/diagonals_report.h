#pragma once

#include <string>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/diagonals.h"

namespace abbe {

/// Figures, tables and plot of diagonal displacement tests by ISO 230-6.
/// @param file  name of the readings, without its folder
EvaluationReport diagonals_report(const DiagonalsEvaluation& evaluation, const std::string& file);

}  // namespace abbe
