#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// An electronic level on a moving body, alone or against a second one at rest.
struct ElectronicLevelSetup {
  struct Axis {
    std::string name = "inclination";
    /// Sensitive direction, frame of `body`: positive indication when this end rises; any length, not vertical.
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
    SetupNumber zero;  ///< rad, added to the indication: how the level stands on its body
  };
  std::string name = "level1";
  Body body = Body::workpiece;
  std::vector<Axis> axes;  ///< one or two
  /// The indication is the difference to a level with the same directions at rest on `reference_body`.
  bool relative = false;
  Body reference_body = Body::bed;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< against gravity, nominal, frame of reference_body; any length
  SetupNumber up_tilt_first, up_tilt_second;      ///< rad, see DirectionFrame: how the machine stands in the world
  double noise = 1e-6;                            ///< rad, standard uncertainty of one indication
};

/// Inclinations of a body against gravity.
///
/// With R the body seen from the reference body (usually the bed), d a sensitive direction and g the unit vector up,
///
///     indication = asin(R d . g) + zero                 alone
///     indication = asin(R d . g) - asin(d . g) + zero   relative
///
/// so a body that turns by a small angle about +Y lowers its end +X: the indication along X is -EB, along Y it is +EA.
/// Rotation about the vertical is not seen. g is fixed in the frame of the reference body: exact on the bed; on a body
/// that moves, its own inclinations enter in products only (1e-4 times 1e-4 rad) as long as no rotary axis turns it.
/// Relative indications do not contain a machine bed that tilts as heavy bodies move; alone the bed counts as at rest.
/// Cannot be told apart: `zero` from `up` unless a rotary axis turns the level about the vertical (reversal); both from
/// the constant of an angular error motion. So keep two of three exact or known.
/// Items: one. Components: the axes (rad). Source: ISO 230-1:2012, 3.4.6, 8.2.2; Slocum, Precision Machine Design
/// (1992).
class ElectronicLevel : public EquationInstrument<ElectronicLevel, 4, 2> {
 public:
  /// @throws std::invalid_argument no or more than two axes, a direction that is vertical or has no length
  explicit ElectronicLevel(const ElectronicLevelSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  DirectionFrame up_;
  std::vector<Eigen::Vector3d> directions_;
  bool relative_;
  double noise_;
};

}  // namespace abbe
