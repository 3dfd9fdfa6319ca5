#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/formats/evaluations/section_file.h"
#include "abbe/verify/parts/edge_section.h"
#include "abbe/verify/uncertainty_budget.h"
#include "yin/study.h"

namespace abbe {

/// Mean, largest and standard deviation of the contour error over the 30 points, um.
struct YinFigures {
  double mean = 0, largest = 0, deviation = 0;
};
/// Figures of amounts in mm.
YinFigures yin_figures(std::span<const double> amounts);

/// What Table 1, the microscope and the scanners let expect of the contour error.
struct YinContour {
  UncertaintyBudget budget;  ///< mm; kinds: across the curve, along it
  YinFigures across;         ///< mean over the runs, across the curve
  YinFigures in_surface;     ///< the same for the whole distance in the surface
  YinFigures upper;          ///< 95 % of the runs stay below, across the curve
  double printed_l_ta = 0;   ///< um, largest contour error if L_tA is taken as printed, all else exact
};
YinContour yin_contour(const YinPositioning& positioning, const BudgetOptions& options);

/// One simulated part: engraved by a machine whose errors are drawn once, its 30 sections scanned and evaluated.
struct YinSections {
  std::vector<SectionReadings> sections;
  EdgeOptions options;
  std::vector<double> edge;       ///< [points] mm, where the edges really are, across the curve
  std::vector<double> curvature;  ///< [points] 1/mm, of the surface across the curve
  std::vector<EdgeFit> fits;      ///< [points]
  std::size_t refused = 0;        ///< fits without an edge: no part in what follows
  YinFigures truth, found;        ///< contour error
  YinFigures rounding;            ///< P1 P2, which the paper calls so
  double radius = 0;              ///< mm, of the edges
  double largest_miss = 0;        ///< mm, of the edges found from the edges
};
YinSections yin_sections(const YinPositioning& positioning, std::uint64_t seed);

/// Finds the edges in the sections and takes the figures over those that are found.
void evaluate_sections(YinSections& sections);

}  // namespace abbe
