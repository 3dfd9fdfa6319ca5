#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// A touch-trigger probe on one body and an artefact of one or several spheres on another.
struct TouchProbeSetup {
  enum class Measure {
    centre,  ///< the machine measures the centre of a sphere and reports where it found it
    touch    ///< single touches along given directions
  };
  enum class Frame { probe, artefact };
  struct Sphere {
    std::string name = "sphere1";
    SetupPoint centre;                              ///< mm, frame of the artefact
    SetupNumber radius = SetupNumber::exact(12.5);  ///< mm; only touches see it
  };
  struct Placement {
    std::string name = "placement1";
    SetupPoint position;  ///< mm, origin of the artefact in the frame of artefact_body
    SetupPoint angles;    ///< rad, a, b, c of Rz(c) Ry(b) Rx(a), the artefact's axes in the frame of artefact_body
  };
  std::string name = "probe1";
  Measure measure = Measure::centre;
  Frame frame = Frame::probe;  ///< in which deviations are reported and approach directions are given
  Body probe_body = Body::tool;
  SetupPoint tip;  ///< mm, centre of the stylus tip, frame of probe_body; tool: from the gauge point
  SetupNumber tip_radius = SetupNumber::exact(3);  ///< mm, effective: without the pre-travel; only touches see it
  Body artefact_body = Body::workpiece;
  std::vector<Sphere> spheres;        ///< at least one
  std::vector<Placement> placements;  ///< none: the artefact's frame is the body's
  SetupNumber scale;                  ///< mm/mm, common relative deviation of all sphere coordinates (temperature)
  double noise = 0.5e-3;              ///< mm, standard uncertainty of each component
};

/// Readings of a touch probe on spheres: "chase the ball", scale and master balls, ball plate, ball bar.
///
/// With (R, t) the probe's body seen from the artefact's, gap = P + Rzyx (1 + scale) b - (R tip + t), the vector from
/// the tip's centre to the sphere's at the commanded pose:
///
///     centre    reading = R' gap (frame probe) or gap (frame artefact): by how much the found centre deviates from the
///               command, three components x, y, z. Nominal commands that bring the tip to the sphere read about zero.
///     touch     reading = travel along the approach direction a from the commanded pose until the tip touches:
///               a . gap - sqrt((r + r_tip)^2 - |gap|^2 + (a . gap)^2). With the commands at the instant of the trigger
///               the reading is zero. A direction that misses the sphere has no reading: not a number.
///
/// Frame probe is that of the machine's axes where no rotary axis turns the probe, frame artefact where none turns the
/// artefact; on a machine with both the control's convention decides, and neither may be right. The change of the
/// machine's errors over the small deviation itself is neglected (some 1e-5 of it).
/// Cannot be told apart: a sphere's radius, the tip's radius and the pre-travel but for their sum; the placement from
/// the coordinates of the spheres unless these are known (exact or within), of which the distances alone matter; the
/// scale of the artefact from a common positioning slope of the axes unless it is known; the tip from the tool offset.
/// Items: the spheres, with several placements "placement/sphere". Inputs of touches: approach_x, y, z (mm): a vector
/// whose direction alone counts. The scale is reported as an angle: 1 urad is 1 um/m.
/// Source: ISO 10791-6:2014, annex B (spheres); ISO 230-1:2012, 11; Ibaraki et al., Int. J. Mach. Tools Manuf. 51
/// (2011) 190.
class TouchProbe : public EquationInstrument<TouchProbe, 15, 3> {
 public:
  /// @throws std::invalid_argument no sphere, a radius not above zero
  explicit TouchProbe(const TouchProbeSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  /// The placements.
  std::vector<InstrumentPlace> places() const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::together; }
  /// Touches: from above and from four sides.
  std::vector<std::vector<double>> planned_inputs(std::size_t item) const override;

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double* inputs, S* reading) const;

 private:
  /// Centre of the sphere in the frame of the artefact's body, mm.
  template <typename S>
  static Eigen::Matrix<S, 3, 1> sphere_centre(const S* quantities);

  TouchProbeSetup::Measure measure_;
  TouchProbeSetup::Frame frame_;
  double noise_;
};

}  // namespace abbe
