#pragma once

#include <optional>
#include <string>

#include "abbe/identify/linkage/linkage_errors.h"
#include "abbe/identify/linkage/linkage_steps.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// What `abbe evaluate linkage` shows of the five steps.
/// @param stated  some uncertainty of the readings was stated: the figures have theirs
/// @param machine, errors  null: without the errors of a machine
EvaluationReport linkage_report(const std::string& title, const LinkageReadings& readings,
                                const LinkageEvaluation& found, bool stated, const Machine* machine,
                                const LinkageErrors* errors);

}  // namespace abbe
