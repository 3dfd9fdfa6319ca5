#include "abbe/runtime/frozen_correction.h"

#include <algorithm>
#include <cmath>

#include "abbe/runtime/frozen_system.h"

namespace abbe {
namespace {

constexpr double kPositionTolerance = 1e-9;      // mm; what counts as reached
constexpr double kOrientationTolerance = 1e-11;  // rad
constexpr double kLever = 1000;                  // mm; a turn counts as what it moves there
constexpr double kOwnPart = 0.01;                // of a turn that counts though it does nothing to the pose
constexpr double kRest = 1e-13;                  // mm; an expected next step below this is not taken
constexpr double kFirstRate = 1e-3;              // of one step to the next, before it has been seen
constexpr double kRounding = 4e-16;              // steps below this of the lengths involved are rounding
constexpr double kStanding = 0.5;                // steps that no longer become shorter than by this,
constexpr double kStandingStep = 1e-11;          // mm, and are shorter than this, are rounding too
constexpr double kDependent = 1e-9;              // determinant of three unit directions

/// Shortest rotation vector that turns one unit vector to another.
Triple turn_between(const Triple& from, const Triple& to) {
  const Triple axis = cross(from, to);
  const double square = dot(axis, axis), cosine = dot(from, to);
  if (cosine > 0 && square < 1e-6) return (1 + square * (1.0 / 6 + square * (3.0 / 40))) * axis;
  const double sine = std::sqrt(square);
  return sine > 0 ? (std::atan2(sine, cosine) / sine) * axis : Triple{};
}

/// Says when no further step is worth taking.
class Convergence {
 public:
  /// @param step  what it does to the pose, mm
  bool reached(double step, double size) {
    const double rate = last_ > 0 ? std::min(1.0, std::max(step / last_, 1e-6)) : kFirstRate;
    last_ = step;
    return step * rate <= kRest || step <= kRounding * (kLever + size) || (rate > kStanding && step <= kStandingStep);
  }

