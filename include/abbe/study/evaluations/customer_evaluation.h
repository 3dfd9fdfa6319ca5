#pragma once

#include "abbe/report/customer/customer_report.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {

/// Customer report on a test of positioning, of an axis or along diagonals, as `abbe evaluate --customer-report` writes
/// it.
/// @param now     of positioning or diagonals
/// @param before  of the same kind, before a correction; null: there is none
/// @param files   names of the readings
/// @throws InputError for an evaluation of another kind, and for two that do not belong together
CustomerReport customer_evaluation(const ReportFacts& facts, const Evaluation& now, const Evaluation* before,
                                   const std::vector<std::string>& files);

}  // namespace abbe
