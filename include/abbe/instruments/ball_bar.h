#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"

namespace abbe {

/// A telescoping ball bar between a ball on one body (usually in the spindle) and balls on another.
struct BallBarSetup {
  std::string name = "ballbar1";
  Body spindle_body = Body::tool;  ///< carries the spindle ball
  SetupPoint spindle_ball;         ///< mm, frame of spindle_body; tool: from the gauge point
  Body table_body = Body::workpiece;
  std::vector<NamedPoint> balls;  ///< at least one
  /// Indicated minus true distance of the ball centres, mm: zero error of the scale after calibration.
  SetupNumber length_deviation;
  double noise = 0.1e-3;        ///< mm, standard uncertainty of one indicated length
  double noise_per_length = 0;  ///< further part, mm per mm of length
};

/// Indicated length of a ball bar: distance of the two ball centres plus the zero error of the scale.
///
///     L = |R p_spindle + t - p_table| + d
///
/// with (R, t) the spindle's body seen from the table's. A constant d and the radius of a circle cannot be told from a
/// common scale error of the axes unless the bar is calibrated (Knowledge::within or exact).
/// Items: the balls. Component: length (mm). Source: ISO 230-4:2005; ISO 230-1:2012, 6.1 (error motions); the equation
/// is plain geometry. A length of zero has no derivative and is refused by check in the plan.
class BallBar : public EquationInstrument<BallBar, 7, 1> {
 public:
  explicit BallBar(const BallBarSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::at_distance; }

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  double noise_, noise_per_length_;
};

}  // namespace abbe
