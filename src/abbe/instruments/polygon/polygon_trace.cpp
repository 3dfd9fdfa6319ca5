#include "abbe/instruments/polygon/polygon_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

/// Below this the short series of sine and cosine are exact to rounding (x^7/5040 < 3e-18 x).
constexpr double kSmall = 1.0 / 256;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

/// One block of positions: the table's rotation, and a plane turned by it.
struct PolygonTrace::Block {
  double turn_sine[kBlock], turn_cosine[kBlock];
  double x_sine[kBlock], x_cosine[kBlock], y_sine[kBlock], y_cosine[kBlock];
  double plane[4][kBlock];   ///< normal and offset in the table frame
  double normal[3][kBlock];  ///< in the world
  double offset[kBlock];

  void sines(const double* angle, std::size_t count, double* sine, double* cosine) {
    if (!angle) {
      std::fill_n(sine, count, 0.0);
      std::fill_n(cosine, count, 1.0);
      return;
    }
    bool all_small = true;
    for (std::size_t k = 0; k < count; ++k) {
      const double a = angle[k], square = a * a;
      sine[k] = a * (1 - square * (1.0 / 6) * (1 - square * (1.0 / 20)));
      cosine[k] = 1 - square * 0.5 * (1 - square * (1.0 / 12) * (1 - square * (1.0 / 30)));
      all_small &= std::abs(a) < kSmall;
    }
    for (std::size_t k = 0; !all_small && k < count; ++k) {
      if (std::abs(angle[k]) < kSmall) continue;
      sine[k] = std::sin(angle[k]);
      cosine[k] = std::cos(angle[k]);
    }
  }

  /// Takes the planes that `index` (null: always the first) names through the table's motion.
  void turn(const PolygonPositions& positions, std::size_t first, std::size_t count, const Plane* planes,
            const std::uint16_t* index) {
    for (std::size_t k = 0; k < count; ++k) {
      const Plane& p = planes[index ? index[first + k] : 0];
      plane[0][k] = p.normal[0];
      plane[1][k] = p.normal[1];
      plane[2][k] = p.normal[2];
      plane[3][k] = p.offset;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const double a = turn_cosine[k] * plane[0][k] - turn_sine[k] * plane[1][k];
      const double b = turn_sine[k] * plane[0][k] + turn_cosine[k] * plane[1][k];
      const double up = x_sine[k] * b + x_cosine[k] * plane[2][k];
      normal[0][k] = y_cosine[k] * a + y_sine[k] * up;
      normal[1][k] = x_cosine[k] * b - x_sine[k] * plane[2][k];
      normal[2][k] = y_cosine[k] * up - y_sine[k] * a;
      offset[k] = plane[3][k];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double* displacement = positions.motion[3 + axis];
      if (!displacement) continue;
      for (std::size_t k = 0; k < count; ++k) offset[k] += normal[axis][k] * displacement[first + k];
    }
  }

  void autocollimator(const Sensor& sensor, std::size_t along, std::size_t across, double sign, std::size_t count,
                      double* to) const {
    if (!to) return;
    const double* u = sensor.axes[along];
    const double* v = sensor.axes[across];
    for (std::size_t k = 0; k < count; ++k) {
      const double p = u[0] * normal[0][k] + u[1] * normal[1][k] + u[2] * normal[2][k];
      const double q = v[0] * normal[0][k] + v[1] * normal[1][k] + v[2] * normal[2][k];
      const double returned = 2 * p * p - 1;
      const double slope = sign * p * q / returned;
      to[k] = returned > 0 ? slope : kNothing;
    }
  }

  void displacement(const Sensor& sensor, std::size_t along, std::size_t count, double* to) const {
    if (!to) return;
    const double* u = sensor.axes[along];
    const double* o = sensor.start;
    for (std::size_t k = 0; k < count; ++k) {
      const double cosine = u[0] * normal[0][k] + u[1] * normal[1][k] + u[2] * normal[2][k];
      const double short_of = offset[k] - (o[0] * normal[0][k] + o[1] * normal[1][k] + o[2] * normal[2][k]);
      const double range = sensor.origin + short_of / cosine;
      to[k] = cosine > 0 ? range : kNothing;
    }
  }
};

