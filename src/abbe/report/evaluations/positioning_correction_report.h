#pragma once

// Internal to report: what a positioning report says of a correction to 20 degC.
#include "abbe/report/evaluations/positioning_report.h"

namespace abbe {

/// Adds facts, a note, tables of what was read and what it was corrected to, and the details "expansion" and "as_read".
void add_correction(const PositioningCorrection& correction, const PositioningEvaluation& corrected,
                    EvaluationReport& report);

}  // namespace abbe
