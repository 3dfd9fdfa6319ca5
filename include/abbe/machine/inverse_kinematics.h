#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/machine/coupling.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A pose wanted of the tool in the workpiece frame.
struct PoseTarget {
  TargetKind kind = TargetKind::point;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();            ///< mm
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();       ///< point_and_direction: any length but zero
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();  ///< full_pose: rotation of workpiece_from_tool

  static PoseTarget at(const Eigen::Vector3d& point);
  static PoseTarget at(const Eigen::Vector3d& point, const Eigen::Vector3d& direction);
  static PoseTarget at(const RigidTransform& workpiece_from_tool);
};

struct InverseOptions {
  /// Axes kept at a given command. Axes beyond those that the target needs are held too, at their command in
  /// `reference`: first those marked Axis::setting, then those nearest the workpiece, as long as the rest can do the
  /// task. Of a jointed arm: first those marked Axis::setting, then those whose holding leaves the others the largest
  /// volume |det J| on the average over travel, and all linear axes; they are held at their command of the start.
  /// Of coupled axes it is the position that is held, which is that at these commands; an axis that is named here needs
  /// those that it is coupled to beside it.
  std::vector<HeldAxis> held;
  /// Commands in chain order, mm or rad: values of axes that are held by default. Empty: zero, or the end of travel
  /// nearest to it.
  std::vector<double> reference;
  /// Rotary axes whose travel exceeds a turn: every equivalent within travel, or the one nearest to the start.
  bool all_turns = false;
  double orientation_tolerance = 1e-9;  ///< rad; a pose missed by more is unreachable
  double position_tolerance = 1e-6;     ///< mm
};

enum class InverseStatus {
  not_run,
  solved,                   ///< at least one solution lies within travel
  outside_travel,           ///< solutions exist, each exceeds a travel
  unreachable_orientation,  ///< the rotary axes cannot turn the tool so
  unreachable_position,     ///< the axes cannot reach the point in that orientation
  too_few_axes,             ///< not reached, and the machine has fewer axes than such a target needs
  invalid_target,           ///< target or start not finite, direction of length zero, no rotation
  invalid_machine           ///< find_problems() is not empty, or the options name an axis that does not exist
};

/// Why a solution is one of infinitely many, or the meeting of two.
enum class PoseSingularity {
  none,
  tool_parallel,     ///< tool parallel to a rotary axis, which is free and was held
  axes_parallel,     ///< full pose: first and last rotary axes parallel, only their sum counts; the first was held
  limit_of_reach,    ///< two branches meet at the limit of what the rotary axes reach
  point_on_axis,     ///< polar machine: the point lies on the rotary axis that should bring it into the plane of travel
  linear_dependent,  ///< linear axes parallel or in one plane in this pose: the nearest to the start was taken
  arm_dependent      ///< jointed arm: axes dependent in this pose; one of them is free and was held at the start
};

/// One set of axis commands that brings the tool to the target.
struct InverseSolution {
  std::array<double, kMaxAxes> position{};  ///< chain order; mm or rad; the first axes.size() count
  std::array<double, kMaxAxes> excess{};    ///< by how much a command lies above (+) or below (-) its travel; mm or rad
  bool within_travel = true;
  double position_residual = 0;     ///< mm, nominal forward kinematics of `position` against the target
  double orientation_residual = 0;  ///< rad
  int branch = 0;                   ///< solutions that differ by full turns have the same number
  PoseSingularity singularity = PoseSingularity::none;
  std::size_t singular_axis = Machine::npos;  ///< the axis that is free, if one is
  /// rad, angle to the nearest singularity of the rotary axes (pi if there is none). Of a jointed arm instead 1 /
  /// |J^-1| (Frobenius norm), with lengths in units of the arm's size: up to 2.5 times less than the least singular
  /// value.
  double singular_margin = 0;
  /// Volume (area) spanned by the directions of the linear axes in this pose: 1 at right angles, 0 dependent. Rounding
  /// of the linear commands grows by its inverse.
  double linear_volume = 1;
};

