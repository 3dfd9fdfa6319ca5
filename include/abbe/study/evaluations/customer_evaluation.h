#pragma once

#include "abbe/report/customer/customer_report.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {

/// Customer report on an evaluation of any kind, as `abbe evaluate --customer-report` writes it.
/// @param before  the same test before a correction; null: there is none
/// @param files   names of the readings
/// @throws InputError for two evaluations that do not belong together
CustomerReport customer_evaluation(const ReportFacts& facts, const Evaluation& now, const Evaluation* before,
                                   const std::vector<std::string>& files);

}  // namespace abbe
