#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/identify/linkage_steps.h"
#include "abbe/identify/scanner_positioning.h"

namespace abbe {

/// Yin et al. (2021), Machines 9, 237: a laser engraver measures its linkage, a scanner its workpiece.

/// Linkage parameters of Table 2.
SwingHeadLinkage yin_linkage();

/// The five steps in one convention against the reference computed elsewhere.
struct YinSteps {
  LinkageEvaluation found;        ///< from the exact readings, with the accuracies of Table 1 and the microscope
  double largest_difference = 0;  ///< mm, corrected and printed parameters against the reference
};
/// @throws InputError if the reference (golden/yin) is not found
YinSteps yin_steps(LinkageConvention convention);

/// Positioning from the reference's scans.
struct YinPositioning {
  ScannerPosition scanner;
  FineRegistration registration;
  Placement placement;
  PositioningParameters table_to_workpiece, workpiece_to_table;  ///< both readings of Table 3
  double largest_difference = 0;                                 ///< mm (directions: as vectors), from the reference
};
/// Standard uncertainties: targets 10 um, sphere and workpiece 20 um.
YinPositioning yin_positioning();

/// A point of Table A4 with the beam's direction (outward normal of the cylinder) and the curve's, workpiece frame.
struct YinPoint {
  Eigen::Vector3d point, normal, tangent;
};
std::vector<YinPoint> yin_curve();

/// One cause of contour error.
struct BudgetShare {
  std::string cause;
  double across = 0;      ///< um, root mean square over the points of its standard uncertainty across the curve
  double in_surface = 0;  ///< um, the same of both components in the surface
};

/// Mean, largest and standard deviation of the contour error over the 30 points, um.
struct ContourFigures {
  double mean = 0, largest = 0, deviation = 0;
};

/// What Table 1, the microscope and the scanner let expect of the contour error.
struct YinContour {
  std::vector<BudgetShare> shares;                    ///< by sensitivity, largest first
  double across = 0, in_surface = 0;                  ///< um, root mean square over the points, by sensitivity
  double sampled_across = 0, sampled_in_surface = 0;  ///< um, the same by Monte Carlo
  ContourFigures measured;                            ///< mean over the runs, distance across the curve
  ContourFigures whole;                               ///< the same for the whole distance in the surface
  ContourFigures upper;                               ///< 95 % of the runs stay below, distance across the curve
  double printed_l_ta = 0;  ///< um, largest contour error if L_tA is taken as printed, all else exact
  std::size_t causes = 0, runs = 0;
};
YinContour yin_contour(const YinPositioning& positioning, std::size_t runs, std::uint64_t seed);

}  // namespace abbe
