#pragma once

// Readings of a test evaluated by its standard, as `abbe evaluate` does it:
//
//   #include <abbe/study/evaluations/evaluation.h>
//
//   #include <cstdio>
//   #include <utility>
//
//   int main() {
//     abbe::PositioningTest test;
//     test.linear.instrument_per_length = 0.6e-6;  // expanded: 0.6 um per m
//     abbe::EvaluationRequest request;
//     request.file = "examples/evaluate/linear.csv";
//     test.readings = abbe::read_positioning(request.file);
//     request.test = std::move(test);
//     request.tolerances = {"A_um=15"};
//     const abbe::Evaluation evaluation = abbe::evaluate_readings(request);
//     const abbe::EvaluationFigure& accuracy = evaluation.report.figures.front();
//     std::printf("%s = %.2f um, U = %.2f um\n", accuracy.symbol.c_str(), 1e3 * *accuracy.value,
//                 1e3 * *accuracy.uncertainty);
//     return evaluation.is_ok() ? 0 : 1;  // evaluation_text(evaluation.report) says more
//   }
//
// It prints:
//
//   A = 10.82 um, U = 0.59 um
//
// One request and one function for all tests; what each of them needs:
//   axis_tests.h     positioning, diagonals, circular tests, axes of rotation, straightness, squareness
//   contour_tests.h  engraved curves: cross-sections of them, and points on them
//   linkage_tests.h  the five steps of a laser engraver
//   thermal_tests.h  thermal effects of ISO 230-3
//
// The report as JSON: evaluation_json(); as a page: evaluation_files(). Figures: docs/evaluate.md.

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "abbe/formats/study/report_facts.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/study/evaluations/axis_tests.h"
#include "abbe/study/evaluations/contour_tests.h"
#include "abbe/study/evaluations/linkage_tests.h"
#include "abbe/study/evaluations/thermal_tests.h"

namespace abbe {

/// One of the available tests.
using TestToEvaluate = std::variant<PositioningTest, DiagonalsTest, CircularTest, RotationTest, StraightnessTest,
                                    SquarenessTest, SectionsTest, ContourPointsTest, LinkageTest, EtveTest,
                                    SpindleDistortionTest, AxisDistortionTest, LocationDistortionTest>;

/// Readings of a test, and the tolerances of its figures.
///
/// Messages name a field by the option of `abbe evaluate` that sets it, given at each test.
struct EvaluationRequest {
  std::string file;  ///< of the readings: name for texts and messages
  TestToEvaluate test;
  std::vector<std::string> tolerances;               ///< --tolerance: "A_um=10", as apply_tolerances() takes them
  std::vector<ReportTolerance> report_tolerances{};  ///< those of a customer report, in addition
};

/// The numerical results of a test, from which its report is made; mm and rad.
using EvaluatedNumbers =
    std::variant<PositioningEvaluation, DiagonalsEvaluation, CircularEvaluation, RotationResult, StraightnessEvaluation,
                 Squareness, SectionsEvaluation, ContourPointsEvaluation, LinkageEvaluation, EtveEvaluation,
                 SpindleDistortion, AxisDistortion, LocationDistortion>;

/// Result of a test. It holds no reference to the request.
struct Evaluation {
  EvaluatedNumbers found;   ///< of the kind of the test
  EvaluationReport report;  ///< with the tolerances of the request
  /// Why the figures are not those requested; empty: they are. Tolerances are no reason: the report
  /// says which of them are exceeded.
  std::string refused;
  /// Further files of the results folder, besides evaluation_files(): name, contents.
  std::vector<std::pair<std::string, std::string>> files;

  /// Whether the figures are those requested and exceed no tolerance.
  bool is_ok() const { return refused.empty() && !report.exceeds_tolerance(); }
};

/// Evaluates readings and judges their figures. Opens no file and prints nothing.
/// @throws InputError as the test says, for a request without readings, and as apply_tolerances()
Evaluation evaluate_readings(const EvaluationRequest& request);

}  // namespace abbe
