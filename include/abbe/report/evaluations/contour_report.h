#pragma once

#include <string>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/parts/contour_sections.h"

namespace abbe {

/// Edges of sections: contour error and rounding, over the curve; a section that is refused is named with its reason.
/// @param title  "Contour error of x.csv"
EvaluationReport section_report(const std::string& title, const SectionOptions& options,
                                const std::vector<SectionReadings>& sections, const SectionsEvaluation& evaluated);

/// Measured points against a commanded curve in pieces.
EvaluationReport contour_points_report(const std::string& title, const std::vector<CommandPiece>& pieces,
                                       const ContourPointsEvaluation& evaluated);

/// A length with its expanded uncertainty, if it has one. @param uncertainty  standard, mm
EvaluationFigure contour_figure(std::string symbol, std::string name, double value, double uncertainty);

/// Figures SYMBOL_mean, SYMBOL_max, SYMBOL_s: of amounts, with their uncertainties.
/// @param missing  why there are none; empty: there are
void add_contour_figures(EvaluationReport& report, const std::string& symbol, const std::string& name,
                         const ContourFigures& figures, const std::string& missing);

}  // namespace abbe
