#pragma once

#include <string>
#include <vector>

#include "abbe/formats/study/report_facts.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// A report for people: facts, figures with uncertainties and verdicts on tolerances, notes; complete lines.
std::string evaluation_text(const EvaluationReport& report);

/// Enters tolerances, "A_um=10", into the figures.
/// @throws InputError naming --tolerance for an unknown figure, a unit that is missing or is not one of the figure, a
///   value that is no number above zero, and a figure with two tolerances
void apply_tolerances(const std::vector<std::string>& tolerances, EvaluationReport& report);

/// The same for the tolerances of a customer report. @throws InputError naming their place
void apply_report_tolerances(const std::vector<ReportTolerance>& tolerances, EvaluationReport& report);

}  // namespace abbe
