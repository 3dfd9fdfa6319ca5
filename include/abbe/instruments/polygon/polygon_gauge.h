#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/polygon/polygon_campaign.h"
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
  std::size_t item_at(const Machine& machine, std::size_t target, std::size_t station,
                      const std::vector<double>& positions) const override;
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

}  // namespace abbe
