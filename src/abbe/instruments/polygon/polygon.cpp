#include "abbe/instruments/polygon/polygon.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d about(int axis, double angle) { return rotation_about(Vector3d::Unit(axis), angle); }

/// Ry(y) Rx(x) Rz(z), the order of the paper's (1) and (2).
Matrix3d tilted_turn(double x, double y, double z) { return about(1, y) * about(0, x) * about(2, z); }

int axis_of(PolygonSide side) { return static_cast<int>(side); }

struct NamedSensor {
  const char* name;
  PolygonSensor PolygonBench::*sensor;
};
constexpr NamedSensor kSensors[] = {{"autocollimator along x", &PolygonBench::autocollimator_x},
                                    {"autocollimator along y", &PolygonBench::autocollimator_y},
                                    {"displacement sensor along x", &PolygonBench::displacement_x},
                                    {"displacement sensor along y", &PolygonBench::displacement_y},
                                    {"displacement sensor along z", &PolygonBench::displacement_z}};

Matrix3d sensor_rotation(const PolygonSensor& sensor) { return rotation_from_error_angles(sensor.angles); }

constexpr const char* kReadingNames[] = {"autocollimator_x_about_z",
                                         "autocollimator_x_about_y",
                                         "autocollimator_y_about_x",
                                         "autocollimator_y_about_z",
                                         "displacement_x",
                                         "displacement_y",
                                         "displacement_z"};

}  // namespace

const char* reading_name(PolygonReading reading) { return kReadingNames[static_cast<std::size_t>(reading)]; }

double Polygon::half_face_width() const {
  return faces.empty() ? 0 : faces.front().distance * std::tan(std::numbers::pi / static_cast<double>(faces.size()));
}

Polygon regular_polygon(std::size_t faces, double distance, double height) {
  if (faces < 3 || !(distance > 0) || !(height > 0)) {
    throw std::invalid_argument(
        fmt::format("polygon of {} faces, distance {} mm, height {} mm: expected at least 3 faces and positive lengths",
                    faces, distance, height));
  }
  Polygon polygon;
  for (std::size_t j = 0; j < faces; ++j) {
    polygon.faces.push_back({-kTurn * static_cast<double>(j) / static_cast<double>(faces), 0, 0, distance});
  }
  polygon.top.height = height;
  return polygon;
}

PolygonBench::PolygonBench() {
  autocollimator_y.side = displacement_y.side = PolygonSide::y;
  displacement_z.side = PolygonSide::z;
  autocollimator_x.position = displacement_x.position = {100, 0, 8.5};
  autocollimator_y.position = displacement_y.position = {0, 100, 8.5};
  displacement_z.position = {0, 0, 100};
}

const PolygonSensor& PolygonBench::sensor(PolygonReading reading) const {
  switch (reading) {
    case PolygonReading::autocollimator_x_about_z:
    case PolygonReading::autocollimator_x_about_y:
      return autocollimator_x;
    case PolygonReading::autocollimator_y_about_x:
    case PolygonReading::autocollimator_y_about_z:
      return autocollimator_y;
    case PolygonReading::displacement_x:
      return displacement_x;
    case PolygonReading::displacement_y:
      return displacement_y;
    case PolygonReading::displacement_z:
      break;
  }
  return displacement_z;
}

PolygonSensor& PolygonBench::sensor(PolygonReading reading) {
  return const_cast<PolygonSensor&>(static_cast<const PolygonBench&>(*this).sensor(reading));
}