 private:
  double last_ = 0;
};

double component(const Triple& a, std::size_t k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }

/// How far two sets have moved from the same commands, in the units of the systems.
std::array<double, 2> turns(const abbe_runtime& machine, const FrozenCommands& from, const FrozenCommands& to) {
  std::array<double, 2> y{};
  for (std::size_t k = 0; k < machine.turning.count; ++k) {
    const std::size_t i = machine.turning.axis[k];
    y[k] = to.by[i] - from.by[i];
  }
  return y;
}
Triple shifts(const abbe_runtime& machine, const FrozenCommands& from, const FrozenCommands& to) {
  double z[3] = {};
  for (std::size_t k = 0; k < machine.reaching.count; ++k) {
    const std::size_t i = machine.reaching.axis[k];
    z[k] = (to.by[i] - from.by[i]) / machine.reaching_unit[k];
  }
  return {z[0], z[1], z[2]};
}

/// Sets `commands` to those of `from` plus sign times turns y and shifts z.
void set_from(const abbe_runtime& machine, const FrozenCommands& from, double sign, const std::array<double, 2>& y,
              const Triple& z, bool reach, FrozenCommands& commands) {
  for (std::size_t k = 0; k < machine.turning.count; ++k) {
    const std::size_t i = machine.turning.axis[k];
    move_axis(machine.axis[i], i, from, sign * y[k], commands);
  }
  if (!reach) return;
  for (std::size_t k = 0; k < machine.reaching.count; ++k) {
    const std::size_t i = machine.reaching.axis[k];
    move_axis(machine.axis[i], i, from, sign * machine.reaching_unit[k] * component(z, k), commands);
  }
}

/// How turns move the point.
Triple moved_by(const abbe_runtime& machine, const NominalView& view, const Triple& goal,
                const std::array<double, 2>& turn) {
  Triple sum{};
  for (std::size_t k = 0; k < machine.turning.count; ++k) {
    const std::size_t i = machine.turning.axis[k];
    sum = sum + turn[k] * cross(view.column[i], goal - view.origin[i]);
  }
  return sum;
}

/// What turns do to the pose, mm. Near a singularity it is little, but where the turn is bounded it still matters which
/// one it is.
double effect_of(const TurnSystem& system, const std::array<double, 2>& turn) {
  return kLever * (length(system.of(turn)) + kOwnPart * (std::abs(turn[0]) + std::abs(turn[1])));
}

int status_of(const abbe_runtime& machine, const Triple& point_left, const Triple& orientation_left,
              bool turn_bounded) {
  if (length(point_left) > kPositionTolerance) return ABBE_POSITION_LEFT;
  if (machine.turning.count > 0 && length(orientation_left) > kOrientationTolerance)
    return turn_bounded ? ABBE_TURN_LIMITED : ABBE_ORIENTATION_LEFT;
  return ABBE_OK;
}

}  // namespace

FrozenResult solve_actual(const abbe_runtime& machine, const FrozenCommands& nominal, const NominalView& view,
                          const Triple& goal, const Triple& tool, double enable, FrozenCommands& actual) {
  const TurnSystem turn_system(machine, view);
  const ReachSystem reach_system(machine, view, goal);
  Convergence convergence;
  FrozenResult found;
  std::array<double, 2> y = turns(machine, nominal, actual);
  Triple z = shifts(machine, nominal, actual);
  while (found.iterations < ABBE_RUNTIME_ITERATIONS) {
    ++found.iterations;
    const ActualTool at = actual_tool(machine, actual, tool, enable);
    bool turn_bounded = false, shift_bounded = false;
    const Triple c = turn_between(at.direction, view.direction) + turn_system.of(y);
    const std::array<double, 2> new_y = turn_system.solve(c, machine.largest_turn, turn_bounded);
    const std::array<double, 2> by_turn{new_y[0] - y[0], new_y[1] - y[1]};
    const Triple rest = goal - at.point - moved_by(machine, view, goal, by_turn) + reach_system.of(z);
    const Triple new_z = reach_system.solve(rest, machine.largest_shift, shift_bounded);
    const double step = length(reach_system.of(new_z - z)) + effect_of(turn_system, by_turn);
    y = new_y;
    z = new_z;
    set_from(machine, nominal, 1, y, z, true, actual);
    if (convergence.reached(step, length(goal))) {
      found.result = status_of(machine, rest - reach_system.of(z), c - turn_system.of(y), turn_bounded);
      return found;
    }
  }
  found.result = ABBE_NOT_CONVERGED;
  return found;
}

FrozenResult solve_nominal(const abbe_runtime& machine, const FrozenCommands& actual, const Triple& tool, double enable,
                           FrozenCommands& nominal, Triple& point) {
  const ActualTool at = actual_tool(machine, actual, tool, enable);
  point = at.point;
  // Where the linear axes take any point, it is theirs whatever their commands: only the turns are unknown.
  const bool reach = !machine.reaching_linear;
  Convergence convergence;
  FrozenResult found;
  std::array<double, 2> y = turns(machine, nominal, actual);
  Triple z = shifts(machine, nominal, actual);
  while (found.iterations < ABBE_RUNTIME_ITERATIONS) {
    ++found.iterations;
    const NominalView view = nominal_view(machine, nominal, tool, !reach);
    const TurnSystem turn_system(machine, view);
    bool turn_bounded = false, shift_bounded = false;
    const Triple c = turn_between(at.direction, view.direction) + turn_system.of(y);
    const std::array<double, 2> new_y = turn_system.solve(c, machine.largest_turn, turn_bounded);
    const std::array<double, 2> by_turn{new_y[0] - y[0], new_y[1] - y[1]};
    double step = effect_of(turn_system, by_turn);
    Triple point_left{};
    y = new_y;
    if (reach) {
      const ReachSystem reach_system(machine, view, view.point);
      const Triple rest = view.point - at.point - moved_by(machine, view, view.point, by_turn) + reach_system.of(z);
      const Triple new_z = reach_system.solve(rest, machine.largest_shift, shift_bounded);
      step += length(reach_system.of(new_z - z));
      point_left = rest - reach_system.of(new_z);
      z = new_z;
    }
    set_from(machine, actual, -1, y, z, reach, nominal);
    if (convergence.reached(step, length(at.point))) {
      found.result = status_of(machine, point_left, c - turn_system.of(y), turn_bounded);
      return found;
    }
  }
  found.result = ABBE_NOT_CONVERGED;
  return found;
}

bool solve_point(const abbe_runtime& machine, const NominalView& view, const Triple& point, FrozenCommands& commands) {
  const Triple& a = view.column[machine.solved.axis[0]];
  const Triple& b = view.column[machine.solved.axis[1]];
  const Triple& c = view.column[machine.solved.axis[2]];
  const Triple normal = cross(b, c);
  const double determinant = dot(a, normal);
  if (!(std::abs(determinant) > kDependent)) return false;
  const Triple rest = point - view.point;
  const Triple found = (1 / determinant) * Triple{dot(normal, rest), dot(cross(c, a), rest), dot(cross(a, b), rest)};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = machine.solved.axis[k];
    set_axis(machine.axis[i], i, component(found, k), commands);
  }
  return true;
}

}  // namespace abbe
