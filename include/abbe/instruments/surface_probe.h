#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// A displacement probe along one beam (confocal, triangulating, a scanning stylus) on one body and a standard on
/// another: cylinder, sphere or plane.
struct SurfaceProbeSetup {
  enum class Standard { cylinder, sphere, plane };
  /// The standard as it is clamped; the same one may be clamped several times.
  struct Clamping {
    std::string name = "standard1";
    /// mm, nominal, frame of standard_body: middle of the cylinder's axis, centre of the sphere, point of the plane
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    /// nominal axis of the cylinder or normal of the plane out of the material; any length, spheres have none
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    bool reversed = false;  ///< cylinder: clamped end for end, its taper runs the other way
    /// mm, from the nominal point along DirectionFrame's first, second and the direction itself. A cylinder has no
    /// third, a plane has the third alone, of a sphere they are along x, y, z of the frame.
    SetupPoint offset;
    SetupNumber tilt_first, tilt_second;  ///< rad, of the direction towards first and second; a sphere has none
  };
  std::string name = "probe1";
  Standard standard = Standard::cylinder;
  Body probe_body = Body::tool;
  Body standard_body = Body::workpiece;
  SetupPoint zero;  ///< mm, the point of the beam where the indication is zero, frame of probe_body; tool: from the
                    ///< gauge point
  Eigen::Vector3d beam = -Eigen::Vector3d::UnitZ();  ///< from the probe to the part, frame of probe_body; any length
  SetupNumber beam_first, beam_second;               ///< rad, tilts of the beam, see DirectionFrame
  SetupNumber radius = SetupNumber::exact(10);       ///< mm, of cylinder (in its middle) and sphere
  SetupNumber taper;                ///< mm/mm, by how much the cylinder's radius grows along its direction
  std::vector<Clamping> clampings;  ///< at least one
  double noise = 1e-3;              ///< mm, standard uncertainty of one indication with the axes' share
  double form = 0;                  ///< mm, standard uncertainty of the standard's own form at one place
};

/// Indications of a displacement probe on a standard: how far beyond its zero point the beam meets the surface.
///
/// With (R, t) the probe's body seen from the standard's, the beam starts at z = R zero + t and runs along b = R beam.
/// The indication h is the first root of, for a cylinder with axis (a, d), radius r and taper k (w = z + h b - a, u = d
/// . w),
///
///     |w|^2 - u^2 = (r + k u)^2,
///
/// for a sphere |w| = r, for a plane d . w = 0: traced exactly. A beam that misses the standard has no indication (not
/// a number). The taper's sign turns where the cylinder is clamped end for end, so two such clampings separate the
/// taper from a tilt of the rotary axis, which one alone cannot: each generator that is seen from above is inclined by
/// k, as if the axis were.
///
/// `form` enters as an independent deviation per indication; readings repeated at one place share it, averaging does
/// not help there. Cannot be told apart: the radius from the zero along the beam, unless rotary axes bring the standard
/// to the beam from opposite sides; a displacement along the rotary axis; the constant of an axis's angle from the
/// clamping. Items: the clampings. Component: the indication, mm, positive away from the probe. The taper is reported
/// as an angle: 1 urad is 1 um/m. Source: Liu et al., Sensors 21 (2021) 4609, sections 3 and 4, in the closed form
/// (docs/surface-probe.md).
class SurfaceProbe : public EquationInstrument<SurfaceProbe, 12, 1> {
 public:
  /// @throws std::invalid_argument no clamping, a direction of length zero, a radius not above zero
  explicit SurfaceProbe(const SurfaceProbeSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// The probe's zero and the nearest point of the standard against the beam.
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  /// The beam and the clampings.
  std::vector<InstrumentPlace> places() const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::together; }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  struct Mounted {
    Eigen::Vector3d point;
    DirectionFrame frame;
    bool reversed = false;
  };

  /// Where the standard's point is, mm, frame of its body.
  template <typename S>
  Eigen::Matrix<S, 3, 1> clamped_point(const Mounted& mounted, const S* quantities) const;

  SurfaceProbeSetup::Standard standard_;
  DirectionFrame beam_;
  double noise_;
  std::vector<Mounted> mounted_;
};

}  // namespace abbe
