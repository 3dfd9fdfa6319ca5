#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/machine/tool_path.h"

namespace abbe {

/// A straight line of a ruled surface with the surface's normals at both of its ends; mm, workpiece frame.
struct Ruling {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();
  Eigen::Vector3d head = Eigen::Vector3d::Zero();
  Eigen::Vector3d foot_normal = Eigen::Vector3d::UnitX();  ///< unit, out of the material
  Eigen::Vector3d head_normal = Eigen::Vector3d::UnitX();
};

/// A ruled surface that the flank of a cylindrical end mill mills in one cut, and the path of the tool.
///
/// At every ruling the axis of the tool runs through the ends of the ruling, each moved out along its normal by the
/// tool's radius: on the surfaces of a cone or of constant slope this is exact, on a twisted one the surface is cut
/// exactly along two curves and too deep between them, by as much on every machine (0.23 mm of the S with its
/// defaults).
/// The functional point is the middle of the tool's end; it stands at the height of the ruling's foot.
struct TestPiece {
  std::vector<Ruling> rulings;  ///< [points of the curve]
  Curve curve;                  ///< the tool does not work on the way to the first point
  double tool_radius = 0;       ///< mm
};

/// Cone frustum on a wedge, to be milled with all five axes at once.
///
/// The test of ISO 10791-7 (M3) and NAS 979: the axis of the cone is inclined to the table, so both rotary axes go
/// to and fro while the tool runs round. The base stands with its centre at `base_centre`, the cone's axis leans from
/// +Z towards `lean_azimuth`.
struct ConeFrustum {
  double base_diameter = 80;                                 ///< mm
  double height = 20;                                        ///< mm along the axis
  double half_apex_angle = 0.2617993877991494;               ///< rad, 15 degrees
  double inclination = 0.17453292519943295;                  ///< rad, 10 degrees, of the axis
  double lean_azimuth = 0;                                   ///< rad from +X
  Eigen::Vector3d base_centre = Eigen::Vector3d(0, 60, 40);  ///< mm, workpiece frame
  double tool_radius = 10;                                   ///< mm
  double feed = 20;                                          ///< mm/s of the functional point
  double chord_tolerance = 0.001;  ///< mm, of the base circle from the chords between the points
};

/// @throws std::invalid_argument for sizes that make no frustum: height up to the apex, angles outside 0 to 90 degrees;
///         for a tolerance that takes more than a million points
TestPiece cone_frustum(const ConeFrustum& frustum);

/// Wall with a foot in the shape of an S whose lean changes along it: the tool axis has to swing from one side to the
/// other just where the curvature changes its sign.
///
/// In the manner of the S-shaped test piece of ISO 10791-7 (M4), with a surface in closed form: over s from 0 to 1 the
/// foot is centre + Rz(azimuth) (length (s - 1/2), amplitude sin(2 pi s), 0), the ruling leans out of the material by
/// lean cos(2 pi s) + twist sin(2 pi s) in the foot's normal plane. The numbers of the standard's B-splines are others,
/// and so are its dimensions.
struct SShape {
  double length = 160;                                 ///< mm
  double amplitude = 40;                               ///< mm
  double height = 40;                                  ///< mm along Z
  double lean = 0.08726646259971647;                   ///< rad, 5 degrees
  double twist = 0.2617993877991494;                   ///< rad, 15 degrees
  double azimuth = 0;                                  ///< rad from +X
  Eigen::Vector3d centre = Eigen::Vector3d(0, 0, 30);  ///< mm, workpiece frame
  double tool_radius = 10;                             ///< mm
  double feed = 20;                                    ///< mm/s of the functional point
  double chord_tolerance = 0.001;                      ///< mm, of the foot from the chords between the points
};

/// @throws std::invalid_argument for sizes that make no wall, a tool too thick for the inside of its crests, and a
/// tolerance
///         that takes more than a million points
TestPiece s_shape(const SShape& shape);

}  // namespace abbe
