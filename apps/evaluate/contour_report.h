#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/formats/section_file.h"
#include "abbe/report/evaluation_report.h"
#include "abbe/verify/contour_error.h"
#include "abbe/verify/edge_section.h"

namespace abbe {

/// What an evaluation of a contour was asked.
struct ContourRequest {
  std::string title;              ///< "Contour error of x.csv"
  bool groove = false;            ///< both edges and their middle, instead of one edge
  EdgeOptions edge;               ///< the beam's tilt is that of sections that do not state their own
  double origin_uncertainty = 0;  ///< mm, standard: of the sections' origins against the commanded curve, in common
};

/// Edges of sections: contour error and rounding, over the curve; a section that is refused is named with its reason.
/// @param refused  set to the number of sections without an answer
EvaluationReport section_report(const ContourRequest& request, const std::vector<SectionReadings>& sections,
                                std::size_t& refused);

/// Measured points against a commanded curve in pieces, with the surface's normals at its points.
EvaluationReport contour_points_report(const ContourRequest& request, const std::vector<CommandPiece>& pieces,
                                       const Eigen::Matrix3Xd& points);

/// A length with its expanded uncertainty, if it has one. @param uncertainty  standard, mm
EvaluationFigure contour_figure(std::string symbol, std::string name, double value, double uncertainty);

/// Figures SYMBOL_mean, SYMBOL_max, SYMBOL_s: of amounts, with their uncertainties.
/// @param missing  why there are none; empty: there are
void add_contour_figures(EvaluationReport& report, const std::string& symbol, const std::string& name,
                         const ContourFigures& figures, const std::string& missing);

}  // namespace abbe
