#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/instruments/equation_instrument.h"

namespace abbe {

/// A six-dimensional tracker, or cameras, that see where targets are and how they are turned.
struct PoseTrackerSetup {
  /// A target fixed to one body of the machine.
  struct Target {
    std::string name = "target1";
    Body body = Body::tool;
    SetupPoint offset;  ///< mm, of the target's origin; tool: from the gauge point; else in that body's frame
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< axes of the target in the frame of the body
    bool estimate_rotation = true;                           ///< its three numbers are unknowns
    std::optional<Eigen::Matrix3d> true_rotation{};          ///< simulation, where it is not `rotation`
  };
  std::string name = "pose-tracker";
  Body station_body = Body::workpiece;  ///< on which the instrument stands
  RigidTransform body_from_station;     ///< of which its six numbers are unknowns, if estimate_pose
  bool estimate_pose = true;
  bool pose_is_known = true;                  ///< false: it has to be found from the readings
  std::optional<RigidTransform> true_pose{};  ///< simulation, where it is not body_from_station
  std::vector<Target> targets;                ///< at least one, none on station_body
  double position_noise = 10e-3;              ///< mm, standard uncertainty of one coordinate
  double position_noise_per_length = 0;       ///< further part, mm per mm of distance
  double turn_noise = 50e-6;                  ///< rad, standard uncertainty of a turn about an axis of the target
};

/// Poses of targets: position and orientation in the frame of the instrument.
///
/// With (R_b, t_b) the target's body seen from the station's body, errors included, the station (R_s, t_s) and the
/// target (M, o) on its body:
///
///     x = R_s' (R_b o + t_b - t_s),   R = R_s' R_b M
///
/// R_s = exp(w) R_s,given and M = M_given exp(v) with rotation vectors w, v as unknowns. Every reading carries its
/// measured orientation R_m as a quaternion (inputs qw, qx, qy, qz). The components are x, y, z (mm) and turn_x,
/// turn_y, turn_z (rad): the turn 2 tan(a/2) n from R_m to R, by an angle a about the axis n in the frame of the
/// target. A measured turn is 0; the modelled one is the difference of the orientations, without a jump below half a
/// turn and equal to the angle within a^3/12. A quaternion of zeros means that no orientation was measured yet (a
/// plan). Quantities: NAME.x, .y, .z, .rx, .ry, .rz; TARGET.offset_x .., TARGET.rx ... Derivation:
/// docs/pose-tracker.md.
class PoseTracker : public EquationInstrument<PoseTracker, 12, 6> {
 public:
  /// @throws std::invalid_argument: no target, a target on the station's body, noise not above zero
  explicit PoseTracker(PoseTrackerSetup setup);

  /// The set-up at the present values of the quantities.
  PoseTrackerSetup setup() const;

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// The station's pose, the targets' orientations, and offsets that are open: see pose_tracker_start.h.
  StartedInstrument started(const Machine& machine, const InstrumentReadings& readings) const override;
  std::vector<ReadingMistake> usual_mistakes() const override;
  std::shared_ptr<const Instrument> truth(RandomStream& random) const override;
  std::shared_ptr<const Instrument> as_planned() const override;
  std::optional<MissingNumber> missing_for_plan() const override;
  /// Readings whose orientation is in their quaternions and whose turns are 0, as files have them.
  SimulatedInstrument simulate(const Machine& machine, const ErrorSet& errors, const InstrumentReadings& plan,
                               const InstrumentSimulationOptions& options) const override;
  bool may_miss() const override { return false; }
  std::vector<InstrumentPlace> places() const override;
  const char* target_word() const override { return "target"; }
  bool targets_share_poses() const override { return true; }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double* inputs, S* reading) const;

 private:
  /// Order of the quantities of an item.
  enum Place { kStation = 0, kStationTurn = 3, kOffset = 6, kTargetTurn = 9 };
  PoseTrackerSetup given_;
};

}  // namespace abbe
