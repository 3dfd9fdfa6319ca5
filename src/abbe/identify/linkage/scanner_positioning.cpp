#include "abbe/identify/linkage/scanner_positioning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/best_fit_transform.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix3 = Eigen::Matrix3d;

Eigen::Matrix3Xd columns(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = points[i];
  return result;
}

/// Adjoint of a rigid motion on (translation, rotation): a small motion in the inner frame, seen in the outer one.
Matrix6 adjoint(const RigidTransform& outer_from_inner) {
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = outer_from_inner.rotation;
  result.bottomRightCorner<3, 3>() = outer_from_inner.rotation;
  result.topRightCorner<3, 3>() = skew(outer_from_inner.translation) * outer_from_inner.rotation;
  return result;
}

struct Line {
  bool ok = false;
  Eigen::Vector3d direction;
  Matrix3 covariance;
};

Line line_through(const std::vector<Eigen::Vector3d>& points, double sigma) {
  Line line;
  if (points.size() < 2) return line;
  FitOptions options;
  options.sigma = sigma;
  const ShapeFit fit = least_squares_fit(ShapeKind::line3, columns(points), options);
  if (!fit.ok()) return line;
  const double sense = fit.shape.direction.dot(points.back() - points.front()) < 0 ? -1 : 1;
  line.ok = true;
  line.direction = sense * fit.shape.direction;
  line.covariance = fit.covariance.block<3, 3>(3, 3);
  return line;
}

/// +1 or -1: sense in which the targets turn about the fitted direction, whatever the heights of their circles; 0:
/// undecided, the steps are half turns.
int turning_sense(const std::vector<std::vector<Eigen::Vector3d>>& circles, const CoaxialCircles& axis) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < circles.size(); ++k) {
    for (std::size_t i = 1; i < circles[k].size(); ++i) {
      const Eigen::Vector3d a = circles[k][i - 1] - axis.centre(k), b = circles[k][i] - axis.centre(k);
      sum += axis.direction.dot(a.cross(b)) / (a.norm() * b.norm());
      ++count;
    }
  }
  if (std::abs(sum) < 1e-3 * static_cast<double>(count)) return 0;
  return sum > 0 ? 1 : -1;
}

ScannerPosition refused(PositioningStatus status, std::string reason) {
  ScannerPosition result;
  result.status = status;
  result.reason = std::move(reason);
  return result;
}

}  // namespace

ScannerPosition locate_scanner(const PositioningScans& scans) {
  const Line x = line_through(scans.along_x, scans.target_noise), y = line_through(scans.along_y, scans.target_noise);
  if (!x.ok || !y.ok) return refused(PositioningStatus::bad_line, "the targets along X or Y determine no line");
  const Eigen::Vector3d normal = x.direction.cross(y.direction);
  if (normal.norm() < 0.5) return refused(PositioningStatus::bad_line, "X and Y are far from square");

  ScannerPosition result;
  std::vector<Eigen::Matrix3Xd> circles;
  for (const std::vector<Eigen::Vector3d>& circle : scans.circles) circles.push_back(columns(circle));
  CoaxialOptions coaxial;
  coaxial.sigma = scans.target_noise;
  result.circles = coaxial_circles_fit(circles, coaxial);
  if (!result.circles.ok()) return refused(PositioningStatus::bad_circles, result.circles.reason);
  const int sense = turning_sense(scans.circles, result.circles);
  if (sense == 0) {
    return refused(PositioningStatus::bad_circles,
                   "the order of the targets does not say in which sense the table turned");
  }
  result.axis_direction = (scans.turned_positively ? sense : -sense) * result.circles.direction;
  FitOptions sphere_options;
  sphere_options.sigma = scans.sphere_noise;
  if (scans.sphere_radius > 0) sphere_options.constraints.radius = scans.sphere_radius;
  const ShapeFit sphere = least_squares_fit(ShapeKind::sphere, columns(scans.sphere), sphere_options);
  if (!sphere.ok()) return refused(PositioningStatus::bad_sphere, sphere.reason);

  result.x_direction = x.direction;
  result.y_direction = y.direction;
  result.squareness = std::acos(std::clamp(x.direction.dot(y.direction), -1.0, 1.0)) - std::numbers::pi / 2;
  // Rows of R are the table's axes in the scanner's frame; sum of target * source'.
  Matrix3 correlation = Matrix3::Zero();
  correlation.row(0) = x.direction.transpose();
  correlation.row(1) = y.direction.transpose();
  correlation.row(2) = normal.normalized().transpose();
  const Matrix3 r = rotation_from_correlation(correlation);
  const Eigen::Vector3d axis_in_table = r * result.axis_direction;
  if (!(axis_in_table.z() > std::cos(kDegree))) {
    return refused(PositioningStatus::inconsistent,
                   "the table's axis is more than a degree from X cross Y, or the table turned the other way");
  }
  result.axis_tilt = {-axis_in_table.y(), axis_in_table.x()};

  const Eigen::Vector3d &p = result.circles.point, &d = result.circles.direction;
  result.sphere_centre = sphere.shape.point;
  const double along = d.dot(result.sphere_centre - p);
  result.on_axis = p + along * d;
  const Eigen::Vector3d foot = r * result.on_axis;
  const Eigen::Vector3d translation =
      Eigen::Vector3d(-foot.x(), -foot.y(), scans.sphere_height - foot.z()) - scans.moved_since;
  result.table_from_scanner = {r, translation};
  result.status = PositioningStatus::ok;

  // Foot of the centre: by point and direction of the axis, and by the centre.
  const Matrix3 across = Matrix3::Identity() - d * d.transpose();
  Eigen::Matrix<double, 3, 6> by_axis;
  by_axis << across, along * Matrix3::Identity() + d * (result.sphere_centre - p).transpose();
  const Matrix3 sphere_covariance = sphere.covariance.topLeftCorner<3, 3>();
  Matrix3 foot_covariance = by_axis * result.circles.covariance.topLeftCorner<6, 6>() * by_axis.transpose() +
                            d * (d.transpose() * sphere_covariance * d) * d.transpose();
  foot_covariance = r * foot_covariance * r.transpose();
  foot_covariance(2, 2) += scans.height_noise * scans.height_noise;
  // Rotation, in the table's axes: half of what X and Y say about Z, what X says about Y and Y about X.
  const Matrix3 cx = r * x.covariance * r.transpose(), cy = r * y.covariance * r.transpose();
  Eigen::Matrix<double, 3, 6> by_lines = Eigen::Matrix<double, 3, 6>::Zero();
  by_lines(0, 5) = -1;
  by_lines(1, 2) = 1;
  by_lines(2, 3) = 0.5;
  by_lines(2, 1) = -0.5;
  Matrix6 lines = Matrix6::Zero();
  lines.topLeftCorner<3, 3>() = cx;
  lines.bottomRightCorner<3, 3>() = cy;
  const Matrix3 rotation = by_lines * lines * by_lines.transpose();
  // A turn acts about the foot of the sphere, which stays where it was measured.
  const Matrix3 turned = skew(foot + translation);
  result.covariance.topLeftCorner<3, 3>() = foot_covariance + turned * rotation * turned.transpose();
  result.covariance.topRightCorner<3, 3>() = turned * rotation;
  result.covariance.bottomLeftCorner<3, 3>() = rotation * turned.transpose();
  result.covariance.bottomRightCorner<3, 3>() = rotation;
  return result;
}