void validate(const Polygon& polygon, const PolygonBench& bench) {
  if (polygon.faces.size() < 3) {
    throw std::invalid_argument(fmt::format("polygon: {} faces, expected at least 3", polygon.faces.size()));
  }
  for (std::size_t j = 0; j < polygon.faces.size(); ++j) {
    const PolygonFace& face = polygon.faces[j];
    if (!std::isfinite(face.azimuth + face.azimuth_error + face.tilt) || !(face.distance > 0)) {
      throw std::invalid_argument(
          fmt::format("polygon face {}: expected finite angles and a positive distance in mm", j + 1));
    }
  }
  const double half_width = polygon.half_face_width();
  const PolygonSide sides[] = {PolygonSide::x, PolygonSide::y, PolygonSide::x, PolygonSide::y, PolygonSide::z};
  for (std::size_t i = 0; i < std::size(kSensors); ++i) {
    const PolygonSensor& sensor = bench.*kSensors[i].sensor;
    const Vector3d start = sensor.position + sensor.exit;
    if (!start.allFinite() || !sensor.angles.allFinite() || sensor.side != sides[i]) {
      throw std::invalid_argument(
          fmt::format("{}: expected finite position (mm) and angles (rad) and its own side", kSensors[i].name));
    }
    if (sensor.side == PolygonSide::z) {
      if (start.head<2>().norm() > polygon.faces.front().distance) {
        throw std::invalid_argument(fmt::format("{}: beam {:.3f} mm from the axis, the mirror ends at {:.3f} mm",
                                                kSensors[i].name, start.head<2>().norm(),
                                                polygon.faces.front().distance));
      }
      continue;
    }
    const double aside = start[1 - axis_of(sensor.side)];
    if (std::abs(aside) > half_width) {
      throw std::invalid_argument(fmt::format("{}: beam {:.3f} mm aside, the face ends at {:.3f} mm", kSensors[i].name,
                                              std::abs(aside), half_width));
    }
    if (start.z() < 0 || start.z() > polygon.top.height) {
      throw std::invalid_argument(fmt::format("{}: beam at height {:.3f} mm, expected 0 to {:.3f} mm", kSensors[i].name,
                                              start.z(), polygon.top.height));
    }
  }
}

PolygonPosition regular_position(std::size_t faces, std::size_t step, std::size_t shift) {
  if (faces == 0 || faces % 4 != 0) {
    throw std::invalid_argument(fmt::format(
        "polygon of {} faces: sensors along x and y at once need a number of faces divisible by four", faces));
  }
  PolygonPosition position;
  position.angle = kTurn * static_cast<double>(step) / static_cast<double>(faces);
  position.face_x = (step + shift) % faces;
  position.face_y = (step + shift + faces - faces / 4) % faces;
  return position;
}

ReflectingPlane plane_in_prism(const Polygon& polygon, PolygonSide side, std::size_t face,
                               Eigen::Matrix<double, 4, 3>* slopes) {
  if (side == PolygonSide::z) {
    const double sx = std::sin(polygon.top.tilt_x), cx = std::cos(polygon.top.tilt_x);
    const double sy = std::sin(polygon.top.tilt_y), cy = std::cos(polygon.top.tilt_y);
    if (slopes) {
      slopes->setZero();
      slopes->col(0) << 0, cy * cx, -cy * sx, 0;
      slopes->col(1) << -cy, -sy * sx, -sy * cx, 0;
      (*slopes)(3, 2) = 1;
    }
    return {{-sy, cy * sx, cy * cx}, polygon.top.height};
  }
  const PolygonFace& f = polygon.faces[face];
  // Nominal azimuth and its error apart: the sum of a turn and a second of arc would lose the error's last digits.
  const double c0 = std::cos(f.azimuth), s0 = std::sin(f.azimuth);
  const double ce = std::cos(f.azimuth_error), se = std::sin(f.azimuth_error);
  const double c = c0 * ce - s0 * se, s = s0 * ce + c0 * se;
  const double ct = std::cos(f.tilt), st = std::sin(f.tilt);
  ReflectingPlane plane;
  plane.offset = f.distance;
  Eigen::Vector3d by_azimuth, by_tilt;
  if (polygon.order == PolygonFaceOrder::face) {
    plane.normal << c * ct, s * ct, st;
    by_azimuth << -s * ct, c * ct, 0;
    by_tilt << -c * st, -s * st, ct;
  } else if (side == PolygonSide::x) {
    plane.normal << c * ct, s, c * st;
    by_azimuth << -s * ct, c, -s * st;
    by_tilt << -c * st, 0, c * ct;
  } else {
    plane.normal << c, s * ct, s * st;
    by_azimuth << -s, c * ct, c * st;
    by_tilt << 0, -s * st, s * ct;
  }
  if (slopes) {
    slopes->setZero();
    slopes->col(0).head<3>() = by_azimuth;
    slopes->col(1).head<3>() = by_tilt;
    (*slopes)(3, 2) = 1;
  }
  return plane;
}

