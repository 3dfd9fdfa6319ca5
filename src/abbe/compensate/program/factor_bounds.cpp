#include "abbe/compensate/program/factor_bounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"

namespace abbe {

void BoundAlong::add(const BoundAlong& other) {
  value += other.value;
  rate += other.rate;
  second += other.second;
  lag += other.lag;
}

BoundAlong product_along(const BoundAlong& a, const BoundAlong& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.second * b.value + 2 * a.rate * b.rate + a.value * b.second, a.lag * b.value + a.value * b.lag};
}

FactorBounds::FactorBounds(const Machine& machine, const ErrorSet& errors)
    : states_(machine.states), used_(used_states(machine, errors)), torques_(machine.states.size()) {
  any_ = std::any_of(used_.begin(), used_.end(), [](std::uint8_t used) { return used != 0; });
  for (const Axis& axis : machine.axes) rotary_.push_back(axis.kind == AxisKind::rotary);
  for (std::size_t j = 0; j < states_.size(); ++j) {
    if (used_[j] != 0 && states_[j].kind == StateKind::gravity) torques_[j] = torque_of(machine, states_[j]);
  }
}

FactorBounds::Torque FactorBounds::torque_of(const Machine& machine, const MachineState& state) const {
  // From the bed outwards, the axes of the workpiece have falling indices.
  const bool on_workpiece = machine.axes[state.axis].side == ChainSide::workpiece;
  const auto inner = [&](std::size_t i) { return on_workpiece ? i + 1 : i - 1; };
  const std::size_t bed = on_workpiece ? machine.workpiece_axis_count() : machine.workpiece_axis_count() - 1;
  Torque torque;
  const double gravity = machine.gravity.norm();
  if (gravity > 0) torque.level = machine.axes[state.axis].direction.cross(machine.gravity).norm() / gravity;
  for (std::size_t i = inner(state.axis); i != bed; i = inner(i)) {
    if (rotary_[i]) torque.turning.push_back(i);
  }
  for (const GravityLoad& load : state.loads) {
    Arm arm;
    arm.weight = 1e-3 * load.mass_kg * gravity;
    arm.length = (load.point - machine.axes[load.carried_by].point).norm();
    for (std::size_t i = load.carried_by;; i = inner(i)) {
      const bool last = i == state.axis;
      const double further = last ? 0 : (machine.axes[i].point - machine.axes[inner(i)].point).norm();
      arm.inwards.emplace_back(i, further);
      if (last) break;
    }
    torque.arms.push_back(std::move(arm));
  }
  return torque;
}

/// Seen from the base of the axis, its line stands still: the masses move by the axes outside it, and gravity turns by
/// those between it and the bed. The torque is arm . (gravity x line).
BoundAlong FactorBounds::torque_along(const Torque& torque, const CommandsAlong& commands) const {
  BoundAlong down{torque.level, 0, 0, 0};
  for (const std::size_t i : torque.turning) {
    down.value += std::max(std::abs(commands.lowest[i]), std::abs(commands.highest[i]));
    down.rate += commands.speed[i];
    down.second += commands.bend[i];
    down.lag += commands.lag[i];
  }
  down.value = std::min(down.value, 1.0);
  down.second += down.rate * down.rate;
  BoundAlong sum;
  for (const Arm& arm : torque.arms) {
    BoundAlong place{arm.length, 0, 0, 0};
    for (const auto& [i, further] : arm.inwards) {
      if (rotary_[i]) {
        const double speed = commands.speed[i];
        place.second += 2 * speed * place.rate + (speed * speed + commands.bend[i]) * place.value;
        place.rate += speed * place.value;
        place.lag += commands.lag[i] * place.value;
      } else {
        place.add({std::max(std::abs(commands.lowest[i]), std::abs(commands.highest[i])), commands.speed[i],
                   commands.bend[i], commands.lag[i]});
      }
      place.value += further;
    }
    const BoundAlong one = product_along(place, down);
    sum.add({arm.weight * one.value, arm.weight * one.rate, arm.weight * one.second, arm.weight * one.lag});
  }
  return sum;
}

BoundAlong FactorBounds::one_along(std::size_t state, const CommandsAlong& commands) const {
  const MachineState& one = states_[state];
  switch (one.kind) {
    case StateKind::axis: {
      const std::size_t i = one.axis;
      const double furthest =
          std::max(std::abs(commands.lowest[i] - one.reference), std::abs(commands.highest[i] - one.reference));
      return {furthest, commands.speed[i], commands.bend[i], commands.lag[i]};
    }
    case StateKind::approach:
      return {1, 0, 0, 0};
    case StateKind::gravity:
      return torque_along(torques_[state], commands);
    case StateKind::product:
      return product_along(one_along(one.first, commands), one_along(one.second, commands));
    case StateKind::measured:
    case StateKind::lag:
      break;  // whoever corrects programs takes the errors at values of these
  }
  return {};
}

void FactorBounds::along(const CommandsAlong& commands, std::array<BoundAlong, kMaxStates>& factors) const {
  for (std::size_t j = 0; j < states_.size(); ++j) factors[j] = used_[j] == 0 ? BoundAlong{} : one_along(j, commands);
}

}  // namespace abbe