Placement locate_workpiece(const ScannerPosition& scanner, const FineRegistration& scan_on_workpiece) {
  const RigidTransform& workpiece_from_scanner = scan_on_workpiece.mesh_from_scan;
  Placement placement;
  placement.table_from_workpiece = scanner.table_from_scanner * workpiece_from_scanner.inverse();
  // The registration's (rotation about its reference, translation), as (translation, rotation) at the part's origin. An
  // error of part from scan enters table from part with the opposite sign, which a covariance does not see.
  Matrix6 order = Matrix6::Zero();
  order.topRightCorner<3, 3>() = Matrix3::Identity();
  order.topLeftCorner<3, 3>() = skew(scan_on_workpiece.reference);
  order.bottomLeftCorner<3, 3>() = Matrix3::Identity();
  const Matrix6 to_table = adjoint(placement.table_from_workpiece) * order;
  const Matrix6 at_origin = scanner.covariance + to_table * scan_on_workpiece.covariance * to_table.transpose();
  // Translation of the workpiece's origin instead of the table's.
  Matrix6 shift = Matrix6::Identity();
  shift.topRightCorner<3, 3>() = -skew(placement.table_from_workpiece.translation);
  placement.covariance = shift * at_origin * shift.transpose();
  return placement;
}

PositioningParameters positioning_parameters(const Placement& placement, bool table_to_workpiece) {
  PositioningParameters result;
  const RigidTransform d =
      table_to_workpiece ? placement.table_from_workpiece.inverse() : placement.table_from_workpiece;
  result.translation = d.translation;
  result.angles = angles_xyz(d.rotation);
  if (!placement.covariance) return result;
  // By small motions of the workpiece in the table's frame, differences of the exact formulas.
  Matrix6 by_motion;
  constexpr double kStep = 1e-6;
  for (Eigen::Index k = 0; k < 6; ++k) {
    Eigen::Matrix<double, 6, 1> change = Eigen::Matrix<double, 6, 1>::Zero();
    for (const double side : {1.0, -1.0}) {
      Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
      motion[k] = side * kStep;
      const RigidTransform moved = {rotation_from_vector(motion.tail<3>()) * placement.table_from_workpiece.rotation,
                                    placement.table_from_workpiece.translation + Eigen::Vector3d(motion.head<3>())};
      const RigidTransform seen = table_to_workpiece ? moved.inverse() : moved;
      change.head<3>() += side * seen.translation / (2 * kStep);
      change.tail<3>() += side * angles_xyz(seen.rotation) / (2 * kStep);
    }
    by_motion.col(k) = change;
  }
  result.covariance = by_motion * *placement.covariance * by_motion.transpose();
  return result;
}

}  // namespace abbe
