#pragma once

#include <Eigen/Core>
#include <string>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// An autocollimator on one body that looks at a plane mirror on another.
struct AutocollimatorSetup {
  enum class Indication {
    mirror_angle,  ///< half the angle of the returning beam: w
    half_tangent   ///< half the tangent of the returning beam, as the focal plane shows it: tan(2 w) / 2
  };
  std::string name = "autocollimator1";
  Body mirror_body = Body::workpiece;
  SetupNumber mirror_tilt_first, mirror_tilt_second;  ///< rad, of the mirror's normal; see DirectionFrame
  Body collimator_body = Body::bed;
  Eigen::Vector3d beam = Eigen::Vector3d::UnitX();   ///< of the leaving beam, frame of collimator_body; any length
  Eigen::Vector3d first = Eigen::Vector3d::UnitY();  ///< across it: where the first indication is positive; any length
  SetupNumber zero_first, zero_second;               ///< rad, added to the indications
  Indication indication = Indication::mirror_angle;
  double noise = 0.5e-6;  ///< rad, standard uncertainty of one indication
};

/// Two angles of a mirror, by the reflection of a beam in it.
///
/// With b the leaving beam, e1 the part of `first` across it and e2 = b x e1, and m the mirror's normal seen from the
/// collimator's body (nominally against the beam in the nominal pose with all axes at zero), the beam returns as
/// r = b - 2 (b . m) m and
///
///     mirror_angle  indication_i = atan2(r . e_i, -(r . b)) / 2 + zero_i
///     half_tangent  indication_i = (r . e_i) / (-(r . b)) / 2 + zero_i
///
/// exactly; for small tilts each is the angle by which the normal leans towards e_i. Positive for a mirror turned about
/// -e2 (i = 1) or +e1 (i = 2) where the mirror looks against the beam: with b = X, first = Y, a carriage turning by EC
/// reads -EC, and second = Z, turning by EB reads +EB. Roll about the beam is not seen, nor any shift.
/// Cannot be told apart: mirror tilt and zero of the indication (but for products of angles); both from the constant of
/// an angular error motion: keep one of them open, the others exact.
/// Items: one. Components: first, second (rad). Source: ISO 230-1:2012, 8.2.2 (angular deviations); Ma et al., Applied
/// Sciences 11 (2021) 3960 for tan(2 w) / 2.
class Autocollimator : public EquationInstrument<Autocollimator, 4, 2> {
 public:
  /// @throws std::invalid_argument beam and first without length or parallel
  explicit Autocollimator(const AutocollimatorSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::along_line; }

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  DirectionFrame mirror_;
  Eigen::Vector3d beam_, across_[2];
  bool half_tangent_;
  double noise_;
};

}  // namespace abbe
