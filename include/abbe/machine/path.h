#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/inverse_kinematics.h"

namespace abbe {

struct PathOptions {
  InverseOptions inverse;  ///< held axes, tolerances; all_turns is always on here
  /// [axes] commands before the first pose, mm or rad, NaN for an axis of which nothing is known; empty: the path
  /// begins where it likes.
  std::vector<double> start;
  /// Moves of rotary axes count as this many mm per rad beside those of linear axes.
  double mm_per_radian = 100;
  /// A rotary axis that turns more than this (rad) and more than three times the tool in one step makes a jump.
  double largest_turn = 20 * kDegree;
};

enum class PathStatus {
  not_run,
  followed,         ///< every pose within travel; jumps, if any, are listed
  outside_travel,   ///< at `failed_pose` every solution exceeds a travel
  not_reached,      ///< at `failed_pose` there is no solution
  start_undecided,  ///< the known commands of the start are as near to another beginning: `undecided`
  invalid_options   ///< the machine or the options are not usable
};

/// A step in which the axes move far although the tool hardly does: the branch switches, an axis unwinds a turn, or the
/// path passes close by a singular pose.
struct PathJump {
  std::size_t pose = 0;               ///< the step ends at this pose
  std::size_t axis = 0;               ///< rotary axis that turns most
  double turn = 0;                    ///< rad, signed
  double largest_linear_move = 0;     ///< mm
  double point_deviation = 0;         ///< mm, tool from the chord of the path when all axes are half way
  bool leaves_singular_pose = false;  ///< the step begins or ends where the axis is free
};

struct PathResult {
  PathStatus status = PathStatus::not_run;
  std::vector<InverseSolution> solutions;  ///< [poses] if followed; endless axes unwound continuously
  std::vector<PathJump> jumps;
  double length = 0;                   ///< mm, sum of the moves of all axes (mm_per_radian for rotary ones)
  std::size_t failed_pose = 0;         ///< index of the pose that failed
  InverseResult failure;               ///< what the inverse kinematics says about it
  std::vector<std::size_t> undecided;  ///< axes without a command in the start, one of which would decide
};

/// Axis commands along a path of poses by continuity.
///
/// Of all branches and turns within travel at all poses the sequence with the fewest jumps is taken; among these
/// the one with most of them in singular poses, where the tool keeps its direction; then the one with the shortest
/// moves. Dynamic programming over the whole path, so an axis starts on the turn that lets it go through. In a singular
/// pose the free axis keeps its command of the poses before, or takes that of the poses after. The move from the start
/// counts over the axes that it gives a command; where sequences with as few jumps begin equally near by these axes but
/// elsewhere by others, nothing is chosen. Endless rotary axes are
/// followed over any number of turns. Time: poses times branches squared.
/// @param path  poses close enough that neighbours differ by a small turn of the tool
PathResult follow_path(const Machine& machine, std::span<const PoseTarget> path, const PathOptions& options = {});

/// A result in words, one line per jump: "pose 12: C turns 180 deg, ...".
std::string describe(const Machine& machine, const PathResult& result);

}  // namespace abbe
