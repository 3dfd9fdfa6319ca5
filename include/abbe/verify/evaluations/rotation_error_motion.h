#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace abbe {

/// Readings of displacement probes at an axis of rotation that turns several times. Empty: there is no such probe.
struct RotationReadings {
  std::vector<double> angle;   ///< [n] rad, over all turns without jumps, rising or falling; from X towards Y
  std::vector<double> x1, y1;  ///< [n] mm, radial along X and Y in the first plane
  std::vector<double> x2,
      y2;  ///< [n] mm, the same in a second plane, in the positive direction of the axis from the first
  std::vector<double> axial;  ///< [n] mm, on the axis
  std::vector<double> face;   ///< [n] mm, parallel to the axis at a radius
};

struct RotationOptions {
  double plane_distance = 0;       ///< mm, from the first plane to the second; 0: no tilt error motions
  double sensitive_angle = 0;      ///< rad, rotating sensitive direction at spindle angle zero, from X towards Y
  double reading_uncertainty = 0;  ///< standard uncertainty of one displacement, mm; 0: not stated
};

/// Error motions of ISO 230-7. "Fixed": along a direction of the machine (a turning workpiece). "Rotating": along a
/// direction that turns with the axis (a turning tool); it needs two probes.
enum class AxisErrorMotionKind : std::uint8_t {
  radial_fixed_x1,
  radial_fixed_y1,
  radial_rotating_1,
  radial_fixed_x2,
  radial_fixed_y2,
  radial_rotating_2,
  tilt_fixed_x,   ///< towards X (a rotation about +Y), rad
  tilt_fixed_y,   ///< towards Y (a rotation about -X), rad
  tilt_rotating,  ///< rad
  axial,
  face
};

/// True for the tilts, whose values are in rad; all others are in mm.
bool is_tilt(AxisErrorMotionKind kind);
/// True where the once-per-turn part belongs to the artefact (its eccentricity, its tilt) and is taken out: radial and
/// tilt. Axial and face error motions keep it.
bool fundamental_is_removed(AxisErrorMotionKind kind);

/// The error motions that these probes and options allow, in the order of AxisErrorMotionKind.
std::vector<AxisErrorMotionKind> evaluated_kinds(const RotationReadings& readings, const RotationOptions& options);

/// One error motion; values in mm or rad (is_tilt()).
struct AxisErrorMotion {
  AxisErrorMotionKind kind = AxisErrorMotionKind::axial;
  /// Polar plot: [positions] and [turns * positions], turn after turn, deviations from the base circle whose centre is
  /// the least-squares centre (mean and, where it is removed, the once-per-turn part taken out).
  std::vector<double> synchronous, total;
  double total_value = 0;           ///< largest less smallest of `total`
  double synchronous_value = 0;     ///< largest less smallest of `synchronous`
  double asynchronous_value = 0;    ///< largest spread over the turns at one position
  std::size_t asynchronous_at = 0;  ///< that position
  double fundamental_value = 0;     ///< twice the amplitude of the once-per-turn part, removed or not
  double residual_value = 0;        ///< largest less smallest of `synchronous` without its once-per-turn part
  double drift = 0;  ///< change of the mean of a turn from first to last, best straight line; part of the total
  /// Standard uncertainties from the stated one of a displacement; 0 if none was stated.
  double total_uncertainty = 0, synchronous_uncertainty = 0, asynchronous_uncertainty = 0;
};

enum class RotationStatus {
  not_run,
  done,
  too_few_turns,      ///< fewer than kLeastTurns whole turns: synchronous and asynchronous cannot be told apart
  too_few_positions,  ///< fewer than kLeastPositions readings per turn
  uneven_coverage     ///< a step more than kLargestStepRatio times the mean one, or a step back
};
inline constexpr std::size_t kLeastTurns = 4;
inline constexpr std::size_t kLeastPositions = 16;
inline constexpr double kLargestStepRatio = 3;

struct RotationResult {
  RotationStatus status = RotationStatus::not_run;
  std::size_t turns = 0;                 ///< whole turns used
  std::size_t positions = 0;             ///< angular positions per turn
  bool interpolated = false;             ///< readings do not stand at the same angles in every turn
  std::vector<double> angle;             ///< [positions] rad, spindle angle of the first turn
  std::vector<AxisErrorMotion> motions;  ///< as evaluated_kinds() lists; empty unless done
};

/// Error motions of an axis of rotation (ISO 230-7:2015) from angle-indexed readings.
///
/// Each turn is brought to the same angles by linear interpolation between neighbouring readings (nothing changes if
/// they are the same already). Synchronous: mean over the turns at each angle; asynchronous: what is left. Equations
/// and uncertainties in docs/evaluate-geometry.md.
RotationResult rotation_error_motions(const RotationReadings& readings, const RotationOptions& options = {});

}  // namespace abbe
