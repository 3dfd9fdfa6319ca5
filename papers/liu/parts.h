#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// A part of Liu et al. as a mesh; its axis is y, the chuck's axis.
struct LiuPart {
  std::string name;
  TriangleMesh mesh;              ///< closed, mm
  std::vector<HalfSpace> wanted;  ///< what of it is scanned: all of them hold
};

/// Standard cylinder, radius 10 mm, 30 mm long, of which the middle 23.5 mm are scanned.
/// @param taper  mm/mm, by how much the radius grows along y, zero in the middle
LiuPart liu_cylinder(double radius, double taper);
/// Two cylinders that cross at right angles, radius 6 and 4 mm, 36 and 28 mm long (the paper gives no dimensions).
LiuPart liu_cross_cylinder();
/// Three square faces of 5 mm that meet at right angles, on a handle whose cross-section is the regular hexagon of
/// their outline, 25 mm long in all. The paper gives no dimensions.
LiuPart liu_pyramid();
/// Sphere of 12.703 mm, of which the cap around +y that is this share of its surface is scanned.
LiuPart liu_sphere(double share);
/// Twisted blade: an elliptic section of 14 mm by 3 mm, turned by 40 degrees over 24 mm.
LiuPart liu_blade();

/// Mesh of the standard cylinder along a direction, for the calibration of the stages.
/// @param axis  unit vector
TriangleMesh cylinder_mesh(double radius, double taper, double length, const Eigen::Vector3d& axis);

}  // namespace abbe
