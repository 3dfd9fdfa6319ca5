#pragma once

#include "abbe/report/customer/customer_report.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/diagonals.h"
#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// An evaluation with its report, for one state of the machine.
struct CustomerPositioning {
  const EvaluationReport& report;  ///< with tolerances
  const PositioningEvaluation& evaluation;
};

/// Customer report on an axis by ISO 230-2: figures, a drawing and the deviations at the target positions of each
/// state.
/// @param before  null: one state only; else of the same kind of axis
CustomerReport customer_positioning(const ReportFacts& facts, bool rotary, const CustomerPositioning& now,
                                    const CustomerPositioning* before);

/// The same for diagonals by ISO 230-6. @param before  null, or those before a correction
CustomerReport customer_diagonals(const ReportFacts& facts, const EvaluationReport& report,
                                  const DiagonalsEvaluation& evaluation, const EvaluationReport* before);

}  // namespace abbe
