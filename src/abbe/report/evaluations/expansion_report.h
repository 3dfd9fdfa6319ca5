#pragma once

// Internal to report: bodies for whose expansion readings of lengths were corrected.
#include <array>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/differential_expansion.h"

namespace abbe {

/// Adds facts and the details "expansion".
/// @param has  a machine and an instrument with a temperature
void add_expansion(const DifferentialExpansion& expansion, const std::array<bool, 2>& has, const BodyTemperatures& low,
                   const BodyTemperatures& high, EvaluationReport& report);

/// Adds a note where no uncertainty is stated.
void note_exact_expansion(const DifferentialExpansion& expansion, EvaluationReport& report);

}  // namespace abbe