ReflectingPlane plane_before_motion(const ReflectingPlane& in_prism, const PolygonMount& mount, double angle) {
  // The commanded angle and the mount's nominal turn cancel the face's azimuth before anything small is added.
  const Matrix3d turned = about(2, angle);
  const Matrix3d small = turned * about(1, mount.angles.y()) * about(0, mount.angles.x()) * turned.transpose();
  const Vector3d nominal = about(2, angle + mount.turn) * (about(2, mount.angles.z()) * in_prism.normal);
  ReflectingPlane plane;
  plane.normal = small * nominal;
  plane.offset = in_prism.offset + plane.normal.dot(turned * mount.offset);
  return plane;
}

ReflectingPlane plane_in_world(const ReflectingPlane& before_motion, const TableMotion& motion) {
  ReflectingPlane plane;
  plane.normal = tilted_turn(motion.angles.x(), motion.angles.y(), motion.angles.z()) * before_motion.normal;
  plane.offset = before_motion.offset + plane.normal.dot(motion.displacement);
  return plane;
}

double read_plane(PolygonReading reading, const PolygonSensor& sensor, const ReflectingPlane& plane) {
  const Matrix3d world_from_sensor = sensor_rotation(sensor);
  if (is_angle(reading)) {
    // The reflected ray d - 2 (d.n) n for d against the sensor's axis; its slope, halved, is tan(2 omega)/2.
    const Vector3d n = world_from_sensor.transpose() * plane.normal;
    const PolygonAcross a = across_of(reading);
    const int along = axis_of(sensor.side);
    const double returned = 2 * n[along] * n[along] - 1;
    if (!(returned > 0)) return std::numeric_limits<double>::quiet_NaN();
    return a.sign * n[along] * n[a.axis] / returned;
  }
  const int axis = axis_of(sensor.side);
  const Vector3d start = sensor.position + world_from_sensor * sensor.exit;
  const double cosine = plane.normal.dot(world_from_sensor.col(axis));
  if (!(cosine > 0)) return std::numeric_limits<double>::quiet_NaN();
  return sensor.exit[axis] + (plane.offset - plane.normal.dot(start)) / cosine;
}

namespace {

/// Derivatives of a reading by the plane (normal, offset) and by the sensor's nine numbers.
void differentiate_sensor(PolygonReading reading, const PolygonSensor& sensor, const ReflectingPlane& plane,
                          Eigen::Matrix<double, 1, 4>& by_plane, PolygonGradient& gradient) {
  using namespace polygon_column;
  const Matrix3d r = sensor_rotation(sensor);
  const Matrix3d axes = error_angle_axes(sensor.angles);
  if (is_angle(reading)) {
    const PolygonAcross a = across_of(reading);
    const int along = axis_of(sensor.side);
    const Vector3d n = r.transpose() * plane.normal;
    const double p = n[along], q = n[a.axis], d = 2 * p * p - 1;
    Vector3d by_n = Vector3d::Zero();
    by_n[along] = a.sign * q * (-2 * p * p - 1) / (d * d);
    by_n[a.axis] = a.sign * p / d;
    const Vector3d force = r * by_n;
    by_plane << force.transpose(), 0;
    // Turning the sensor by w turns the normal by -w as the sensor sees it.
    for (int i = 0; i < 3; ++i) gradient[sensor_angles + i] = -force.dot(axes.col(i).cross(plane.normal));
    return;
  }
  const int axis = axis_of(sensor.side);
  const Vector3d arm = r * sensor.exit, beam = r.col(axis);
  const Vector3d start = sensor.position + arm;
  const double cosine = plane.normal.dot(beam);
  const double range = (plane.offset - plane.normal.dot(start)) / cosine;
  const Vector3d hit = start + range * beam;
  by_plane << -hit.transpose() / cosine, 1 / cosine;
  for (int i = 0; i < 3; ++i) {
    gradient[position + i] = -plane.normal[i] / cosine;
    gradient[exit + i] = (i == axis ? 1.0 : 0.0) - plane.normal.dot(r.col(i)) / cosine;
    gradient[sensor_angles + i] = -plane.normal.dot(axes.col(i).cross(hit - sensor.position)) / cosine;
  }
}

}  // namespace