PolygonTrace::PolygonTrace(const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench) {
  validate(polygon, bench);
  const auto compiled = [&](PolygonSide side, std::size_t face) {
    const ReflectingPlane plane = plane_before_motion(plane_in_prism(polygon, side, face), mount, 0);
    return Plane{{plane.normal.x(), plane.normal.y(), plane.normal.z()}, plane.offset};
  };
  for (std::size_t j = 0; j < polygon.faces.size(); ++j) {
    faces_x_.push_back(compiled(PolygonSide::x, j));
    faces_y_.push_back(compiled(PolygonSide::y, j));
  }
  top_ = compiled(PolygonSide::z, 0);
  const PolygonSensor* sensors[] = {&bench.autocollimator_x, &bench.autocollimator_y, &bench.displacement_x,
                                    &bench.displacement_y, &bench.displacement_z};
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Eigen::Matrix3d rotation = rotation_from_error_angles(sensors[i]->angles);
    const Eigen::Vector3d start = sensors[i]->position + rotation * sensors[i]->exit;
    for (int axis = 0; axis < 3; ++axis) {
      sensors_[i].start[axis] = start[axis];
      for (int c = 0; c < 3; ++c) sensors_[i].axes[axis][c] = rotation(c, axis);
    }
    sensors_[i].origin = sensors[i]->exit[static_cast<int>(sensors[i]->side)];
  }
}

void PolygonTrace::trace(const PolygonPositions& positions, const PolygonTraces& traces) const {
  for (std::size_t first = 0; first < positions.count; first += kBlock) {
    trace_block(positions, first, std::min(kBlock, positions.count - first), traces);
  }
}

void PolygonTrace::trace_block(const PolygonPositions& positions, std::size_t first, std::size_t count,
                               const PolygonTraces& traces) const {
  Block block;
  const double* angle[3];
  for (std::size_t i = 0; i < 3; ++i) angle[i] = positions.motion[i] ? positions.motion[i] + first : nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = positions.angle[first + k] + (angle[2] ? angle[2][k] : 0);
    block.turn_sine[k] = std::sin(turn);
    block.turn_cosine[k] = std::cos(turn);
  }
  block.sines(angle[0], count, block.x_sine, block.x_cosine);
  block.sines(angle[1], count, block.y_sine, block.y_cosine);
  PolygonTraces to = traces;
  for (double*& pointer : to) pointer = pointer ? pointer + first : nullptr;
  const auto wanted = [&](PolygonReading reading) { return to[static_cast<std::size_t>(reading)]; };
  using enum PolygonReading;
  if (wanted(autocollimator_x_about_z) || wanted(autocollimator_x_about_y) || wanted(displacement_x)) {
    block.turn(positions, first, count, faces_x_.data(), positions.face_x);
    block.autocollimator(sensors_[0], 0, 1, 1, count, wanted(autocollimator_x_about_z));
    block.autocollimator(sensors_[0], 0, 2, -1, count, wanted(autocollimator_x_about_y));
    block.displacement(sensors_[2], 0, count, wanted(displacement_x));
  }
  if (wanted(autocollimator_y_about_x) || wanted(autocollimator_y_about_z) || wanted(displacement_y)) {
    block.turn(positions, first, count, faces_y_.data(), positions.face_y);
    block.autocollimator(sensors_[1], 1, 2, 1, count, wanted(autocollimator_y_about_x));
    block.autocollimator(sensors_[1], 1, 0, -1, count, wanted(autocollimator_y_about_z));
    block.displacement(sensors_[3], 1, count, wanted(displacement_y));
  }
  if (wanted(displacement_z)) {
    block.turn(positions, first, count, &top_, nullptr);
    block.displacement(sensors_[4], 2, count, wanted(displacement_z));
  }
}

}  // namespace abbe
