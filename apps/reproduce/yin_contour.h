#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "abbe/formats/section_file.h"
#include "abbe/verify/edge_section.h"
#include "abbe/verify/error_budget.h"
#include "reproduce/yin_study.h"

namespace abbe {

/// Mean, largest and standard deviation of the contour error over the 30 points, um.
struct YinFigures {
  double mean = 0, largest = 0, deviation = 0;
};
/// Figures of amounts in mm.
YinFigures yin_figures(const Eigen::VectorXd& amounts);

/// What Table 1, the microscope and the scanners let expect of the contour error.
struct YinContour {
  ErrorBudget budget;       ///< mm; kinds: across the curve, along it
  YinFigures across;        ///< mean over the runs, across the curve
  YinFigures in_surface;    ///< the same for the whole distance in the surface
  YinFigures upper;         ///< 95 % of the runs stay below, across the curve
  double printed_l_ta = 0;  ///< um, largest contour error if L_tA is taken as printed, all else exact
};
YinContour yin_contour(const YinPositioning& positioning, const BudgetOptions& options);

/// One simulated part: engraved by a machine whose errors are drawn once, its 30 sections scanned and evaluated.
struct YinSections {
  std::vector<SectionReadings> sections;
  EdgeOptions options;
  std::vector<double> edge;  ///< [points] mm, where the edges really are, across the curve
  std::vector<EdgeFit> fits;
  YinFigures truth, found;  ///< contour error
  YinFigures rounding;      ///< P1 P2, which the paper calls so
  double radius = 0;        ///< mm, of the edges
  double largest_miss = 0;  ///< mm, of the edges found from the edges
};
YinSections yin_sections(const YinPositioning& positioning, std::uint64_t seed);

}  // namespace abbe
