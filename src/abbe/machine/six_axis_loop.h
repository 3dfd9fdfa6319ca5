#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

inline constexpr std::size_t kLoopAxes = 6;
using LoopAngles = std::array<double, kLoopAxes>;
using LoopVector = Eigen::Matrix<double, 6, 1>;
using LoopMatrix = Eigen::Matrix<double, 6, 6>;

/// Six rotary axes and where they shall bring a body: E0(t0) E1(t1) ... E5(t5) = target, with Ei the turn by ti about a
/// line that is given where all angles are zero. Angles rad, right-hand rule; lengths in any one unit.
struct SixAxisLoop {
  std::array<Eigen::Vector3d, kLoopAxes> direction;  ///< unit
  std::array<Eigen::Vector3d, kLoopAxes> point;      ///< on each axis
  RigidTransform target;

  RigidTransform turn(std::size_t axis, double angle) const;
  RigidTransform turns(std::size_t first, std::size_t count, const LoopAngles& angles) const;

  /// The same loop begun at another axis: E_k ... E5 E0' ... = target, with the lines of the first k axes seen from the
  /// target. Its solutions are those of this loop, with the angles in the same rotated order.
  SixAxisLoop begun_at(std::size_t first) const;
  /// The angles of this loop from those of begun_at(first).
  static LoopAngles in_first_order(const LoopAngles& angles, std::size_t first);

  double size() const;  ///< the largest distance of an axis from the next one's point, at least tiny
};

/// A set of angles that may solve a loop, to be confirmed.
struct LoopCandidate {
  LoopAngles angle{};
  std::size_t free_axis = kLoopAxes;  ///< the axis that is free and was held at the start, if one is
};

/// Room for candidates without allocation; more than fit are left out.
class LoopCandidates {
 public:
  void add(const LoopCandidate& candidate) {
    if (count_ < candidates_.size()) candidates_[count_++] = candidate;
  }
  std::size_t size() const { return count_; }
  LoopCandidate& operator[](std::size_t k) { return candidates_[k]; }
  const LoopCandidate& operator[](std::size_t k) const { return candidates_[k]; }

 private:
  std::array<LoopCandidate, 160> candidates_;
  std::size_t count_ = 0;
};

/// What is missing of the target, and its derivative by the angles.
///
/// @param at        point of the body at which its position counts
/// @param length    by which positions are divided
/// @param jacobian  if not null: derivative of the reached pose by the angles
/// @return position (divided by length), then the rotation vector from what is reached to the target (rad)
LoopVector missing_of(const SixAxisLoop& loop, const LoopAngles& angles, const Eigen::Vector3d& at, double length,
                      LoopMatrix* jacobian);

/// Newton's method from a candidate, with steps cut where they gain nothing.
/// @return norm of what is missing in the end; the angles are never worse than those given
double polish(const SixAxisLoop& loop, const Eigen::Vector3d& at, double length, LoopAngles& angles);

/// The nearest approach: the orientation of the target kept, the distance of a point of the body made small from the
/// angles given.
void approach(const SixAxisLoop& loop, const Eigen::Vector3d& at, double length, LoopAngles& angles);

/// How far three neighbouring axes of a loop are from meeting in a point or from being parallel, whichever is less, in
/// units of the loop's size or rad; infinite if they do neither.
double departure_from_decoupled(const SixAxisLoop& loop);

/// Candidates where three neighbouring axes meet in a point or are parallel, nearly at least, in closed form.
/// @param start  angles given to axes that are free
void add_decoupled_candidates(const SixAxisLoop& loop, const LoopAngles& start, LoopCandidates& candidates);

/// Candidates of a loop without special geometry, by elimination to an eigenvalue problem (general_loop.cpp).
void add_general_candidates(const SixAxisLoop& loop, LoopCandidates& candidates);

/// All solutions of a loop, each polished and none twice.
/// @param at         point of the body at which its position counts
/// @param tolerance  of what is missing, position in units of the loop's size, and rad
/// @param distinct   number of axes, from the first on, by which solutions differ
LoopCandidates solve_loop(const SixAxisLoop& loop, const Eigen::Vector3d& at, const LoopAngles& start, double tolerance,
                          std::size_t distinct);

}  // namespace abbe
