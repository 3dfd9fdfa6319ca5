#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a laser interferometer with its optics measures, in the axes of its beam: x along it, z "up", y = z cross x.
enum class InterferometerComponent {
  length,          ///< displacement along x, mm
  straightness_y,  ///< across the beam along y, mm
  straightness_z,  ///< across the beam along z, mm
  roll,            ///< turn about x, rad
  pitch,           ///< turn about y, rad
  yaw              ///< turn about z, rad
};

/// What sends the beam of a length measurement back.
enum class LengthTarget {
  retroreflector,  ///< cube corner on the moving body, or a stationary reflector and a moving interferometer
  plane_mirror     ///< plane mirror on the moving body, beam reflected twice by it: may move across the beam
};

/// One line along which is measured with one alignment of the optics.
struct InterferometerRun {
  std::string name = "run1";
  Body moving_body = Body::tool;          ///< carries the moving optic
  Body reference_body = Body::workpiece;  ///< carries the other optics; the beam is fixed to it
  SetupPoint optic;                       ///< mm, frame of moving_body (tool: from the gauge point): vertex of the
                                          ///< reflector, a point of the plane mirror, centre of the Wollaston prism
  SetupPoint origin;                      ///< mm, frame of reference_body: where lengths and straightness are zero
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of the beam and of positive lengths, frame of
                                                         ///< reference_body, any length
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();         ///< z of the beam's axes lies in the plane of this and x
  /// Alignment: roll, pitch, yaw of the beam's axes against direction and up, rad. Pitch and yaw are the slopes of the
  /// symmetry axis of a straightness reflector and the cosine error of a length.
  std::array<SetupNumber, 3> alignment;
  /// Axes of moving_body seen in reference_body while the optics were aligned, nominal: see nominal_orientation().
  Eigen::Matrix3d aligned_orientation = Eigen::Matrix3d::Identity();
  LengthTarget target = LengthTarget::retroreflector;
  bool straightness_reflector_moves = false;  ///< then the Wollaston prism is the stationary one
  bool bidirectional = false;                 ///< gives two items, NAME+ and NAME-, and a reversal of every component
  /// Name of an earlier run whose straightness reflector serves this one through an optical square; empty: none.
  std::string square_with;
  SetupNumber square_angle;  ///< rad: angle of the square minus the angle of the two nominal directions
  double dead_path = 0;      ///< mm, between the optics at the zero of the indication: for the noise only
};

/// A laser interferometer and its optics.
struct InterferometerSetup {
  std::string name = "laser1";
  std::vector<InterferometerComponent> components = {InterferometerComponent::length};
  std::vector<InterferometerRun> runs;  ///< at least one
  SetupNumber length_scale;             ///< indicated / true - 1 (pure number): wavelength and its compensation
  SetupNumber straightness_scale;       ///< the same for the angle of the Wollaston prism
  SetupNumber angle_scale;              ///< the same for the distance of the two angular reflectors
  double length_noise = 0.05e-3;        ///< mm, standard uncertainty
  double length_noise_per_length = 0;   ///< further part, mm per mm of path, dead path included
  double straightness_noise = 0.2e-3;   ///< mm
  double angle_noise = 1e-6;            ///< rad
};

/// Indications of a laser interferometer along lines of the machine: positioning, straightness, angles, squareness with
/// an optical square, or all six motions of an axis at once.
///
/// Axes of the beam A = [x y z] = N Rz(yaw) Ry(pitch) Rx(roll), N from `direction` and `up`; v = R p + t - o from the
/// origin to the moving optic; G = A' R R0' A the turn of the moving body since the alignment, in the beam's axes
/// (R0 = aligned_orientation). Exact:
///
///     length          (1 + s_l) x . v                 cube corner: the path depends on its vertex only
///                     (1 + s_l) (n . v) (n . x)       plane mirror, n = R R0' x, path / 4 of two reflections
///     straightness_y  (1 + s_s) y . v                 reflector stands; moves with it: (R R0' y) . v
///     straightness_z  (1 + s_s) z . v
///     pitch           (1 + s_a) asin(x . G z)         difference of the paths of two cube corners
///     yaw             (1 + s_a) asin(-x . G y)
///     roll            (1 + s_a) atan2(z . G y, y . G y)
///
/// plus the zero of the component in that run; on NAME+ and NAME- of a bidirectional run plus and minus half its
/// reversal (ISO 230-2: B = mean from below - mean from above), so that error motions are means of both directions.
/// A run through an optical square has the axes T Rot(m, angle) N with T = A1 N1' of the run it is squared with and
/// m along x1 cross x. A constant scale makes dead path and zero one number.
/// Quantities: NAME.length_scale ...; RUN.optic.x .., RUN.origin.x .., RUN.roll, RUN.pitch, RUN.yaw,
/// RUN.COMPONENT.zero, RUN.COMPONENT.reversal. Derivation and sources: docs/interferometer.md.
class Interferometer : public EquationInstrument<Interferometer, 25, 6> {
 public:
  /// @throws std::invalid_argument: no run, no or a repeated component, a direction without length or along `up`, an
  ///         optical square whose first run is missing, on another body, or parallel
  explicit Interferometer(const InterferometerSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// Zeros that are open: median of measured - modelled on the nominal machine. A run that moves against its indicated
  /// length is noted.
  std::vector<double> start_values(const Machine& machine, const InstrumentReadings& readings,
                                   std::vector<std::string>& notes) const override;
  /// Moving optic and origin.
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::along_line; }

  const std::vector<InterferometerComponent>& measured_components() const { return measured_; }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  /// Order of the quantities of an item; the zeros, then the reversals follow.
  enum Place { kOptic = 0, kOrigin = 3, kAlignment = 6, kSquare = 9, kScale = 10, kZero = 13 };
  struct Line {
    Eigen::Matrix3d nominal_axes;           ///< [x y z] in the frame of the reference body
    Eigen::Matrix3d first_axes;             ///< those of the run it is squared with, else its own
    Eigen::Vector3d square_normal;          ///< unit; zero: no square
    Eigen::Matrix3d orientation_transpose;  ///< aligned_orientation'
    LengthTarget target;
    bool reflector_moves;
    int approach;  ///< +1, -1; 0: not told apart
    double dead_path;
  };

  void add_run(const InterferometerSetup& setup, std::size_t index, const std::array<std::size_t, 3>& scales,
               std::vector<std::array<std::size_t, 3>>& alignments);

  template <typename S>
  Eigen::Matrix<S, 3, 3> beam_axes(const Line& line, const S* quantities) const;

  std::vector<InterferometerComponent> measured_;
  std::vector<Line> lines_;  ///< [items]
  double length_noise_, length_noise_per_length_, straightness_noise_, angle_noise_;
};

/// Axes of one body seen in another on the nominal machine: InterferometerRun::aligned_orientation.
/// @param positions  commands in chain order, mm or rad
Eigen::Matrix3d nominal_orientation(const Machine& machine, const std::vector<double>& positions, Body from, Body to);

}  // namespace abbe
