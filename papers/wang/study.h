#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// How the angles of Tables A1 to A6 are read. The tables say degrees; the text derives them as arctan of micrometres
/// over millimetres, which suggests a factor of 1000. Inferred, not proven, so both are offered.
enum class WangAngleUnit { degrees, millidegrees, none };

struct WangReading {
  WangAngleUnit angles = WangAngleUnit::degrees;
  Composition composition;    ///< order of E against the motion, which the paper leaves open
  std::size_t rows = 11;      ///< 11 measured positions per axis, or 12 with the printed mean taken as a position
  bool displacements = true;  ///< false: angles only
};

/// Wang's grinder, `w C b X Z A Y B t`, travel over the printed positions, tool at (200, 0, 0), all points at the
/// origin.
Machine wang_machine();

/// The 36 errors of Tables A1 to A6 as tables over the axis positions.
ErrorSet wang_errors(const WangReading& reading);

/// The point of the workpiece that is looked at, in the workpiece frame, mm.
inline Eigen::Vector3d wang_workpiece_point() { return {0, 0, 400}; }

/// One evaluation of the paper's equations (12) to (18).
struct WangError {
  Eigen::Vector3d tool_actual, workpiece_actual;  ///< machine frame, mm
  Eigen::Vector3d machine;  ///< (W_actual - T_actual) - (W_nominal - T_nominal), machine frame, mm
};

/// @param positions  chain order C X Z A Y B, mm or rad
WangError wang_integrated_error(const Machine& machine, const ErrorSet& errors, const std::vector<double>& positions);

/// Positions in chain order for printed rows i of X Y Z A B C (0-based), mm or rad.
std::vector<double> wang_positions(const std::vector<std::size_t>& rows_xyzabc);

/// The paper's zero pose: the first position of every table, of B the seventh, which is 0 degrees.
std::vector<std::size_t> wang_zero_rows();  ///< tables X Y Z A B C
std::vector<double> wang_zero_pose();       ///< chain order, mm or rad

/// What "of the order of" means here: within a factor of the square root of 10. For positive numbers.
bool is_of_the_order(double value, double order);

/// Integrated error over all combinations of the rows, as printed in machine coordinates.
struct WangPopulation {
  SampleStatistics norm;                                      ///< mm
  Eigen::Vector3d mean_components = Eigen::Vector3d::Zero();  ///< mm
  double share_of_order_1_mm = 0;                             ///< of the poses, is_of_the_order(|E|, 1 mm), 0 to 1
  std::vector<double> worst_pose;                             ///< chain order
  Histogram histogram;                                        ///< of norm, mm
};

/// All rows^6 poses: 1,771,561 for 11, 2,985,984 for 12.
WangPopulation wang_all_poses(const WangReading& reading, int threads = 0);

}  // namespace abbe
