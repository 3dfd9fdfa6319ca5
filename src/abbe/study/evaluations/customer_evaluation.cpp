#include "abbe/study/evaluations/customer_evaluation.h"

#include "abbe/formats/text/input_error.h"
#include "abbe/report/customer/customer_positioning.h"

namespace abbe {
namespace {

bool is_rotary(const EvaluationReport& report) { return report.figures.front().quantity == Quantity::angle; }

}  // namespace

CustomerReport customer_evaluation(const ReportFacts& facts, const Evaluation& now, const Evaluation* before,
                                   const std::vector<std::string>& files) {
  if (before != nullptr &&
      (before->found.index() != now.found.index() || is_rotary(before->report) != is_rotary(now.report))) {
    throw InputError({.field = "--before"}, "the readings are of another kind of axis", "readings of the same axis");
  }
  CustomerReport report;
  if (const auto* positioning = std::get_if<PositioningEvaluation>(&now.found)) {
    const CustomerPositioning state{now.report, *positioning};
    if (before != nullptr) {
      const CustomerPositioning earlier{before->report, std::get<PositioningEvaluation>(before->found)};
      report = customer_positioning(facts, is_rotary(now.report), state, &earlier);
    } else {
      report = customer_positioning(facts, is_rotary(now.report), state, nullptr);
    }
  } else if (const auto* diagonals = std::get_if<DiagonalsEvaluation>(&now.found)) {
    report = customer_diagonals(facts, now.report, *diagonals, before != nullptr ? &before->report : nullptr);
  } else {
    throw InputError({}, "there is no customer report of " + now.report.kind, "positioning or diagonals");
  }
  if (!now.refused.empty()) report.refusals.push_back(now.refused);
  report.files = files;
  return report;
}

}  // namespace abbe
