#pragma once

#include <vector>

#include "abbe/geometry/fits/shape_refine.h"

/// Inside of the fits: where to begin, without a guess from anyone.
namespace abbe::fits {

/// Circle (rows = 2) or sphere (3) by Taubin's algebraic fit. @return false for points on a line or plane
///
/// Source: G. Taubin, IEEE PAMI 13 (1991) 1115; N. Chernov, Circular and Linear Regression (2010), 5.9.
bool algebraic_sphere(const Eigen::MatrixXd& points, Eigen::VectorXd& centre, double& radius);

/// Directions spread evenly over half a sphere.
std::vector<Eigen::Vector3d> half_sphere(std::size_t count);

/// Frames with centre zero from points about zero, for every direction that could be the axis.
///
/// Lines and planes: principal directions. Circles and spheres: algebraic fits. Cylinder and cone: 400 directions over
/// half a sphere and those of the principal curvatures of a paraboloid (short arcs, small patches), for each the best
/// algebraic circle or cone; the best dozen that differ.
std::vector<ShapeFrame> start_frames(ShapeKind kind, const Survey& survey, const FitConstraints& constraints);

/// The frame with the fewest squares to which a start leads, on the survey's sample (lines and planes: of all points).
/// `rival`: another one fits as well.
struct BestStart {
  bool found = false;
  bool rival = false;
  ShapeFrame frame;
};
BestStart best_start(ShapeKind kind, const Survey& survey, const FitConstraints& constraints);

/// Farther apart than `length` (mm; points beside the centroid, radii) or `angle` (rad; directions as lines, half
/// angles). Both with the same centre. @param centroid  from it, mm
bool apart(ShapeFrame a, ShapeFrame b, const Eigen::Vector3d& centroid, double length, double angle);
/// Different answers, not the same one twice. Both with the same centre.
bool differ(const ShapeFrame& a, const ShapeFrame& b, const Survey& survey);

/// A cone or cylinder with that axis direction; false if there is none.
bool frame_along(ShapeKind kind, const Eigen::Matrix3d& axes, const Eigen::Matrix3Xd& points,
                 const FitConstraints& constraints, ShapeFrame& frame);

}  // namespace abbe::fits
