#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/polygon_campaign.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A polygon prism on any rotary axis of any machine, with the instruments that look at it.
struct PolygonGaugeSetup {
  /// Errors of a face and what is known of them.
  struct Face {
    SetupNumber azimuth_error = SetupNumber::open(0);  ///< rad, as PolygonFace
    SetupNumber tilt = SetupNumber::open(0);           ///< rad
    SetupNumber distance;                              ///< of the plane from the prism's origin, actual, mm
  };
  /// The prism as it was put on once.
  struct Mount {
    std::string name = "mount1";
    std::size_t turned_by = 0;  ///< faces
    /// tilt_x, tilt_y, turn (rad), x, y, z (mm): PolygonMount::angles and offset.
    std::array<SetupNumber, 6> numbers = {SetupNumber::open(0), SetupNumber::open(0), SetupNumber::open(0),
                                          SetupNumber::open(0), SetupNumber::open(0), SetupNumber::open(0)};
  };
  /// Readings that are taken at once. All steps of a stepwise measurement have the same kinds of readings.
  struct Step {
    std::string name;                      ///< empty if it is the only one
    std::vector<PolygonReading> measured;  ///< in this order; one to six
    std::vector<SetupNumber> zeros;        ///< [measured] rad or mm, or empty: open, from zero
  };

  std::string name = "polygon1";
  Polygon polygon;                    ///< regular, PolygonFaceOrder::face, faces divisible by four
  std::vector<Face> faces;            ///< [faces], or empty: open, starting where `polygon` says
  std::array<SetupNumber, 2> top;     ///< tilt_x, tilt_y of the mirror, rad
  Body table_body = Body::workpiece;  ///< carries the prism
  Body sensor_body = Body::bed;       ///< carries autocollimators and displacement sensors
  RigidTransform table_from_prism;    ///< nominal, frame of table_body: z along the rotary axis, not turned by faces
  RigidTransform sensors_from_bench;  ///< frame of PolygonBench in that of sensor_body, at the position of measuring
  PolygonBench bench;                 ///< positions of the sensors, taken as known
  std::vector<Mount> mounts = {Mount{}};
  std::vector<Step> steps = {all_at_once()};
  PolygonNoise noise;

  /// Everything but the redundant reading about z along y.
  static Step all_at_once();
};

