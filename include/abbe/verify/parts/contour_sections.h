#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/verify/parts/contour_error.h"
#include "abbe/verify/parts/edge_section.h"

namespace abbe {

// Contour error of an engraved curve: from cross-sections of a line scanner, and from measured points.

/// One cross-section of an engraved line, as a line scanner gives it.
struct SectionReadings {
  std::string name;
  Eigen::Matrix2Xd points;          ///< [2, n] mm: across the line, out of the material; origin on the commanded curve
  std::optional<double> along;      ///< mm, where on the curve
  std::optional<double> beam_tilt;  ///< rad, of the laser's direction from the height towards across
};

struct SectionOptions {
  bool groove = false;            ///< both edges and their middle, instead of one edge
  EdgeOptions edge;               ///< the beam's tilt is that of sections that do not state their own
  double origin_uncertainty = 0;  ///< mm, standard: of the sections' origins against the commanded curve, in common
};

/// What one section says.
struct SectionAnswer {
  std::string name;             ///< of the section
  std::optional<double> along;  ///< mm, where on the curve
  bool groove = false;
  EdgeFit first, second;  ///< the edge, or the left and the right one of a groove
  bool ok = false;
  std::string reason;                       ///< why not
  double error = 0, error_uncertainty = 0;  ///< mm, signed, across the curve; standard
  double width = 0;                         ///< mm, of a groove

  std::vector<const EdgeFit*> edges() const;  ///< those that there are
};

SectionAnswer evaluate_section(const SectionReadings& section, const SectionOptions& options);

/// Results of all sections of a curve.
struct SectionsEvaluation {
  std::vector<SectionAnswer> answers;  ///< [sections]
  std::size_t refused = 0;             ///< sections without an answer
  std::size_t largest = 0;             ///< section with the largest contour error; the number of sections: none
  ContourFigures contour, rounding;    ///< of the sections, and of all of their edges
  double radius = 0;                   ///< mm, mean of the edges

  std::size_t evaluated() const { return answers.size() - refused; }
};

/// Edges of sections: contour error and rounding.
SectionsEvaluation evaluate_sections(const std::vector<SectionReadings>& sections, const SectionOptions& options);

/// Whether all sections say where on the curve they are; else their number stands for it.
bool along_is_stated(const std::vector<SectionReadings>& sections);

/// Deviations of measured points from a commanded curve, with figures.
struct ContourPointsEvaluation {
  std::vector<ContourDeviation> deviations;  ///< [points]
  std::vector<std::size_t> counted;          ///< points beside the curve, with a distance across it and out of it
  std::size_t beyond = 0;                    ///< points beyond an end of the curve: no part in any figure
  std::size_t undirected = 0;                ///< points where nothing is across the curve: only distances count
  ContourFigures across, off, distance;      ///< of these points, and of all that are not beyond an end
};

/// Deviations of measured points from a commanded curve, and their figures.
/// @param pieces  one at least, with the surface's normals at their points
/// @param points  [3, n] mm
/// @param common  standard uncertainty of the points' place against the curve, which all share, mm
/// @throws std::invalid_argument as contour_deviations()
ContourPointsEvaluation evaluate_contour_points(const std::vector<CommandPiece>& pieces, const Eigen::Matrix3Xd& points,
                                                double common);

}  // namespace abbe
