#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/instruments/setup_drift.h"

namespace abbe {

/// Standard uncertainty of a laser tracker, along and across the beam, growing linearly with the range.
///
/// u_range = range_um + range_um_per_m * range; u_transverse = transverse_um + transverse_um_per_m * range, the same in
/// both directions across the beam.
struct TrackerNoise {
  double range_um = 0;
  double range_um_per_m = 0;
  double transverse_um = 0;
  double transverse_um_per_m = 0;

  /// The same in all directions, as in manufacturers' "10 um + 5 um/m".
  static TrackerNoise isotropic(double um, double um_per_m) { return {um, um_per_m, um, um_per_m}; }
  /// Interferometer or distance meter and two encoders; `angle_arcsec` is seen across the beam.
  static TrackerNoise range_and_angles(double um, double um_per_m, double angle_arcsec) {
    return {um, um_per_m, 0, angle_arcsec * std::numbers::pi / (180 * 3600) * 1e6};
  }
  /// @param range  mm
  /// @return mm
  double range_uncertainty(double range) const { return 1e-3 * (range_um + range_um_per_m * 1e-3 * range); }
  double transverse_uncertainty(double range) const {
    return 1e-3 * (transverse_um + transverse_um_per_m * 1e-3 * range);
  }
  /// Covariance in tracker coordinates of a point there, mm^2.
  Eigen::Matrix3d covariance(const Eigen::Vector3d& point) const;
};

/// A laser tracker standing on one body of the machine.
///
/// `body_from_tracker * p_tracker = p_body`; of the tool, body coordinates count from the gauge point (as ChainPlan).
/// Its rotation may be any. Tracker frame: z is the standing axis, azimuth from x towards y, elevation from the xy
/// plane.
struct TrackerStation {
  std::string name = "tracker1";
  Body body = Body::workpiece;
  RigidTransform body_from_tracker;
  bool estimate_pose = true;  ///< its six numbers are unknowns
  TrackerNoise noise;         ///< used where the data state no uncertainty
  double elevation_min =
      -std::numbers::pi / 2;                    ///< rad, limits of the instrument; simulation leaves out what is beyond
  double elevation_max = std::numbers::pi / 2;  ///< rad
  double range_min = 0;                         ///< mm
  double range_max = 1e9;                       ///< mm
  bool pose_is_known = true;                    ///< false: it has to be found from the readings
  std::optional<RigidTransform> true_pose{};    ///< simulation, where it is not body_from_tracker
};

/// A reflector fixed to one body of the machine.
struct Reflector {
  std::string name = "reflector1";
  Body body = Body::tool;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< mm; tool: from the gauge point; else in that body's frame
  bool estimate_offset = false;                      ///< its three numbers are unknowns
  Eigen::Vector3d view_direction = Eigen::Vector3d::UnitX();  ///< unit, body frame: middle of its acceptance cone
  double view_half_angle = std::numbers::pi;                  ///< rad; pi: seen from everywhere
  bool offset_from_data = false;                              ///< the file of the readings states the offset
  Eigen::Vector3d offset_standard_uncertainty = Eigen::Vector3d::Zero();  ///< mm, of an estimated one; 0: open
  std::optional<Eigen::Vector3d> true_offset{};                           ///< mm; simulation, where it is not `offset`
};

/// The stations and reflectors of one campaign.
struct TrackerSetup {
  std::vector<TrackerStation> stations;
  std::vector<Reflector> reflectors;
};

enum class TrackerMeasure {
  cartesian,        ///< x, y, z in the tracker frame, mm
  range_and_angles  ///< range (mm), azimuth, elevation (rad)
};

/// Which uncertainty the data themselves state.
enum class StatedUncertainty {
  none,       ///< the station's noise model, at the measured point
  standard,   ///< one standard uncertainty per measured component
  covariance  ///< full 3x3 per reading
};

/// Readings of laser trackers, structure of arrays; a million need about 100 MB.
struct TrackerReadings {
  TrackerMeasure measure = TrackerMeasure::cartesian;
  StatedUncertainty stated = StatedUncertainty::none;
  PoseList poses;                               ///< axis commands, [axes][count], mm or rad
  std::vector<std::uint16_t> station;           ///< [count] index into TrackerSetup::stations
  std::vector<std::uint16_t> reflector;         ///< [count] index into TrackerSetup::reflectors
  std::array<std::vector<double>, 3> measured;  ///< [count] each: see TrackerMeasure
  std::vector<double> time_s;                   ///< [count] or empty
  std::vector<std::string> point_name;          ///< [count] name of the point in the input, or empty: it gives none
  /// standard: [0..2] are the standard uncertainties of the measured components (mm or rad; azimuth as the angle
  /// itself, not across the beam). covariance: xx, yy, zz, xy, xz, yz of the measured components. Else empty.
  std::array<std::vector<double>, 6> uncertainty;
  std::shared_ptr<const SetupDrift> drift{};  ///< of the stations; null: they stand still

  std::size_t count() const { return station.size(); }
  void reserve(std::size_t axes, std::size_t readings);
  /// Measured point of one reading in tracker coordinates, mm.
  Eigen::Vector3d point(std::size_t reading) const;
};

/// Direction of sight: range (mm), azimuth, elevation (rad) of a point in tracker coordinates, and back.
/// At the pole the azimuth is 0.
Eigen::Vector3d range_and_angles_from_point(const Eigen::Vector3d& point);
Eigen::Vector3d point_from_range_and_angles(const Eigen::Vector3d& range_and_angles);

/// Start point of a reflector for ChainPlan: its offset, on the tool plus the tool offset error.
Eigen::Vector3d reflector_start(const Reflector& reflector, const ErrorSet& errors);

/// Checks indices, sizes, finite numbers, positive uncertainties and that no station stands on its reflector's body.
/// @throws std::invalid_argument naming the reading (counted from 0) and what was expected
void validate(const Machine& machine, const TrackerSetup& setup, const TrackerReadings& readings);

}  // namespace abbe
