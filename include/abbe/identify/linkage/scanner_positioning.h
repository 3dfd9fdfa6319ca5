#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/geometry/fits/coaxial_circles.h"
#include "abbe/geometry/registration/feature_registration.h"
#include "abbe/machine/placement.h"

namespace abbe {

/// What a scanner that stands beside a machine has seen of targets on its table; all points in the scanner's frame, mm.
///
/// The table's frame: origin on the axis of the turntable at the height of the table, axes along X and Y as they move
/// the table. Source: Yin et al., Machines 9 (2021) 237, section 3.2.
struct PositioningScans {
  std::vector<Eigen::Vector3d> along_x, along_y;      ///< a target while X (Y) carries it in its positive sense
  std::vector<std::vector<Eigen::Vector3d>> circles;  ///< targets while the table turns, in order
  bool turned_positively = true;                      ///< the table turned by the right-hand rule about the table's Z
  std::vector<Eigen::Vector3d> sphere;                ///< points of a standard sphere on the table
  double sphere_radius = 0;                           ///< mm; 0: found from the points
  double sphere_height = 0;                           ///< z_p: of its centre above the table, mm
  /// By how much X and Y have carried the table since the sphere was scanned, in the table's axes, mm.
  Eigen::Vector3d moved_since = Eigen::Vector3d::Zero();
  double target_noise = 0;  ///< standard uncertainty of a coordinate of a target, mm; 0: from the residuals
  double sphere_noise = 0;  ///< of a point of the sphere along its normal, mm; 0: from the residuals
  double height_noise = 0;  ///< of sphere_height, mm
};

enum class PositioningStatus {
  not_run,
  ok,
  bad_line,  ///< the targets along X or Y determine no direction
  bad_circles,
  bad_sphere,
  inconsistent  ///< the directions contradict each other: the table's axis more than a degree from X cross Y
};

/// Where the scanner stands, seen from the table.
struct ScannerPosition {
  PositioningStatus status = PositioningStatus::not_run;
  std::string reason;
  RigidTransform table_from_scanner;  ///< D_M^B with the table where it is now
  Eigen::Vector3d x_direction = Eigen::Vector3d::Zero(), y_direction = Eigen::Vector3d::Zero();  ///< scanner's frame
  CoaxialCircles circles;                                    ///< of the table's axis, scanner's frame
  Eigen::Vector3d axis_direction = Eigen::Vector3d::Zero();  ///< L: of that axis by the sense of turning, towards +Z
  Eigen::Vector3d sphere_centre = Eigen::Vector3d::Zero();   ///< o_s, scanner's frame
  Eigen::Vector3d on_axis = Eigen::Vector3d::Zero();         ///< o_sc, the centre's foot on the axis, scanner's frame
  double squareness = 0;                                     ///< angle from X to Y less 90 degrees, rad
  Eigen::Vector2d axis_tilt = Eigen::Vector2d::Zero();  ///< of the table's axis against X cross Y, about X and Y, rad
  /// Covariance of a small motion of scanned points in the table's frame: translation at the table's origin (mm), then
  /// rotation vector (rad).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Position of the scanner from the scans: R of X and Y by polar projection, the table's axis from all circles jointly,
/// the height from the sphere.
///
///     R = rotation nearest to [n_X n_Y n_X x n_Y]'   T = (-x_sR, -y_sR, z_p - z_sR) - moved_since   o_sR = R o_sc
///
/// As printed, (13) to (15) take the directions as they are, which is no rotation unless X and Y are square, (15)
/// orients the axis by the heights of two circles, (17) has t_z with the wrong sign and (18) moves the wrong way.
ScannerPosition locate_scanner(const PositioningScans& scans);

/// Where the workpiece is clamped: table_from_workpiece = table_from_scanner (workpiece_from_scanner)^-1, with the
/// covariances of both.
/// @param scan_on_workpiece  registration of the workpiece's scan; `mesh_from_scan` is workpiece from scanner
Placement locate_workpiece(const ScannerPosition& scanner, const FineRegistration& scan_on_workpiece);

/// The six positioning parameters x, y, z (mm), alpha, beta, gamma (rad) of the paper's equation (8), of D with
/// p_workpiece = D p_table (`table_to_workpiece`) or p_table = D p_workpiece; Table 3 may be read either way.
struct PositioningParameters {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), angles = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the six, mm and rad
};
PositioningParameters positioning_parameters(const Placement& placement, bool table_to_workpiece);

}  // namespace abbe
