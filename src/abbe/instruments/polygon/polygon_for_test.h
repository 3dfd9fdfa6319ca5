#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/instruments/polygon/polygon_inversion.h"

/// A second route to the readings: rays and planes one by one, as one writes them with Eigen.
namespace abbe::test {

struct PolygonCase {
  Polygon polygon;
  PolygonMount mount;
  PolygonBench bench;
};

inline Eigen::Matrix3d turn_about(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

inline Eigen::Vector3d random_vector(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Everything wrong by a little: angles by `angle` (rad), lengths by `length` (mm).
inline PolygonCase random_polygon(std::size_t faces, double angle, double length, std::uint64_t seed,
                                  PolygonFaceOrder order = PolygonFaceOrder::face) {
  RandomStream random(seed);
  PolygonCase c;
  c.polygon = regular_polygon(faces, 48.3, 17);
  c.polygon.order = order;
  for (PolygonFace& face : c.polygon.faces) {
    face.azimuth_error = random.uniform(-angle, angle);
    face.tilt = random.uniform(-angle, angle);
    face.distance += random.uniform(-length, length);
  }
  c.polygon.top.tilt_x = random.uniform(-angle, angle);
  c.polygon.top.tilt_y = random.uniform(-angle, angle);
  c.mount = {random_vector(random, angle), random_vector(random, length), 0};
  for (PolygonSensor* sensor : {&c.bench.autocollimator_x, &c.bench.autocollimator_y, &c.bench.displacement_x,
                                &c.bench.displacement_y, &c.bench.displacement_z}) {
    sensor->angles = random_vector(random, angle);
    sensor->position += random_vector(random, length);
    sensor->exit = random_vector(random, length);
  }
  return c;
}

inline TableMotion random_motion(RandomStream& random, double angle, double length) {
  TableMotion motion;
  motion.angles = random_vector(random, angle);
  motion.displacement = random_vector(random, length);
  return motion;
}

/// A ray sent out by the sensor, met with the face, reflected, and looked at in the sensor's frame.
inline double traced_ray(PolygonReading reading, const PolygonCase& c, const PolygonPosition& position,
                         const TableMotion& motion) {
  using Eigen::Isometry3d;
  using Eigen::Vector3d;
  const PolygonSensor& sensor = c.bench.sensor(reading);
  const int axis = static_cast<int>(sensor.side);
  Isometry3d world_from_table = Isometry3d::Identity(), table_from_prism = Isometry3d::Identity();
  world_from_table.linear() = turn_about(1, motion.angles.y()) * turn_about(0, motion.angles.x()) *
                              turn_about(2, position.angle + motion.angles.z());
  world_from_table.translation() = motion.displacement;
  table_from_prism.linear() = turn_about(1, c.mount.angles.y()) * turn_about(0, c.mount.angles.x()) *
                              turn_about(2, c.mount.turn + c.mount.angles.z());
  table_from_prism.translation() = c.mount.offset;
  Isometry3d world_from_sensor = Isometry3d::Identity();
  world_from_sensor.linear() =
      turn_about(2, sensor.angles.z()) * turn_about(1, sensor.angles.y()) * turn_about(0, sensor.angles.x());
  world_from_sensor.translation() = sensor.position;

  // The plane in the prism: the frame of the face (CS3), whose own axis is its normal.
  Eigen::Matrix3d prism_from_face = Eigen::Matrix3d::Identity();
  double distance = c.polygon.top.height;
  if (sensor.side == PolygonSide::z) {
    // The mirror's normal is the third row of Ry(eps_yb) Rx(eps_xb), as (15) of the paper has it.
    prism_from_face = (turn_about(1, c.polygon.top.tilt_y) * turn_about(0, c.polygon.top.tilt_x)).transpose();
  } else {
    const bool along_x = sensor.side == PolygonSide::x;
    const PolygonFace& face = c.polygon.faces[along_x ? position.face_x : position.face_y];
    distance = face.distance;
    const double azimuth = face.azimuth + face.azimuth_error - (along_x ? 0 : std::acos(-1.0) / 2);
    const Eigen::Matrix3d tilt = along_x ? turn_about(1, -face.tilt) : turn_about(0, face.tilt);
    const Eigen::Matrix3d turned = turn_about(2, azimuth);
    prism_from_face =
        c.polygon.order == PolygonFaceOrder::face ? Eigen::Matrix3d(turned * tilt) : Eigen::Matrix3d(tilt * turned);
  }
  const Isometry3d world_from_prism = world_from_table * table_from_prism;
  const Vector3d normal = (world_from_prism.linear() * prism_from_face).col(axis);
  const Vector3d on_plane = world_from_prism * Vector3d(distance * prism_from_face.col(axis));

  const Vector3d start = world_from_sensor * sensor.exit;
  const Vector3d beam = -world_from_sensor.linear().col(axis);
  const Vector3d hit = start + beam * (normal.dot(on_plane - start) / normal.dot(beam));
  if (!is_angle(reading)) return (world_from_sensor.inverse() * hit)[axis];
  const Vector3d reflected = world_from_sensor.linear().transpose() * (beam - 2 * normal.dot(beam) * normal);
  switch (reading) {
    case PolygonReading::autocollimator_x_about_z:
      return reflected.y() / reflected.x() / 2;
    case PolygonReading::autocollimator_x_about_y:
      return -reflected.z() / reflected.x() / 2;
    case PolygonReading::autocollimator_y_about_x:
      return reflected.z() / reflected.y() / 2;
    default:
      return -reflected.x() / reflected.y() / 2;
  }
}

}  // namespace abbe::test
