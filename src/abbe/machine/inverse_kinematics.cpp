#include "abbe/machine/inverse_kinematics.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/orientation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A command beyond its travel by less than this is rounding: it is set to the limit.
constexpr double kLinearSlack = 1e-9;   // mm
constexpr double kRotarySlack = 1e-11;  // rad
/// Determinant of three unit directions below which they count as dependent in a pose.
constexpr double kDependentDeterminant = 1e-9;
/// Amplitude (mm) below which the turn of a polar axis moves the point nowhere that matters.
constexpr double kNoEffect = 1e-9;
/// Rotary moves count as this many mm per rad when solutions are put in order.
constexpr double kOrderRadius = 100;

double slack(const Axis& axis) { return axis.kind == AxisKind::linear ? kLinearSlack : kRotarySlack; }

/// Linear system for the position: columns * commands of the linear axes = rest, in the frame of the bed's chain.
struct LinearSystem {
  Matrix3d columns = Matrix3d::Zero();
  Vector3d rest = Vector3d::Zero();
};

LinearSystem linear_system(const Machine& machine, const InversePlan& plan, const Vector3d& point,
                           const std::array<double, kMaxAxes>& position) {
  LinearSystem system;
  RigidTransform carried;  // from the bed's side of the workpiece to the body carried so far
  std::size_t next = 0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const double displacement = chain_sign(axis) * position[i];
    if (axis.kind == AxisKind::rotary) {
      const Matrix3d turn = rotation_about(axis.direction, displacement);
      carried = carried * RigidTransform{turn, axis.point - turn * axis.point};
    } else if (next < plan.linear_count && plan.linear[next] == i) {
      system.columns.col(static_cast<Eigen::Index>(next++)) = chain_sign(axis) * (carried.rotation * axis.direction);
    } else {
      carried.translation += displacement * (carried.rotation * axis.direction);
    }
  }
  system.rest = machine.bed_from_workpiece * point - carried * (machine.tool_reference + machine.tool_offset);
  return system;
}

/// Roots of a + b cos t + c sin t; if there are none, the turn nearest to one.
int roots_of_first_harmonic(double a, double b, double c, std::array<double, 2>& roots) {
  const double amplitude = std::hypot(b, c), phase = std::atan2(c, b);
  if (std::abs(a) >= amplitude) {
    roots[0] = a > 0 ? phase + std::numbers::pi : phase;
    return 1;
  }
  const double half = std::atan2(std::sqrt((amplitude - a) * (amplitude + a)), -a);
  roots = {phase + half, phase - half};
  return 2;
}

bool is_sound(const PoseTarget& target) {
  if (!target.point.allFinite()) return false;
  if (target.kind == TargetKind::point_and_direction) {
    return target.direction.allFinite() && target.direction.stableNorm() > 0;
  }
  if (target.kind == TargetKind::full_pose) {
    const Matrix3d& r = target.orientation;
    return r.allFinite() && (r.transpose() * r - Matrix3d::Identity()).norm() < 1e-9 && r.determinant() > 0;
  }
  return true;
}

double distance(const Machine& machine, const InverseSolution& solution, const double* start) {
  double sum = 0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const double move = solution.position[i] - start[i];
    const double weight = machine.axes[i].kind == AxisKind::rotary ? kOrderRadius : 1;
    sum += weight * weight * move * move;
  }
  return std::sqrt(sum);
}

}  // namespace

PoseTarget PoseTarget::at(const Vector3d& point) {
  PoseTarget target;
  target.point = point;
  return target;
}

PoseTarget PoseTarget::at(const Vector3d& point, const Vector3d& direction) {
  PoseTarget target;
  target.kind = TargetKind::point_and_direction;
  target.point = point;
  target.direction = direction;
  return target;
}

PoseTarget PoseTarget::at(const RigidTransform& workpiece_from_tool) {
  PoseTarget target;
  target.kind = TargetKind::full_pose;
  target.point = workpiece_from_tool.translation;
  target.orientation = workpiece_from_tool.rotation;
  return target;
}

