#include "abbe/plan/scans/turning_axis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle.h"

namespace abbe {
namespace {

using std::numbers::pi;

/// The command nearest to zero that stands for an angle, within travel if there is one.
std::optional<double> within_travel(const Axis& axis, double angle) {
  const double nearest = std::remainder(angle, 2 * pi);
  if (axis.endless) return nearest;
  std::optional<double> best;
  for (int turns = -2; turns <= 2; ++turns) {
    const double command = nearest + 2 * pi * turns;
    if (command < axis.travel_min || command > axis.travel_max) continue;
    if (!best || std::abs(command) < std::abs(*best)) best = command;
  }
  return best;
}

/// Turns one of the axes between so that the direction comes nearest to the wanted one or to its opposite.
void turn_nearer(const Machine& machine, std::size_t axis, const Eigen::Vector3d& wanted, std::size_t between,
                 std::vector<double>& positions) {
  // wanted . direction = a + b cos q + c sin q
  std::array<double, 3> at{};
  std::vector<double> trial = positions;
  for (std::size_t i = 0; i < 3; ++i) {
    trial[between] = static_cast<double>(i) * pi / 2;
    at[i] = wanted.dot(axis_direction_in_workpiece(machine, axis, trial));
  }
  const double a = 0.5 * (at[0] + at[2]), b = 0.5 * (at[0] - at[2]), c = at[1] - a;
  const double from = std::abs(wanted.dot(axis_direction_in_workpiece(machine, axis, positions)));
  const double angle = std::atan2(c, b), swing = std::hypot(b, c);
  // The larger of |a + swing| and |a - swing|; of equal ones the command nearer to zero.
  struct Choice {
    double cosine, command;
  };
  std::optional<Choice> best;
  for (const double sign : {1.0, -1.0}) {
    const auto command = within_travel(machine.axes[between], sign > 0 ? angle : angle + pi);
    if (!command) continue;
    const Choice choice{std::abs(a + sign * swing), *command};
    const bool nearer = !best || choice.cosine > best->cosine + 1e-12 ||
                        (choice.cosine > best->cosine - 1e-12 && std::abs(choice.command) < std::abs(best->command));
    if (nearer) best = choice;
  }
  if (best && best->cosine > from + 1e-15) positions[between] = best->command;
}

}  // namespace

Eigen::Vector3d axis_direction_in_workpiece(const Machine& machine, std::size_t axis,
                                            const std::vector<double>& positions) {
  Eigen::Vector3d direction = machine.axes[axis].direction;
  for (std::size_t i = axis; i-- > 0;) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    const Eigen::Matrix3d rotation = nominal_motion(machine.axes[i], positions[i]).rotation;
    direction = machine.axes[i].side == ChainSide::tool ? Eigen::Vector3d(rotation * direction)
                                                        : Eigen::Vector3d(rotation.transpose() * direction);
  }
  return machine.bed_from_workpiece.rotation.transpose() * direction;
}

std::optional<TurningAxis> turning_axis(const Machine& machine, const Eigen::Vector3d& direction) {
  std::optional<TurningAxis> best;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    if (machine.axes[axis].kind != AxisKind::rotary) continue;
    std::vector<std::size_t> between;
    for (std::size_t i = 0; i < axis; ++i) {
      if (machine.axes[i].kind == AxisKind::rotary) between.push_back(i);
    }
    // One axis between: exact at once. More: one after the other, from several starts.
    const int starts = between.size() < 2 ? 1 : 8, rounds = between.size() < 2 ? 1 : 40;
    for (int start = 0; start < starts; ++start) {
      std::vector<double> positions(machine.axes.size(), 0.0);
      for (std::size_t k = 0; k < between.size(); ++k) {
        const double spread = start == 0 ? 0 : (start * static_cast<double>(k + 1)) * 0.785;
        positions[between[k]] =
            within_travel(machine.axes[between[k]], spread)
                .value_or(std::clamp(0.0, machine.axes[between[k]].travel_min, machine.axes[between[k]].travel_max));
      }
      for (int round = 0; round < rounds; ++round) {
        for (const std::size_t i : between) turn_nearer(machine, axis, direction, i, positions);
      }
      Eigen::Vector3d is = axis_direction_in_workpiece(machine, axis, positions);
      if (is.dot(direction) < 0) is = -is;
      const double tilt = angle_between(is, direction);
      if (!best || tilt < best->tilt - 1e-9) best = TurningAxis{axis, is, tilt, positions};
    }
  }
  return best;
}

}  // namespace abbe