double polygon_reading(PolygonReading reading, const Polygon& polygon, const PolygonMount& mount,
                       const PolygonBench& bench, const PolygonPosition& position, const TableMotion& motion,
                       PolygonGradient* gradient) {
  const PolygonSensor& sensor = bench.sensor(reading);
  const std::size_t face = sensor.side == PolygonSide::y ? position.face_y : position.face_x;
  Eigen::Matrix<double, 4, 3> slopes;
  const ReflectingPlane in_prism = plane_in_prism(polygon, sensor.side, face, gradient ? &slopes : nullptr);
  const ReflectingPlane before = plane_before_motion(in_prism, mount, position.angle);
  const ReflectingPlane plane = plane_in_world(before, motion);
  if (!gradient) return read_plane(reading, sensor, plane);

  using namespace polygon_column;
  gradient->setZero();
  Eigen::Matrix<double, 1, 4> by_plane;
  differentiate_sensor(reading, sensor, plane, by_plane, *gradient);
  const Vector3d force = by_plane.head<3>();
  // A turn w about the point c takes the plane along: d(normal) = w x normal, d(offset) = d(normal) . c.
  const auto by_turn = [&](const Vector3d& w, const Vector3d& c) {
    const Vector3d change = w.cross(plane.normal);
    return force.dot(change) + by_plane[3] * change.dot(c);
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Matrix3d about_y = about(1, motion.angles.y());
  const Matrix3d about_yx = about_y * about(0, motion.angles.x());
  const Vector3d motion_axes[] = {about_y * x, y, about_yx * z};
  const Matrix3d table = about_yx * about(2, motion.angles.z()) * about(2, position.angle);
  const Matrix3d tilt_y = about(1, mount.angles.y());
  const Vector3d mount_axes[] = {table * (tilt_y * x), table * y, table * (tilt_y * about(0, mount.angles.x()) * z)};
  const Vector3d table_origin = motion.displacement, prism_origin = table_origin + table * mount.offset;
  for (int i = 0; i < 3; ++i) {
    (*gradient)[polygon_column::motion + i] = by_turn(motion_axes[i], table_origin);
    (*gradient)[polygon_column::motion + 3 + i] = by_plane[3] * plane.normal[i];
    (*gradient)[polygon_column::mount + i] = by_turn(mount_axes[i], prism_origin);
    (*gradient)[polygon_column::mount + 3 + i] = by_plane[3] * plane.normal.dot(table.col(i));
  }
  const Matrix3d prism = table * tilt_y * about(0, mount.angles.x()) * about(2, mount.turn + mount.angles.z());
  for (int i = 0; i < 3; ++i) {
    const Vector3d change = prism * slopes.col(i).head<3>();
    (*gradient)[polygon_column::face + i] = force.dot(change) + by_plane[3] * (change.dot(prism_origin) + slopes(3, i));
  }
  return read_plane(reading, sensor, plane);
}

}  // namespace abbe