/// A solution on its way: rotary commands known, linear ones not yet.
struct InverseKinematics::Candidate {
  InverseSolution solution;
  std::uint32_t turning = 0;  ///< bit per rotary axis found from the target, which may add full turns
  bool orientation_reached = true;
};

InverseKinematics::InverseKinematics(const Machine& machine, const InverseOptions& options)
    : machine_(machine), options_(options) {
  const std::vector<MachineProblem> problems = find_problems(machine);
  if (!problems.empty()) {
    problem_ = problems.front().text();
    return;
  }
  if (!options.reference.empty() && options.reference.size() != machine.axes.size()) {
    problem_ = "the reference position has " + std::to_string(options.reference.size()) + " commands, the machine " +
               std::to_string(machine.axes.size()) + " axes";
    return;
  }
  for (const HeldAxis& held : options.held) {
    if (held.axis >= machine.axes.size() || !std::isfinite(held.position)) {
      problem_ = "a held axis does not exist or its command is not finite";
      return;
    }
  }
  for (double command : options.reference) {
    if (!std::isfinite(command)) problem_ = "a command of the reference position is not finite";
  }
  if (!problem_.empty()) return;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const double nearest_zero = axis.endless ? 0 : std::clamp(0.0, axis.travel_min, axis.travel_max);
    reference_[i] = options.reference.empty() ? nearest_zero : options.reference[i];
  }
  order_ = coupling_order(machine_);
  const std::array<double, kMaxAxes> positions = held_positions();
  if (!problem_.empty()) return;
  for (std::size_t kind = 0; kind < plans_.size(); ++kind) {
    plans_[kind] = make_inverse_plan(machine_, static_cast<TargetKind>(kind), options_.held,
                                     {positions.data(), machine_.axes.size()});
  }
}

std::array<double, kMaxAxes> InverseKinematics::held_positions() {
  if (machine_.couplings.empty()) return reference_;
  std::array<double, kMaxAxes> commands = reference_, positions{};
  const auto is_held = [&](std::size_t axis) {
    return std::any_of(options_.held.begin(), options_.held.end(),
                       [axis](const HeldAxis& held) { return held.axis == axis; });
  };
  for (const HeldAxis& held : options_.held) commands[held.axis] = held.position;
  for (const AxisCoupling& coupling : machine_.couplings) {
    if (!is_held(coupling.axis) || is_held(coupling.of)) continue;
    const std::string &axis = machine_.axes[coupling.axis].name, &of = machine_.axes[coupling.of].name;
    problem_ = axis + " cannot be held alone: it is coupled to " + of + "; hold " + of + " too";
  }
  positions_of_commands(machine_, commands.data(), positions.data());
  for (HeldAxis& held : options_.held) held.position = positions[held.axis];
  return positions;
}

std::vector<HeldAxis> InverseKinematics::held_axes(TargetKind kind) const {
  const InversePlan& plan = plans_[static_cast<std::size_t>(kind)];
  std::array<double, kMaxAxes> command{};
  commands_of_positions(machine_, plan.command.data(), command.data());
  std::vector<HeldAxis> held;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    const bool polar = plan.arm_count == 0 && plan.polar_count > 0 && plan.polar[0] == i;
    if (plan.held[i] && !polar) held.push_back({i, command[i]});
  }
  return held;
}

InverseResult InverseKinematics::solve(const PoseTarget& target, const std::vector<double>& start) const {
  InverseResult result;
  solve(target, start.size() == machine_.axes.size() ? start.data() : nullptr, result);
  return result;
}

