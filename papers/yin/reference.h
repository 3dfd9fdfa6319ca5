#pragma once

#include <array>
#include <vector>

#include "abbe/identify/linkage/linkage_steps.h"
#include "abbe/identify/linkage/scanner_positioning.h"

namespace abbe {

// Yin et al. (2021), Machines 9, 237: the paper's numbers, and those computed from its equations by an independent
// program (golden/yin). Every reader throws InputError if the reference is not found.

/// Linkage parameters of Table 2.
SwingHeadLinkage yin_linkage();

/// Readings of the five steps without noise, and the parameters that they give.
struct YinLinkageReference {
  LinkageReadings readings;
  double waist = 0, divergence = 0;                                     ///< of the beam, mm and tangent
  std::array<double, SwingHeadLinkage::kCount> recovered{}, printed{};  ///< corrected, and as the paper has it
};
YinLinkageReference yin_linkage_reference(LinkageConvention convention);

/// A scanner's view of targets, sphere and workpiece without noise, with every intermediate result.
struct YinPositioningReference {
  PositioningScans scans;
  Eigen::Matrix3Xd surface;         ///< [3, n] mm, of the workpiece, scanner's frame
  std::vector<std::size_t> labels;  ///< [n] of yin_part()
  RigidTransform start;             ///< workpiece from scanner, roughly
  RigidTransform table_from_scanner, workpiece_from_scanner, workpiece_from_table;
  Eigen::Vector3d x_direction, y_direction, axis_direction, sphere_centre, on_axis, on_axis_turned;
  std::array<double, 6> parameters{};  ///< Table 3: mm, then degrees
};
YinPositioningReference yin_positioning_reference();

/// Surfaces of the workpiece in its frame: the cylinder on which Table A4 lies, the planes z = 205 and x = 155.
std::vector<Shape> yin_part();

/// A point of Table A4 with the beam's direction (outward normal of the cylinder) and the curve's, workpiece frame.
struct YinPoint {
  Eigen::Vector3d point, normal, tangent;
  double along = 0;      ///< mm, along the curve
  double curvature = 0;  ///< 1/mm, of the surface across the curve, positive: convex
};
std::vector<YinPoint> yin_curve();

}  // namespace abbe
