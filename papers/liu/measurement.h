#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/instruments/virtual_scan.h"
#include "liu/machine.h"
#include "liu/parts.h"
#include "liu/plan.h"

namespace abbe {

/// How the virtual scanner differs from its drawing.
struct LiuScanner {
  LiuUnit unit = LiuUnit::micrometre;
  double taper = 0;         ///< mm/mm, of the standard cylinder; 14 um over 23.5 mm are the cylindricity of Table 2
  double radius_error = 0;  ///< mm, by how much the standard cylinder is larger than assumed
  bool reversed = false;    ///< calibrate with a second clamping of the cylinder end for end, and its taper
  bool noise = true;        ///< 1 um and 0.004 degrees of the axes, 0.1 um of the probe (Table 2)
  std::uint64_t seed = 1;
};

/// Both stages calibrated with the standard cylinder at 0, 90, 180, 270 degrees, 117 points each, as in 4.2.1.
struct LiuCalibration {
  bool converged = false;
  std::string message;
  ErrorSet errors;                    ///< locations in the order of liu_unknowns()
  std::array<double, 2> direction{};  ///< rad, of the axis of A, C: angle between found and true
  std::array<double, 2> distance{};   ///< mm, between the axes in the plane through the origin across them
};
LiuCalibration liu_calibrate(const Machine& machine, const LiuScanner& scanner);

/// Deviations of a measured part from its model, after registration by least squares.
struct LiuDeviation {
  bool registered = false;
  std::size_t points = 0;
  double rms = 0;                      ///< mm, equation (16): about zero
  double largest = 0;                  ///< mm, absolute
  double fitted_radius = 0;            ///< mm, sphere and cylinder by least squares; 0: others
  Eigen::Matrix3Xd registered_points;  ///< [3, points] mm, frame of the part
  Eigen::VectorXd distances;           ///< [points] mm, signed
};

struct LiuMeasurement {
  std::string part;
  std::size_t planned = 0, lost = 0, too_steep = 0;
  LiuDeviation before, after;
};

/// Scans a part along its planned path and evaluates the readings with the nominal machine and with the calibrated one.
/// @param model    the drawing: what the path was planned on, where it is clamped, and what it is compared with
/// @param scanned  what lies on the machine: the part as it is
LiuMeasurement liu_measure(const Machine& machine, const LiuScanner& scanner, const ErrorSet& calibrated,
                           const LiuPart& model, const TriangleMesh& scanned, const ScanPlan& plan);

}  // namespace abbe
