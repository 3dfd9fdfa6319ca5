#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace abbe {

/// Why a set of rotary axes has lost a freedom at an orientation.
enum class RotarySingularity {
  none,
  first_axis_free,  ///< the first axis turns nothing that matters (or only together with the third): it was held
  branches_meet     ///< the orientation lies on the limit of what the axes reach; the two branches are one
};

/// Angles of up to three rotary axes that bring a direction or a frame to a target, and how far they miss it.
struct RotaryAngles {
  std::array<double, 3> angle{};  ///< rad, right-hand rule about the given axes
  double miss = 0;                ///< rad, the smallest angle between what is reached and the target
  double margin = 0;              ///< rad, angle by which the pose is away from the nearest singularity
  RotarySingularity singularity = RotarySingularity::none;
};

/// At most two branches; count 2 only if they differ.
struct RotaryBranches {
  int count = 0;
  std::array<RotaryAngles, 2> branch;
};

/// Below this angle (rad) of a direction to an axis the axis is treated as free and held.
inline constexpr double kSingularAngle = 1e-10;

/// Angle about a unit axis that turns `from` into the half plane of `to`, rad, (-pi, pi] (Paden-Kahan subproblem 1).
double angle_about(const Eigen::Vector3d& unit_axis, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Angles t with Rot(axes[0], t0) Rot(axes[1], t1) start = target, for 0, 1 or 2 axes.
///
/// Two axes: Paden-Kahan subproblem 2, for any directions that are not parallel. It is solved as the spherical triangle
/// of the two axes and the turned direction, by half-angle formulas on differences of its sides, which keep all digits
/// where acos of a direction cosine loses half of them.
/// @param axes        unit vectors; the last one not parallel to `start`
/// @param held_first  rad, angle given to the first axis where it is free (target along it)
/// @return one branch or two; if the target is out of reach the nearest direction, with its miss
RotaryBranches turn_direction(std::span<const Eigen::Vector3d> axes, const Eigen::Vector3d& start,
                              const Eigen::Vector3d& target, double held_first);

/// Angles t with Rot(axes[0], t0) Rot(axes[1], t1) Rot(axes[2], t2) = target, for 0 to 3 axes of any directions.
///
/// Three axes: generalised Euler angles (Davenport; here neighbouring axes need not be at right angles). Fewer axes:
/// the rotation nearest to the target, in closed form from its quaternion.
/// @param axes  unit vectors, neighbours not parallel
RotaryBranches turn_frame(std::span<const Eigen::Vector3d> axes, const Eigen::Matrix3d& target, double held_first);

}  // namespace abbe