/// The prism as one instrument among others in the identification of a machine: the machine's errors, as they are where
/// the table stands, take the place of the table's six motions.
///
/// Frames: bench = inverse(sensors_from_bench) * (table_body seen from sensor_body) * table_from_prism * mount, with
/// mount = [Ry Rx Rz(turn + ez) | d]; planes and readings as in polygon.h. Targets: MOUNT, or MOUNT.STEP if there are
/// several steps. Items: a target and the face seen along x ("mount2.face5"). Quantities: NAME.MOUNT.tilt_x, tilt_y,
/// turn, x, y, z; NAME.faceJ.azimuth_error, tilt, distance; NAME.top.tilt_x, tilt_y; NAME.zero.READING or
/// NAME.STEP.zero.READING. Components: names of the readings; with several steps autocollimator_about_z,
/// autocollimator_tilt (about y seen along x, about x seen along y), displacement. Derivatives by forward
/// differentiation. Source: docs/polygon.md.
class PolygonGauge : public EquationInstrument<PolygonGauge, 20, 6> {
 public:
  /// @throws std::invalid_argument: as validate(); faces not divisible by four, no or repeated or more than six
  ///         readings, steps with different kinds of readings, sizes that do not fit, the paper's order of the face
  explicit PolygonGauge(const PolygonGaugeSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  std::vector<std::string> target_names() const override;
  /// @throws std::invalid_argument if no face looks along the sensors' axes there, saying by how many degrees it
  /// misses,
  ///         or if a beam misses its face
  std::size_t item_at(const Machine& machine, std::size_t target, const std::vector<double>& positions) const override;
  std::size_t target_of(std::size_t item) const override { return item / setup_.polygon.faces.size(); }

  const PolygonGaugeSetup& setup() const { return setup_; }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  /// Order of the quantities of an item.
  enum Place { kMount = 0, kFaceX = 6, kFaceY = 9, kTop = 12, kZero = 14 };
  /// What an item nominally is.
  struct Seen {
    std::size_t step;
    double turn, azimuth_x, azimuth_y;  ///< of the mount and of the faces seen along x and y, rad
  };

  const PolygonGaugeSetup::Mount& mount_of(std::size_t target) const { return setup_.mounts[target / steps()]; }
  std::size_t steps() const { return setup_.steps.size(); }

  PolygonGaugeSetup setup_;
  std::vector<Seen> nominal_;                           ///< [items]
  std::array<Eigen::Matrix3d, kPolygonReadings> axes_;  ///< of the sensors in the bench
};

/// Poses and items for all targets: the rotary axis goes once round in steps of one face, the others stay.
///
/// @param axis       index into Machine::axes
/// @param positions  commands of all axes, chain order; of `axis`: the first position
/// @throws std::invalid_argument as PolygonGauge::item_at()
InstrumentReadings polygon_plan(const Machine& machine, const PolygonGauge& gauge, std::size_t axis,
                                std::vector<double> positions);

template <typename S>
void PolygonGauge::equation(std::size_t item, const SeenBody<S>& seen, const S* q, const double*, S* reading) const {
  using Vector = Eigen::Matrix<S, 3, 1>;
  using std::cos;
  using std::sin;
  const auto turned = [](const Vector& v, int axis, const S& c, const S& s) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    Vector result = v;
    result[a] = c * v[a] - s * v[b];
    result[b] = s * v[a] + c * v[b];
    return result;
  };
  const Seen& nominal = nominal_[item];
  const std::vector<PolygonReading>& measured = setup_.steps[nominal.step].measured;
  const S mount_c[3] = {cos(q[kMount]), cos(q[kMount + 1]), cos(q[kMount + 2] + S(nominal.turn))};
  const S mount_s[3] = {sin(q[kMount]), sin(q[kMount + 1]), sin(q[kMount + 2] + S(nominal.turn))};
  const Vector offset(q[kMount + 3], q[kMount + 4], q[kMount + 5]);
  const auto constant = [](const Eigen::Vector3d& v) { return Vector(S(v[0]), S(v[1]), S(v[2])); };
  const auto times = [](const Eigen::Matrix3d& m, const Vector& v) {
    Vector result;
    for (int i = 0; i < 3; ++i) result[i] = S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2];
    return result;
  };
  const Eigen::Matrix3d to_bench = setup_.sensors_from_bench.rotation.transpose();

  // The three planes in the bench, those that are read.
  Vector normals[3];
  S offsets[3];
  bool known[3] = {false, false, false};
  const auto plane = [&](int side) {
    if (known[side]) return;
    known[side] = true;
    Vector normal;
    S distance = S(setup_.polygon.top.height);
    if (side == 2) {
      const S sx = sin(q[kTop]), cx = cos(q[kTop]), sy = sin(q[kTop + 1]), cy = cos(q[kTop + 1]);
      normal = Vector(-sy, cy * sx, cy * cx);
    } else {
      const int face = side == 0 ? kFaceX : kFaceY;
      const S azimuth = q[face] + S(side == 0 ? nominal.azimuth_x : nominal.azimuth_y);
      const S flat = cos(q[face + 1]);
      normal = Vector(cos(azimuth) * flat, sin(azimuth) * flat, sin(q[face + 1]));
      distance = q[face + 2];
    }
    normal =
        turned(turned(turned(normal, 2, mount_c[2], mount_s[2]), 0, mount_c[0], mount_s[0]), 1, mount_c[1], mount_s[1]);
    const Vector on_plane = normal * distance + offset;
    const Vector in_table = times(setup_.table_from_prism.rotation, normal);
    const Vector point =
        times(setup_.table_from_prism.rotation, on_plane) + constant(setup_.table_from_prism.translation);
    const Vector seen_point = seen.point(point) - constant(setup_.sensors_from_bench.translation);
    normals[side] = times(to_bench, seen.direction(in_table));
    offsets[side] = normals[side].dot(times(to_bench, seen_point));
  };

  for (std::size_t row = 0; row < measured.size(); ++row) {
    const PolygonReading kind = measured[row];
    const PolygonSensor& sensor = setup_.bench.sensor(kind);
    const int side = static_cast<int>(sensor.side);
    plane(side);
    const Eigen::Matrix3d& axes = axes_[static_cast<std::size_t>(kind)];
    const S along = normals[side].dot(constant(axes.col(side)));
    if (is_angle(kind)) {
      const PolygonAcross across = across_of(kind);
      const S aside = normals[side].dot(constant(axes.col(across.axis)));
      reading[row] = S(across.sign) * along * aside / (S(2) * along * along - S(1));
    } else {
      const Eigen::Vector3d start = sensor.position + axes * sensor.exit;
      reading[row] = S(sensor.exit[side]) + (offsets[side] - normals[side].dot(constant(start))) / along;
    }
    reading[row] += q[kZero + static_cast<int>(row)];
  }
}

}  // namespace abbe
