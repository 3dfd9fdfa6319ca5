#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "abbe/identify/linkage/swing_head_linkage.h"

namespace abbe {

/// Commands and readings of the five steps by which a laser engraver measures its own linkage.
///
/// Positions of lines are in the frame of the table C2 at C2 = 0; heights are measured from the table upwards, mm.
/// Step 1, the zeros of A and C1, has no reading. Source: Yin et al., Machines 9 (2021) 237, section 3.1.
struct LinkageReadings {
  LinkageConvention convention = LinkageConvention::table_moves;
  // Step 2, A = 0: lines on a board on the table while Z steps through the focus.
  double exit_z = 0;                ///< z1: command at which the beam's exit is level with the table
  std::vector<double> focus_z;      ///< commands, mm
  std::vector<double> focus_width;  ///< [focus_z] widths of the lines, mm
  double exit_to_axis = 0;          ///< d: from the exit to the axis of A, known of the head
  double board_thickness = 0;       ///< h
  // Step 3, C1 = 90, A = 90 and -90 degrees with the table turned between: lines on an upright board.
  double height_first = 0, height_second = 0;
  // Step 4, A = 0, C1 = 0 and 180 degrees: lines along Y (position in x) and along X (position in y).
  double x_first = 0, x_second = 0;  ///< x1, x2: commands
  double line3_x = 0, line5_x = 0;
  double line4_y = 0, line6_y = 0;
  // Step 5, A = 0, C1 = 90: marks while the table turns.
  double circle_x = 0, circle_y = 0, circle_z = 0;  ///< x3, y3, z3: commands; z3 with the focus on the board
  std::vector<double> table_angle;  ///< rad, by which the focus turns about the table's axis, seen from the board
  std::vector<Eigen::Vector2d> circle_marks;  ///< [table_angle] mm, in axes of the board parallel to X and Y at angle
                                              ///< 0; empty: the circle has been brought to a point
};

/// Standard uncertainties that enter the readings, mm and rad.
struct LinkageAccuracy {
  double x = 0, y = 0, z = 0;              ///< positions of the linear axes, each time anew
  double a = 0, c1 = 0, c2 = 0;            ///< of the rotary axes
  double zero_a = 0, zero_c1 = 0;          ///< step 1
  double microscope = 0;                   ///< position of one line
  double width = 0;                        ///< of one line
  double exit_to_axis = 0, thickness = 0;  ///< d and h

  /// Table 1 of the paper taken as one standard deviation, zeros as good as their axes, microscope 2 um.
  static LinkageAccuracy published();
};

enum class LinkageStatus {
  not_run,
  ok,
  too_few_readings,     ///< fewer than four widths, or one mark of the circle
  no_focus,             ///< the widths have no smallest value
  focus_outside,        ///< the parabola's lowest point lies outside the series: extrapolated
  circle_undetermined,  ///< the table has not turned between the marks of the circle
  circle_reversed       ///< the marks go round against the stated angles
};

/// Variances of the parameters from one cause.
struct LinkageShare {
  std::string cause;  ///< "X", "zero of A", "microscope", ...
  Eigen::Matrix<double, SwingHeadLinkage::kCount, 1> variance =
      Eigen::Matrix<double, SwingHeadLinkage::kCount, 1>::Zero();  ///< mm^2
};

/// What the five steps say.
struct LinkageEvaluation {
  LinkageStatus status = LinkageStatus::not_run;
  std::string reason;
  SwingHeadLinkage linkage;
  SwingHeadLinkage printed;          ///< by the paper's equations (9) to (12) and step 3, from the same readings
  double focus_z = 0;                ///< z2: lowest point of the parabola through width squared, mm
  double thinnest_z = 0;             ///< command of the thinnest line, which the paper takes instead, mm
  double waist = 0, divergence = 0;  ///< of the beam, from the parabola: mm, tangent
  Eigen::Vector2d circle_arm = Eigen::Vector2d::Zero();  ///< from the table's axis to the focus in step 5, mm
  Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount> covariance =
      Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount>::Zero();  ///< mm^2
  std::vector<LinkageShare> shares;                                                       ///< of its diagonal

  double standard_uncertainty(std::size_t parameter) const;  ///< mm
};

/// Linkage parameters from the five steps, signed, with the corrected equations.
///
///     R_A   = |z2 - z1| + d - h          z2 from the weighted parabola through width squared
///     L_tA  = (height_1 - height_2)/2    P: the opposite sign, its Z points down
///     R_C1  = (s (x2 - x1) + l3 - l5)/2  s = dp/dX: -1 in U, +1 in P
///     L_AC1 = (l4 - l6)/2 - L_tA
///     x0 = L_tA + L_AC1 - s x3, y0 = -R_C1 - s y3, z0 = -s z3 - R_A - h
///
/// The marks of step 5 need not meet in a point: m = centre + R(angle) arm is linear in both, and the commands at which
/// the arm vanishes are x3 - s arm. The covariance is that of the whole procedure: every position of an axis and every
/// reading of the microscope is one cause of its own and goes through the simulated steps by central differences.
LinkageEvaluation evaluate_linkage(const LinkageReadings& readings, const LinkageAccuracy& accuracy);

/// One cause of error of one reading.
struct LinkageDisturbance {
  std::string cause;
  double standard_uncertainty = 0;  ///< mm or rad
};

/// The causes in the order in which simulate_linkage() takes them.
/// @param commands  only the commands, d and h count
std::vector<LinkageDisturbance> linkage_disturbances(const LinkageReadings& commands, const LinkageAccuracy& accuracy);

/// Readings that a machine of these parameters gives at those commands.
/// @param waist, divergence  of the beam: mm, tangent
/// @param disturbances       [linkage_disturbances()] mm or rad, or empty: exact
LinkageReadings simulate_linkage(const SwingHeadLinkage& truth, const LinkageReadings& commands, double waist,
                                 double divergence, std::span<const double> disturbances = {});

/// Commands as an operator would choose them for a machine that is about so: 25 widths over +-1.2 mm, table in steps of
/// 30 degrees about a point some millimetres off.
LinkageReadings linkage_commands(const SwingHeadLinkage& about, LinkageConvention convention, double exit_to_axis,
                                 double board_thickness);

}  // namespace abbe
