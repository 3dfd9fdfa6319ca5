#pragma once

#include <Eigen/Core>

namespace abbe {

/// The features of ISO 17450 that are fitted to points. Those of the plane lie in z = 0.
enum class ShapeKind { line2, line3, plane, circle2, circle3, sphere, cylinder, cone };

/// "line2", "line3", "plane", "circle2", "circle3", "sphere", "cylinder", "cone".
const char* shape_name(ShapeKind kind);

/// A geometric feature as plain data, in the frame of its points.
///
/// Members that a kind does not have are zero. What they are:
///
/// | kind     | point                         | direction                        | radius       | half_angle |
/// |----------|-------------------------------|----------------------------------|--------------|------------|
/// | line2    | on the line, z = 0            | along it, z = 0                  |              |            |
/// | line3    | on the line                   | along it                         |              |            |
/// | plane    | on the plane                  | normal                           |              |            |
/// | circle2  | centre, z = 0                 | (0, 0, 1)                        | radius       |            |
/// | circle3  | centre                        | normal of its plane              | radius       |            |
/// | sphere   | centre                        |                                  | radius       |            |
/// | cylinder | on the axis                   | of the axis                      | radius       |            |
/// | cone     | on the axis                   | of the axis, away from the apex  | at the point | > 0        |
///
/// Fits put the point of lines, planes, cylinders and cones beside the centroid of the data, and turn a direction whose
/// sense means nothing so that its largest component is positive.
struct Shape {
  ShapeKind kind = ShapeKind::plane;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();      ///< mm
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit
  double radius = 0;                                    ///< mm
  double half_angle = 0;                                ///< between axis and generator of a cone, rad

  /// Apex of a cone, mm. Meaningless for the others.
  Eigen::Vector3d apex() const;
};

/// Orthogonal distance of a point from the shape, mm.
///
/// Signed for line2 (positive to the left of the direction), plane (along the normal) and the shapes with an inside
/// (positive outside); line3 and circle3 have no side, their distance is positive. A cone is that one of its two halves
/// on which the shape's point lies; a point whose foot would be beyond the apex is measured from the cone's tangent
/// plane there.
double distance(const Shape& shape, const Eigen::Vector3d& point);

}  // namespace abbe