void InverseKinematics::solve(const PoseTarget& target, const double* start, InverseResult& result) const {
  result.solutions.clear();
  result.closest = {};
  result.closest.orientation_residual = result.closest.position_residual = std::numeric_limits<double>::infinity();
  const std::size_t axes = machine_.axes.size();
  const bool start_is_finite =
      start == nullptr || std::all_of(start, start + axes, [](double command) { return std::isfinite(command); });
  if (!problem_.empty() || !is_sound(target) || !start_is_finite) {
    result.status = problem_.empty() ? InverseStatus::invalid_target : InverseStatus::invalid_machine;
    return;
  }
  if (start == nullptr) start = reference_.data();
  std::array<double, kMaxAxes> start_position;
  Start both{start, start};
  if (!machine_.couplings.empty()) {
    positions_of_commands(machine_, start, start_position.data());
    both.position = start_position.data();
  }
  const InversePlan& plan = plans_[static_cast<std::size_t>(target.kind)];
  if (plan.arm_count > 0) {
    solve_arm(plan, target, both, result);
  } else {
    solve_branches(plan, target, both, result);
  }
  if (result.solutions.empty()) {
    const bool misses_orientation = result.closest.orientation_residual > options_.orientation_tolerance;
    const bool few = plan.arm_count > 0   ? false
                     : misses_orientation ? plan.rotary_count < plan.rotary_wanted
                                          : plan.linear_count + std::min<std::size_t>(plan.polar_count, 1) < 3;
    result.status = few                  ? InverseStatus::too_few_axes
                    : misses_orientation ? InverseStatus::unreachable_orientation
                                         : InverseStatus::unreachable_position;
    return;
  }
  const auto before = [&](const InverseSolution& a, const InverseSolution& b) {
    if (a.within_travel != b.within_travel) return a.within_travel;
    return distance(machine_, a, start) < distance(machine_, b, start);
  };
  std::sort(result.solutions.begin(), result.solutions.end(), before);
  result.status = result.solutions.front().within_travel ? InverseStatus::solved : InverseStatus::outside_travel;
}

void InverseKinematics::solve_branches(const InversePlan& plan, const PoseTarget& target, const Start& start,
                                       InverseResult& result) const {
  const Matrix3d& frame = machine_.bed_from_workpiece.rotation;
  const std::span<const Vector3d> axes(plan.direction.data(), plan.rotary_count);
  const std::size_t first = plan.rotary[0];
  const double held_first = plan.rotary_count > 0 ? chain_sign(machine_.axes[first]) * start.position[first] : 0;
  RotaryBranches branches;
  if (target.kind == TargetKind::point) {
    branches.count = 1;
    branches.branch[0].margin = std::numbers::pi;
  } else if (target.kind == TargetKind::point_and_direction) {
    branches = turn_direction(axes, plan.held_rotation * machine_.tool_direction,
                              frame * target.direction.stableNormalized(), held_first);
  } else {
    branches = turn_frame(axes, frame * target.orientation * plan.held_rotation.transpose(), held_first);
  }
  for (std::size_t b = 0; b < static_cast<std::size_t>(branches.count); ++b) {
    const RotaryAngles& found = branches.branch[b];
    Candidate candidate;
    InverseSolution& solution = candidate.solution;
    solution.position = plan.command;
    solution.branch = static_cast<int>(2 * b);
    solution.singular_margin = plan.rotary_count == 0 ? std::numbers::pi : found.margin;
    candidate.orientation_reached = found.miss <= options_.orientation_tolerance;
    for (std::size_t k = 0; k < plan.rotary_count; ++k) {
      const std::size_t i = plan.rotary[k];
      solution.position[i] = chain_sign(machine_.axes[i]) * found.angle[k];
      candidate.turning |= 1U << i;
    }
    if (found.singularity == RotarySingularity::first_axis_free) {
      solution.position[first] = start.position[first];
      candidate.turning &= ~(1U << first);
      solution.singular_axis = first;
      solution.singularity =
          target.kind == TargetKind::full_pose ? PoseSingularity::axes_parallel : PoseSingularity::tool_parallel;
    } else if (found.singularity == RotarySingularity::branches_meet) {
      solution.singularity = PoseSingularity::limit_of_reach;
    }
    solve_polar(plan, target, start, candidate, result);
  }
}

