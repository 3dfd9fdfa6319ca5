#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/geometry/fits/shape_fit.h"

/// Inside of the fits: a shape in a frame that moves with it, in which its distances and their derivatives are short.
namespace abbe::fits {

/// Steps of a shape in its own frame: shifts along e1, e2, e3 (mm), tilts about e1, e2 (rad), radius, half angle.
enum Parameter { kShift1, kShift2, kShift3, kTilt1, kTilt2, kRadius, kHalfAngle };
inline constexpr int kParameters = 7;
using Step = Eigen::Matrix<double, kParameters, 1>;

/// Shape with a frame: e3 is the direction (line2: the normal to its left, e1 the line), `origin` its point.
struct ShapeFrame {
  ShapeKind kind = ShapeKind::plane;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< of the data; coordinates are taken from here, mm
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns e1, e2, e3
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< from `centre`, mm
  double radius = 0, half_angle = 0;
};

/// Any right-handed frame with that e3 (need not be a unit vector).
Eigen::Matrix3d axes_along(const Eigen::Vector3d& direction);
/// Frame of a line in the plane with that direction.
Eigen::Matrix3d axes_of_line2(const Eigen::Vector3d& direction);

/// The frame after a step; its axes stay orthonormal.
ShapeFrame moved(const ShapeFrame& frame, const Step& step);

/// The shape as plain data, its point beside the centroid and its direction with the sense of shapes.h. @param centroid
/// from `centre`
Shape shape_of(ShapeFrame frame, const Eigen::Vector3d& centroid);
/// Moves the origin along the axis (lines, cylinder, cone) or within the plane to beside the centroid.
void settle(ShapeFrame& frame, const Eigen::Vector3d& centroid);

/// The steps that change a shape of this kind, those the constraints hold left out.
std::vector<int> free_parameters(ShapeKind kind, const FitConstraints& constraints);
/// How many residuals a point has: 2 for line3 and circle3, else 1.
inline int rows_per_point(ShapeKind kind) { return kind == ShapeKind::line3 || kind == ShapeKind::circle3 ? 2 : 1; }
inline bool has_radius(ShapeKind kind) { return kind >= ShapeKind::circle2; }
inline bool is_straight(ShapeKind kind) { return kind <= ShapeKind::plane; }
inline bool has_direction(ShapeKind kind) { return kind != ShapeKind::circle2 && kind != ShapeKind::sphere; }

/// Distance of one point and its slopes by the steps. For line3 and circle3 the (not negative) distance.
struct PointSlopes {
  double distance = 0;
  Step slope = Step::Zero();
};
PointSlopes point_slopes(const ShapeFrame& frame, const Eigen::Vector3d& point);
/// The two residuals of a point of line3 or circle3, whose length is its distance.
std::array<PointSlopes, 2> point_components(const ShapeFrame& frame, const Eigen::Vector3d& point);

/// Covariance of (point, direction, radius, half angle) from that of the free steps.
Eigen::Matrix<double, 8, 8> shape_covariance(const ShapeFrame& frame, const std::vector<int>& free,
                                             const Eigen::MatrixXd& covariance);

}  // namespace abbe::fits
