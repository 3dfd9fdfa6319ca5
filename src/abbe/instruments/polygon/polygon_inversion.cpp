#include "abbe/instruments/polygon/polygon_inversion.h"

#include <cmath>
#include <limits>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using enum PolygonReading;

constexpr PolygonReading kAngles[] = {autocollimator_y_about_x, autocollimator_x_about_y, autocollimator_x_about_z};
constexpr PolygonReading kLengths[] = {displacement_x, displacement_y, displacement_z};
constexpr int kMaximumInversionIterations = 25;
/// Steps below which nobody asks for more, and steps of which rounding, not the model, decides if they do not get
/// smaller any more.
constexpr double kAngleStep = 1e-18, kLengthStep = 1e-14;
constexpr double kAngleRounding = 1e-14, kLengthRounding = 1e-10;

double at(const PolygonReadings& readings, PolygonReading reading) {
  return readings[static_cast<std::size_t>(reading)];
}

struct Known {
  const PolygonReadings& readings;
  const Polygon& polygon;
  const PolygonMount& mount;
  const PolygonBench& bench;
  const PolygonPosition& position;

  double residual(PolygonReading reading, const TableMotion& motion, PolygonGradient& gradient) const {
    return at(readings, reading) - polygon_reading(reading, polygon, mount, bench, position, motion, &gradient);
  }
};

/// Newton's steps get smaller until rounding makes them; says when that is reached.
class Convergence {
 public:
  bool reached(double angle_step, double length_step) {
    const bool nothing_left = angle_step <= kAngleStep && length_step <= kLengthStep;
    const bool rounding = angle_step < kAngleRounding && length_step < kLengthRounding &&
                          angle_step >= 0.5 * last_angle_ && length_step >= 0.5 * last_length_;
    last_angle_ = angle_step;
    last_length_ = length_step;
    return nothing_left || rounding;
  }

 private:
  double last_angle_ = std::numeric_limits<double>::infinity(), last_length_ = last_angle_;
};

bool finite(const PolygonReadings& readings) {
  for (const PolygonReading reading : kAngles)
    if (!std::isfinite(at(readings, reading))) return false;
  for (const PolygonReading reading : kLengths)
    if (!std::isfinite(at(readings, reading))) return false;
  return true;
}

/// The displacements that, with the angles known, put every plane where its sensor hit it: linear equations.
bool displacements(const Known& known, TableMotion& motion) {
  Matrix3d normals;
  Vector3d missing;
  for (int i = 0; i < 3; ++i) {
    const PolygonSensor& sensor = known.bench.sensor(kLengths[i]);
    const std::size_t face = sensor.side == PolygonSide::y ? known.position.face_y : known.position.face_x;
    const ReflectingPlane plane = plane_in_world(
        plane_before_motion(plane_in_prism(known.polygon, sensor.side, face), known.mount, known.position.angle),
        {motion.angles, Vector3d::Zero()});
    const Matrix3d rotation = rotation_from_error_angles(sensor.angles);
    Vector3d hit_in_sensor = sensor.exit;
    hit_in_sensor[i] = at(known.readings, kLengths[i]);
    normals.row(i) = plane.normal.transpose();
    missing[i] = plane.normal.dot(sensor.position + rotation * hit_in_sensor) - plane.offset;
  }
  const FullLu<3> solver(normals);
  if (!(solver.reciprocal_condition() > 1e-12)) return false;
  motion.displacement = solver.solve(missing);
  return true;
}

PolygonInversionStatus find_stepwise(const Known& known, PolygonInversion& result) {
  Convergence convergence;
  for (result.iterations = 1; result.iterations <= kMaximumInversionIterations; ++result.iterations) {
    Matrix3d slopes;
    Vector3d residual;
    for (int i = 0; i < 3; ++i) {
      PolygonGradient gradient;
      residual[i] = known.residual(kAngles[i], result.motion, gradient);
      slopes.row(i) = gradient.segment<3>(polygon_column::motion).transpose();
    }
    const FullLu<3> solver(slopes);
    if (!residual.allFinite()) return PolygonInversionStatus::not_converged;
    if (!(solver.reciprocal_condition() > 1e-9)) return PolygonInversionStatus::singular;
    const Vector3d step = solver.solve(residual);
    result.motion.angles += step;
    if (convergence.reached(step.norm(), 0)) {
      return displacements(known, result.motion) ? PolygonInversionStatus::converged : PolygonInversionStatus::singular;
    }
  }
  return PolygonInversionStatus::not_converged;
}

PolygonInversionStatus find_simultaneously(const Known& known, PolygonInversion& result) {
  Convergence convergence;
  for (result.iterations = 1; result.iterations <= kMaximumInversionIterations; ++result.iterations) {
    Eigen::Matrix<double, 6, 6> slopes;
    Eigen::Matrix<double, 6, 1> residual;
    for (int i = 0; i < 6; ++i) {
      PolygonGradient gradient;
      residual[i] = known.residual(i < 3 ? kAngles[i] : kLengths[i - 3], result.motion, gradient);
      slopes.row(i) = gradient.segment<6>(polygon_column::motion).transpose();
    }
    if (!residual.allFinite()) return PolygonInversionStatus::not_converged;
    const FullLu<6> solver(slopes);
    if (!(solver.reciprocal_condition() > 1e-9)) return PolygonInversionStatus::singular;
    const Eigen::Matrix<double, 6, 1> step = solver.solve(residual);
    result.motion.angles += step.head<3>();
    result.motion.displacement += step.tail<3>();
    if (convergence.reached(step.head<3>().norm(), step.tail<3>().norm())) return PolygonInversionStatus::converged;
  }
  return PolygonInversionStatus::not_converged;
}

}  // namespace