void InverseKinematics::solve_polar(const InversePlan& plan, const PoseTarget& target, const Start& start,
                                    Candidate candidate, InverseResult& result) const {
  std::array<std::size_t, kMaxAxes + 1> choices{};
  std::size_t count = 0;
  if (plan.linear_count == 2 && candidate.orientation_reached) {
    if (candidate.solution.singularity == PoseSingularity::tool_parallel) {
      choices[count++] = candidate.solution.singular_axis;
    }
    for (std::size_t k = 0; k < plan.polar_count; ++k) choices[count++] = plan.polar[k];
  }
  bool on_axis = false;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t axis = choices[k];
    Candidate turned = candidate;
    // The point's distance from the plane of the two linear axes: only a first harmonic of the turn.
    std::array<double, 3> value{};
    for (std::size_t quarter = 0; quarter < 3; ++quarter) {
      turned.solution.position[axis] = 0.25 * kTurn * static_cast<double>(quarter);
      const LinearSystem system = linear_system(machine_, plan, target.point, turned.solution.position);
      value[quarter] = system.columns.col(0).cross(system.columns.col(1)).dot(system.rest);
    }
    const double constant = 0.5 * (value[0] + value[2]), cosine = 0.5 * (value[0] - value[2]);
    const double sine = value[1] - constant;
    if (std::hypot(cosine, sine) < kNoEffect) {
      on_axis = on_axis || std::abs(constant) < kNoEffect;
      continue;
    }
    std::array<double, 2> roots{};
    const int root_count = roots_of_first_harmonic(constant, cosine, sine, roots);
    turned.turning |= 1U << axis;
    if (turned.solution.singular_axis == axis) {
      turned.solution.singularity = PoseSingularity::none;
      turned.solution.singular_axis = Machine::npos;
    }
    for (int r = 0; r < root_count; ++r) {
      turned.solution.branch = candidate.solution.branch + r;
      turned.solution.position[axis] = roots[static_cast<std::size_t>(r)];
      solve_linear(plan, target, start, turned, result);
    }
    return;
  }
  if (on_axis && candidate.solution.singularity == PoseSingularity::none) {
    candidate.solution.singularity = PoseSingularity::point_on_axis;
    candidate.solution.singular_axis = choices[0];
    candidate.solution.position[choices[0]] = start.position[choices[0]];
  }
  solve_linear(plan, target, start, candidate, result);
}

void InverseKinematics::solve_linear(const InversePlan& plan, const PoseTarget& target, const Start& start,
                                     Candidate candidate, InverseResult& result) const {
  InverseSolution& solution = candidate.solution;
  const LinearSystem system = linear_system(machine_, plan, target.point, solution.position);
  const Matrix3d& a = system.columns;
  Vector3d commands = Vector3d::Zero();
  const Vector3d normal = a.col(1).cross(a.col(2));
  const double determinant = a.col(0).dot(normal);
  if (plan.linear_count == 3) solution.linear_volume = std::abs(determinant);
  if (plan.linear_count == 2) solution.linear_volume = a.col(0).cross(a.col(1)).norm();
  if (plan.linear_count == 3 && std::abs(determinant) > kDependentDeterminant) {
    commands = Vector3d(normal.dot(system.rest), a.col(2).cross(a.col(0)).dot(system.rest),
                        a.col(0).cross(a.col(1)).dot(system.rest)) /
               determinant;
  } else if (plan.linear_count > 0) {
    // Least squares; where axes are dependent, the commands nearest to the start.
    using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
    Vector3d near = Vector3d::Zero();
    for (std::size_t k = 0; k < plan.linear_count; ++k) {
      near[static_cast<Eigen::Index>(k)] = start.position[plan.linear[k]];
    }
    Eigen::CompleteOrthogonalDecomposition<Columns> factors;
    factors.setThreshold(kDependentDeterminant);
    factors.compute(a.leftCols(static_cast<Eigen::Index>(plan.linear_count)));
    const bool dependent = factors.rank() < static_cast<Eigen::Index>(plan.linear_count);
    if (!dependent) near.setZero();
    const Vector3d rest = system.rest - a * near;
    commands = near;
    commands.head(static_cast<Eigen::Index>(plan.linear_count)) += factors.solve(rest);
    if (dependent) solution.singularity = PoseSingularity::linear_dependent;
  }
  for (std::size_t k = 0; k < plan.linear_count; ++k) {
    solution.position[plan.linear[k]] = commands[static_cast<Eigen::Index>(k)];
  }
  add_turns(target, start, candidate.turning, 0, solution, result);
}

