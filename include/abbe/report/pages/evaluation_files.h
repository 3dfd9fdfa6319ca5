#pragma once

#include <string>
#include <utility>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// The files of a results folder of an evaluation, name and contents: evaluation.json, an SVG file for every plot, and
/// report.html.
std::vector<std::pair<std::string, std::string>> evaluation_files(const EvaluationReport& report);

}  // namespace abbe
