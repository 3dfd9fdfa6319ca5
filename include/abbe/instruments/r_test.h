#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// A nest of displacement probes on one body and a precision sphere on another.
struct RTestSetup {
  enum class Tip {
    flat,  ///< face perpendicular to the plunger, wider than the contact wanders
    ball   ///< spherical tip; radius 0: a point
  };
  struct Probe {
    std::string name = "probe1";
    /// Direction in which the plunger is pushed in (positive indication), from the sphere to the probe; frame of
    /// nest_body, any length.
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    SetupNumber tilt_first, tilt_second;  ///< rad, see DirectionFrame
    SetupNumber zero;                     ///< mm, indication with the sphere's centre in the nest
    Tip tip = Tip::flat;
    double tip_radius = 0;                    ///< mm, ball only
    SetupNumber offset_first, offset_second;  ///< mm, ball only: by how much the plunger's line misses the nest centre
  };
  std::string name = "rtest1";
  Body nest_body = Body::workpiece;
  SetupPoint nest;            ///< mm, frame of nest_body
  std::vector<Probe> probes;  ///< 1 to 4, usually three
  Body sphere_body = Body::tool;
  std::vector<NamedPoint> spheres;                     ///< at least one
  SetupNumber sphere_radius = SetupNumber::exact(11);  ///< mm; only ball tips see it
  double noise = 0.1e-3;                               ///< mm, standard uncertainty of one indication
};

/// Indications of an R-test: how far each plunger is pushed in by the sphere.
///
/// With w = R s + t - n, the sphere's centre (s on its body, seen from the nest's body) from the nest centre n, and d
/// the plunger's direction:
///
///     flat tip   p = d . w + zero                   (a tangent plane perpendicular to d)
///     ball tip   p = along(w - o) + reach(w - o) - along(-o) - reach(-o) + zero,   along(v) = d . v,
///                reach(v) = sqrt((r + r_tip)^2 - |v|^2 + (d . v)^2),   o = offset_first first + offset_second second
///
/// that is where the ball of the tip, moved along its line, touches the sphere from outside. A sphere out of reach of
/// the line has no indication: the value is not a number.
/// Cannot be told apart: the zeros of three probes and the nest position (flat tips: exactly; so leave one of them
/// exact); the nest and the sphere's position as far as the bodies only shift against each other; the radii but for
/// their sum. With three probes at known directions the nest is a frame; if tilts are open too, its orientation is
/// held only by the machine's axes.
/// Items: the spheres. Components: one per probe, in their order (mm).
/// Source: Weikert, CIRP Annals 53 (2004) 429; Bringmann and Knapp, CIRP Annals 55 (2006) 531; ISO 230-1:2012.
class RTest : public EquationInstrument<RTest, 27, 4> {
 public:
  /// @throws std::invalid_argument no sphere, no or too many probes, a zero direction, a negative radius
  explicit RTest(const RTestSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::together; }

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  struct Probe {
    DirectionFrame frame;
    RTestSetup::Tip tip;
    double tip_radius;
  };

  /// Place along the line at which the two balls touch; `centre` from a point of the line.
  template <typename S>
  static S touched(const Eigen::Matrix<S, 3, 1>& direction, const Eigen::Matrix<S, 3, 1>& centre, const S& radii);

  std::vector<Probe> probes_;
  double noise_;
};

}  // namespace abbe
