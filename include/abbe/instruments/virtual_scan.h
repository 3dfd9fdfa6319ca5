#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/ray_tracer.h"
#include "abbe/instruments/point_scan.h"

namespace abbe {

/// A part on a machine and a displacement probe that looks at it.
struct VirtualScanSetup {
  ProbeBeam beam;
  RigidTransform workpiece_from_part;  ///< where the part is clamped, with its clamping errors
  double lowest = -0.2;                ///< mm, range of the indication
  double highest = 0.2;
  double working_distance = 10;               ///< mm, from the probe to the zero of the indication
  double largest_angle = 28 * kDegree;        ///< rad, between the beam and the normal of the surface
  double linear_noise = 0, rotary_noise = 0;  ///< mm, rad: standard deviation of an axis from its command
  double probe_noise = 0;                     ///< mm, standard deviation of an indication
  /// Linear axis that follows the surface, or npos: after an indication h its command is shifted so that the next one
  /// would be zero on a surface without slope; where the surface is lost it searches for it.
  std::size_t following_axis = Machine::npos;
  double search = 0;  ///< mm, how far beyond the range of the indication it searches
  std::uint64_t seed = 1;
};

/// Readings of a simulated scan; positions without an indication are not among them.
struct VirtualScan {
  PoseList positions;                ///< commands, as a controller records them
  std::vector<double> indication;    ///< mm, positive away from the probe
  std::vector<std::size_t> planned;  ///< [readings] index of the planned position
  std::size_t no_surface = 0;        ///< planned positions from which the beam meets nothing within range
  std::size_t too_steep = 0;         ///< the beam meets the surface at more than the largest angle, or from inside
};

/// Scans a part: for every planned position the beam of the actual machine is traced to the surface.
///
/// The axes stand beside their commands by independent normal deviations; the recorded commands are without them.
/// One random stream per planned position, so that a reading does not depend on the ones before, but for the axis that
/// follows.
/// @param planned  commands, mm or rad
VirtualScan scan_part(const Machine& machine, const ErrorSet& actual, const RayTracer& part, const PoseList& planned,
                      const VirtualScanSetup& setup);

/// Points of readings, workpiece frame, mm, [3, readings], as the machine with these errors sees them.
Eigen::Matrix3Xd scanned_points(const Machine& machine, const ErrorSet& errors, const ProbeBeam& beam,
                                const VirtualScan& scan);

}  // namespace abbe