PolygonReadings polygon_readings(const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench,
                                 const PolygonPosition& position, const TableMotion& motion) {
  PolygonReadings readings{};
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    readings[i] = polygon_reading(static_cast<PolygonReading>(i), polygon, mount, bench, position, motion);
  }
  return readings;
}

PolygonInversion invert_polygon_readings(const PolygonReadings& readings, const Polygon& polygon,
                                         const PolygonMount& mount, const PolygonBench& bench,
                                         const PolygonPosition& position, PolygonInversionOrder order) {
  PolygonInversion result;
  const Known known{readings, polygon, mount, bench, position};
  if (!finite(readings)) {
    result.status = PolygonInversionStatus::not_converged;
    return result;
  }
  result.status =
      order == PolygonInversionOrder::stepwise ? find_stepwise(known, result) : find_simultaneously(known, result);
  PolygonGradient gradient;
  result.redundant_residual = known.residual(autocollimator_y_about_z, result.motion, gradient);
  return result;
}

TableMotion first_order_motion(PolygonFormula formula, const PolygonReadings& now, const PolygonReadings& start,
                               const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench,
                               const PolygonPosition& position, const PolygonPosition& start_position) {
  const double s = std::sin(position.angle), c = std::cos(position.angle);
  const PolygonFace &x1 = polygon.faces[position.face_x], &x0 = polygon.faces[start_position.face_x];
  const PolygonFace &y1 = polygon.faces[position.face_y], &y0 = polygon.faces[start_position.face_y];
  // The face's own tilt is a constant of the glass; the paper's order makes it turn with the table.
  const bool constant = formula == PolygonFormula::corrected && polygon.order == PolygonFaceOrder::face;
  const double turning = constant ? 1 : c;
  const double eps_py = -x1.tilt * turning, eps_py0 = -x0.tilt;
  const double eps_px = y1.tilt * turning, eps_px0 = y0.tilt;
  const double eps_xbc = mount.angles.x(), eps_ybc = mount.angles.y();
  const double delta_xbc = mount.offset.x(), delta_ybc = mount.offset.y();
  const Vector3d k = bench.displacement_x.position + bench.displacement_x.exit;
  const Vector3d u = bench.displacement_y.position + bench.displacement_y.exit;
  const Vector3d v = bench.displacement_z.position + bench.displacement_z.exit;
  const Vector3d v8 = bench.displacement_z.exit;
  const auto change = [&](PolygonReading reading) { return at(now, reading) - at(start, reading); };
  const double sign = formula == PolygonFormula::printed ? 1 : -1;  // of what is wrong in print

  TableMotion motion;
  const double turned_x = -x1.azimuth_error + x0.azimuth_error;  // eps_pz - eps_pz(0)
  const double turned_y = -y1.azimuth_error + y0.azimuth_error;
  const double eps_z = change(autocollimator_x_about_z) + turned_x;                                            // (9)
  const double eps_y = change(autocollimator_x_about_y) - eps_py + eps_py0 - eps_xbc * s - eps_ybc * (c - 1);  // (10)
  const double tilt_x = -eps_px + eps_px0 - eps_xbc * (c - 1);
  const double eps_x = change(autocollimator_y_about_x) + tilt_x - sign * eps_ybc * s;  // (11)
  motion.angles << eps_x, eps_y, eps_z;

  const double radial_x = change(displacement_x) - c * (delta_xbc + k.z() * eps_ybc) - k.z() * eps_py;
  motion.displacement.x() = radial_x + s * (delta_ybc - k.z() * eps_xbc) + delta_xbc + k.z() * (eps_py0 + eps_ybc) +
                            k.y() * (eps_z - turned_x) - k.z() * eps_y;  // (12)
  const double tilted = eps_px + eps_x + sign * eps_ybc * s + eps_xbc * c - eps_px0 - eps_xbc;
  motion.displacement.y() = change(displacement_y) + delta_ybc * (1 - c) + sign * delta_xbc * s -
                            u.x() * (eps_z - turned_y) + u.z() * tilted;  // (13)
  const double tip_x = polygon.top.tilt_x - eps_xbc, tip_y = polygon.top.tilt_y - eps_ybc;
  const double lever_x = formula == PolygonFormula::printed ? v.x() - 2 * v8.x() : v.x();
  motion.displacement.z() = change(displacement_z) - v.y() * eps_x + v.x() * eps_y -
                            (c - 1) * (v.x() * tip_y - v.y() * tip_x) - s * (lever_x * tip_x + v.y() * tip_y);  // (18)
  return motion;
}

}  // namespace abbe