struct InverseResult {
  InverseStatus status = InverseStatus::not_run;
  /// Every branch; within travel first, then nearest to the start. Empty unless solved or outside_travel.
  std::vector<InverseSolution> solutions;
  /// The nearest approach where the target is not reached, with its residuals. Never a solution.
  InverseSolution closest;
};

/// Inverse kinematics of one machine, prepared once: which axes work and which are held is decided here.
///
/// Rotary axes are found in closed form from the orientation (Paden-Kahan subproblems, generalised Euler angles), for
/// any directions; then the linear axes from a linear system. Machines with fewer than three independent linear axes
/// and a rotary axis that the orientation does not determine (`w C' X' b Z t` with a target point) use that axis for
/// the position: polar machines, two branches. Jointed arms, where that does not suffice and there are six rotary axes
/// (five for a direction, three for a point): every branch, up to 16, in closed form where three neighbouring axes meet
/// in a point or are parallel, else by elimination to an eigenvalue problem. Fewer axes than that: least squares, with
/// its residual. Every solution is checked by nominal_workpiece_from_tool. No errors of the machine are considered
/// here. Coupled axes are found by their positions; results, starts and travels are commands. Method:
/// docs/kinematics.md. Paden (1986); Murray, Li, Sastry (1994), 3.3; Shuster and Markley (2003) for three axes; Pieper
/// (1968), Raghavan and Roth (1993), Manocha and Canny (1994) for arms.
class InverseKinematics {
 public:
  explicit InverseKinematics(const Machine& machine, const InverseOptions& options = {});

  /// All axis commands for a target.
  /// @param start   [axes] or null: free axes keep their command of it, and turns and order of the solutions go by the
  ///                distance to it; null: as InverseOptions::reference
  /// @param result  overwritten; allocates only when it grows beyond its earlier size, and for arms without three
  ///                neighbouring axes that meet or are parallel
  void solve(const PoseTarget& target, const double* start, InverseResult& result) const;
  InverseResult solve(const PoseTarget& target, const std::vector<double>& start = {}) const;

  /// Axes that are held for such targets, by name or by default, with their commands (of an arm: without a start; of a
  /// coupled axis: with the axes that it is coupled to at their reference).
  std::vector<HeldAxis> held_axes(TargetKind kind) const;

  const Machine& machine() const { return machine_; }
  /// Problems that made this object unusable; empty if it is sound.
  const std::string& problem() const { return problem_; }

 private:
  struct Candidate;
  /// Where a search starts, [axes] each; the same array where no axis is coupled.
  struct Start {
    const double* command;
    const double* position;
  };

  /// Positions at the reference and the commands of held axes, [axes]; the held ones become positions too.
  std::array<double, kMaxAxes> held_positions();
  void solve_branches(const InversePlan& plan, const PoseTarget& target, const Start& start,
                      InverseResult& result) const;
  void solve_polar(const InversePlan& plan, const PoseTarget& target, const Start& start, Candidate candidate,
                   InverseResult& result) const;
  void solve_linear(const InversePlan& plan, const PoseTarget& target, const Start& start, Candidate candidate,
                    InverseResult& result) const;
  void solve_arm(const InversePlan& plan, const PoseTarget& target, const Start& start, InverseResult& result) const;
  /// @param place     in order_: positions of the axes from there on become commands
  void add_turns(const PoseTarget& target, const Start& start, std::uint32_t turning, std::size_t place,
                 InverseSolution& solution, InverseResult& result) const;
  void add_solution(const PoseTarget& target, InverseSolution solution, InverseResult& result) const;

  Machine machine_;
  InverseOptions options_;
  std::string problem_;
  CouplingOrder order_;
  std::array<double, kMaxAxes> reference_{};  ///< commands
  std::array<InversePlan, 3> plans_;          ///< by TargetKind
};

/// One solution in words: singularity with the axis held, travel exceeded, residuals. Empty if there is nothing to say.
std::string describe(const Machine& machine, const InverseSolution& solution);

/// A result in words: "unreachable: the tool misses the direction by 12.3 deg".
std::string describe(const Machine& machine, const InverseResult& result);

}  // namespace abbe
