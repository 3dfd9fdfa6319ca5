#include "abbe/study/evaluations/evaluation.h"

#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/evaluations/evaluated.h"

namespace abbe {
namespace {

/// The tolerance of the largest contour error as lines in the page's drawing.
void add_contour_limits(EvaluationReport& report) {
  if (!report.page.is_object() || !report.page.contains("contour")) return;
  for (const EvaluationFigure& figure : report.figures) {
    if (figure.symbol != "contour_max" || !figure.tolerance) continue;
    const double limit = 1e3 * *figure.tolerance;
    report.page["contour"]["limits_um"] = {-limit, limit};
  }
}

}  // namespace

void require_readings(bool there_are, const std::string& file) {
  if (!there_are) throw InputError({.file = file}, "there are no readings", "one at least");
}

Evaluation evaluate_readings(const EvaluationRequest& request) {
  Evaluation result = std::visit([&](const auto& test) { return evaluated(test, request.file); }, request.test);
  apply_tolerances(request.tolerances, result.report);
  apply_report_tolerances(request.report_tolerances, result.report);
  add_contour_limits(result.report);
  return result;
}

}  // namespace abbe
