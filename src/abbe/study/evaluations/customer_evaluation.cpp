#include "abbe/study/evaluations/customer_evaluation.h"

#include <algorithm>

#include "abbe/formats/text/input_error.h"
#include "abbe/report/customer/customer_positioning.h"
#include "abbe/report/customer/customer_tests.h"

namespace abbe {
namespace {

bool is_rotary(const EvaluationReport& report) { return report.figures.front().quantity == Quantity::angle; }

/// Two evaluations are of one test if they have a figure in common, of the same axes.
bool are_of_one_test(const EvaluationReport& now, const EvaluationReport& before) {
  return std::any_of(now.figures.begin(), now.figures.end(), [&](const EvaluationFigure& figure) {
    return std::any_of(before.figures.begin(), before.figures.end(), [&](const EvaluationFigure& other) {
      return other.symbol == figure.symbol && other.quantity == figure.quantity && other.about == figure.about;
    });
  });
}

/// Of the axes of a circular test, the lines of a squareness test.
bool differ_in_axes(const EvaluationReport& now, const EvaluationReport& before) {
  for (const EvaluationFigure& figure : now.figures) {
    for (const EvaluationFigure& other : before.figures) {
      if (other.symbol == figure.symbol && other.about != figure.about) return true;
    }
  }
  return false;
}

/// Makes the report of what was found, whatever it is.
struct ReportMaker {
  const ReportFacts& facts;
  const Evaluation& now;
  const Evaluation* before;

  const EvaluationReport* report_before() const { return before != nullptr ? &before->report : nullptr; }

  CustomerReport operator()(const PositioningEvaluation& found) const {
    const CustomerPositioning state{now.report, found};
    if (before == nullptr) return customer_positioning(facts, is_rotary(now.report), state, nullptr);
    const CustomerPositioning earlier{before->report, std::get<PositioningEvaluation>(before->found)};
    return customer_positioning(facts, is_rotary(now.report), state, &earlier);
  }
  CustomerReport operator()(const DiagonalsEvaluation& found) const {
    return customer_diagonals(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const CircularEvaluation& found) const {
    return customer_circular(facts, now.report, found.deviations, report_before());
  }
  CustomerReport operator()(const RotationResult& found) const {
    return customer_rotation(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const StraightnessEvaluation& found) const {
    return customer_straightness(facts, now.report, found.least_squares, found.minimum_zone, report_before());
  }
  CustomerReport operator()(const Squareness& found) const {
    return customer_squareness(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const SectionsEvaluation& found) const {
    return customer_sections(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const ContourPointsEvaluation& found) const {
    return customer_contour_points(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const LinkageEvaluation&) const {
    return customer_linkage(facts, now.report, report_before());
  }
  CustomerReport operator()(const EtveEvaluation& found) const {
    return customer_etve(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const SpindleDistortion& found) const {
    return customer_spindle_distortion(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const AxisDistortion& found) const {
    return customer_axis_distortion(facts, now.report, found, report_before());
  }
  CustomerReport operator()(const LocationDistortion& found) const {
    return customer_location_distortion(facts, now.report, found, report_before());
  }
};

}  // namespace

CustomerReport customer_evaluation(const ReportFacts& facts, const Evaluation& now, const Evaluation* before,
                                   const std::vector<std::string>& files) {
  if (before != nullptr &&
      (before->found.index() != now.found.index() || !are_of_one_test(now.report, before->report) ||
       differ_in_axes(now.report, before->report))) {
    throw InputError({.field = "--before"}, "the readings are of another test or of other axes",
                     "readings of the same test");
  }
  CustomerReport report = std::visit(ReportMaker{facts, now, before}, now.found);
  if (!now.refused.empty()) report.refusals.push_back(now.refused);
  if (before != nullptr && !before->refused.empty()) report.notes.push_back("before: " + before->refused + ".");
  report.files = files;
  return report;
}

}  // namespace abbe
