#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "abbe/machine/machine.h"

namespace abbe {

/// What is asked of the tool, in the workpiece frame.
enum class TargetKind {
  point,                ///< functional point; the tool may have any direction
  point_and_direction,  ///< functional point and direction from it to the spindle
  full_pose             ///< functional point and full orientation
};

/// An axis and the command it is kept at (in a plan: the position); mm or rad.
struct HeldAxis {
  std::size_t axis = 0;
  double position = 0;
};

/// +1, or -1 where a positive command acts backwards in the chain read from workpiece to tool: the turn (shift) of the
/// tool side against the workpiece side is chain_sign * command.
double chain_sign(const Axis& axis);

/// Which axes of a machine do what for one kind of target.
struct InversePlan {
  std::array<bool, kMaxAxes> held{};  ///< kept at `command`, which is the position of a coupled axis
  std::array<double, kMaxAxes> command{};
  std::array<std::size_t, 3> rotary{};  ///< axes found from the orientation, chain order
  std::size_t rotary_count = 0;
  std::size_t rotary_wanted = 0;        ///< how many such a target needs: 0, 2 or 3
  std::array<std::size_t, 3> linear{};  ///< axes found from the position, chain order
  std::size_t linear_count = 0;
  /// Rotary axes that do not change the target's orientation, nearest to the workpiece first. If there are fewer than
  /// three linear axes, one of them serves the position. Otherwise they count as held.
  std::array<std::size_t, kMaxAxes> polar{};
  std::size_t polar_count = 0;
  /// Jointed arms: rotary axes that take position and orientation together, chain order: 3 for a point, 5 for a point
  /// and a direction, 6 for a full pose. None where the lists above suffice, or where there are not enough.
  std::array<std::size_t, 6> arm{};
  std::size_t arm_count = 0;
  std::array<bool, kMaxAxes> held_by_option{};
  /// Directions of `rotary`, right-hand rule in the chain from workpiece to tool, seen past the held axes before each.
  std::array<Eigen::Vector3d, 3> direction;
  Eigen::Matrix3d held_rotation = Eigen::Matrix3d::Identity();  ///< of all held rotary axes together
};

/// Decides which axes work and which are held, see InverseOptions::held.
///
/// With an arm, `rotary`, `linear` and `polar` are what the machine could do without it.
/// @param machine    sound (find_problems() empty)
/// @param held       by the user's option
/// @param reference  [axes] positions of axes held by default; mm or rad
InversePlan make_inverse_plan(const Machine& machine, TargetKind kind, std::span<const HeldAxis> held,
                              std::span<const double> reference);

}  // namespace abbe