void InverseKinematics::add_turns(const PoseTarget& target, const Start& start, std::uint32_t turning,
                                  std::size_t place, InverseSolution& solution, InverseResult& result) const {
  const bool is_coupled = !machine_.couplings.empty();
  while (!is_coupled && place < order_.count && (turning >> order_.axis[place] & 1U) == 0) ++place;
  if (place >= order_.count) {
    add_solution(target, solution, result);
    return;
  }
  const std::size_t axis_index = order_.axis[place];
  const Axis& axis = machine_.axes[axis_index];
  const double position = solution.position[axis_index];
  const double found = is_coupled ? position - coupled_part(machine_, axis_index, solution.position.data()) : position;
  const auto next = [&](double command) {
    solution.position[axis_index] = command;
    add_turns(target, start, turning, place + 1, solution, result);
    solution.position[axis_index] = position;
  };
  if ((turning >> axis_index & 1U) == 0) return next(found);
  const double first = start.command[axis_index], nearest = first + std::remainder(found - first, kTurn);
  if (axis.endless) return next(nearest);
  const double low = std::ceil((axis.travel_min - kRotarySlack - nearest) / kTurn);
  const double high = std::floor((axis.travel_max + kRotarySlack - nearest) / kTurn);
  if (low > high) {
    // No equivalent within travel: the one that exceeds it least.
    const double below = nearest + kTurn * (low - 1), above = nearest + kTurn * low;
    return next(axis.travel_min - below < above - axis.travel_max ? below : above);
  }
  if (!options_.all_turns) return next(nearest + kTurn * std::clamp(0.0, low, high));
  for (double turns = low; turns <= high; ++turns) next(nearest + kTurn * turns);
}

void InverseKinematics::add_solution(const PoseTarget& target, InverseSolution solution, InverseResult& result) const {
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    const Axis& axis = machine_.axes[i];
    double& command = solution.position[i];
    if (axis.endless) continue;
    const double limited = std::clamp(command, axis.travel_min, axis.travel_max);
    if (std::abs(command - limited) <= slack(axis)) command = limited;
    solution.excess[i] = command - limited;
    if (solution.excess[i] != 0) solution.within_travel = false;
  }
  const RigidTransform reached =
      nominal_workpiece_from_tool(machine_, std::span<const double>(solution.position.data(), machine_.axes.size()));
  solution.position_residual = (reached.translation - target.point).norm();
  if (target.kind == TargetKind::point_and_direction) {
    solution.orientation_residual = angle_between(reached.rotation * machine_.tool_direction, target.direction);
  } else if (target.kind == TargetKind::full_pose) {
    solution.orientation_residual = rotation_vector(reached.rotation.transpose() * target.orientation).norm();
  }
  if (solution.orientation_residual <= options_.orientation_tolerance &&
      solution.position_residual <= options_.position_tolerance) {
    result.solutions.push_back(solution);
  }
  InverseSolution& closest = result.closest;
  const bool same_orientation =
      std::abs(solution.orientation_residual - closest.orientation_residual) <= options_.orientation_tolerance;
  if (same_orientation ? solution.position_residual < closest.position_residual
                       : solution.orientation_residual < closest.orientation_residual) {
    closest = solution;
  }
}

}  // namespace abbe
