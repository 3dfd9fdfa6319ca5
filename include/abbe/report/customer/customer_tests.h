#pragma once

#include "abbe/report/customer/customer_report.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/circular.h"
#include "abbe/verify/evaluations/rotation_error_motion.h"
#include "abbe/verify/evaluations/squareness.h"
#include "abbe/verify/evaluations/straightness.h"
#include "abbe/verify/parts/contour_sections.h"
#include "abbe/verify/thermal/axis_distortion.h"
#include "abbe/verify/thermal/etve.h"
#include "abbe/verify/thermal/location_distortion.h"
#include "abbe/verify/thermal/spindle_distortion.h"

namespace abbe {

// Customer reports on tests of one kind each: figures with their uncertainties and tolerances, drawings, and errors at
// positions. Names, numbers and captions are in the language of the facts; notes of the evaluation in English.
//
// In all of them `now` is the report of the evaluation, with tolerances, and `before` null, or the report of the same
// test before a correction, whose figures stand in front.

/// Circular test by ISO 230-4, with the radial deviations of the readings nearest to every 15 degrees.
CustomerReport customer_circular(const ReportFacts& facts, const EvaluationReport& now, const CircularResult& result,
                                 const EvaluationReport* before);

/// Error motions of an axis of rotation by ISO 230-7, with the synchronous ones nearest to every 15 degrees.
CustomerReport customer_rotation(const ReportFacts& facts, const EvaluationReport& now, const RotationResult& result,
                                 const EvaluationReport* before);

/// Straightness by ISO 230-1, with the deviations from both reference lines.
CustomerReport customer_straightness(const ReportFacts& facts, const EvaluationReport& now,
                                     const Straightness& least_squares, const Straightness& minimum_zone,
                                     const EvaluationReport* before);

/// Squareness by ISO 230-1, with the deviations of both lines.
CustomerReport customer_squareness(const ReportFacts& facts, const EvaluationReport& now, const Squareness& result,
                                   const EvaluationReport* before);

/// Cross-sections of an engraved curve, with the contour error and the rounding of each.
CustomerReport customer_sections(const ReportFacts& facts, const EvaluationReport& now, const SectionsEvaluation& found,
                                 const EvaluationReport* before);

/// Points on an engraved curve, with the deviations of each.
CustomerReport customer_contour_points(const ReportFacts& facts, const EvaluationReport& now,
                                       const ContourPointsEvaluation& found, const EvaluationReport* before);

/// Linkage of a laser engraver: its parameters.
CustomerReport customer_linkage(const ReportFacts& facts, const EvaluationReport& now, const EvaluationReport* before);

/// Environmental temperature variation error, with the displacements and angles over time.
CustomerReport customer_etve(const ReportFacts& facts, const EvaluationReport& now, const EtveEvaluation& evaluation,
                             const EvaluationReport* before);

/// Thermal distortion by a rotating spindle, with the displacements and angles over time.
CustomerReport customer_spindle_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                           const SpindleDistortion& distortion, const EvaluationReport* before);

/// Thermal distortion of location errors, with these over time.
CustomerReport customer_location_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                            const LocationDistortion& distortion, const EvaluationReport* before);

/// Thermal distortion by a moving linear axis, with the changes at the targets over time.
CustomerReport customer_axis_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                        const AxisDistortion& distortion, const EvaluationReport* before);

/// Name of a figure of one of these evaluations in a language; that of the figure where there are no words for it.
/// @param kind  as EvaluationReport::kind
std::string test_figure_name(const std::string& kind, const EvaluationFigure& figure, ReportLanguage language);

}  // namespace abbe
