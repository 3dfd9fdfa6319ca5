#include "abbe/machine/coupling.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/angle_units.h"

namespace abbe {

bool is_coupled(const Machine& machine, std::size_t axis) {
  return std::any_of(machine.couplings.begin(), machine.couplings.end(),
                     [axis](const AxisCoupling& coupling) { return coupling.axis == axis; });
}

void positions_of_commands(const Machine& machine, const double* commands, double* positions) {
  std::copy_n(commands, machine.axes.size(), positions);
  for (const AxisCoupling& coupling : machine.couplings) {
    positions[coupling.axis] += coupling.ratio * commands[coupling.of];
  }
}

std::vector<double> positions_of_commands(const Machine& machine, std::span<const double> commands) {
  std::vector<double> positions(commands.size());
  positions_of_commands(machine, commands.data(), positions.data());
  return positions;
}

void commands_of_positions(const Machine& machine, const double* positions, double* commands) {
  std::copy_n(positions, machine.axes.size(), commands);
  if (machine.couplings.empty()) return;
  const CouplingOrder order = coupling_order(machine);
  for (std::size_t k = 0; k < order.count; ++k) {
    const std::size_t axis = order.axis[k];
    commands[axis] = positions[axis] - coupled_part(machine, axis, commands);
  }
}

double coupled_part(const Machine& machine, std::size_t axis, const double* commands) {
  double sum = 0;
  for (const AxisCoupling& coupling : machine.couplings) {
    if (coupling.axis == axis) sum += coupling.ratio * commands[coupling.of];
  }
  return sum;
}

CouplingOrder coupling_order(const Machine& machine) {
  CouplingOrder order;
  const std::size_t axes = std::min(machine.axes.size(), kMaxAxes);
  std::array<bool, kMaxAxes> placed{};
  const auto waits = [&](std::size_t axis) {
    return std::any_of(machine.couplings.begin(), machine.couplings.end(), [&](const AxisCoupling& coupling) {
      return coupling.axis == axis && coupling.of < axes && !placed[coupling.of];
    });
  };
  for (bool found = true; found;) {
    found = false;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      if (placed[axis] || waits(axis)) continue;
      placed[axis] = found = true;
      order.axis[order.count++] = axis;
    }
  }
  return order;
}

std::vector<AxisCoupling> couplings_in_order(const Machine& machine) {
  std::vector<AxisCoupling> couplings = machine.couplings;
  if (couplings.empty()) return couplings;
  const CouplingOrder order = coupling_order(machine);
  const auto place = [&](const AxisCoupling& coupling) {
    return std::find(order.axis.begin(), order.axis.begin() + static_cast<std::ptrdiff_t>(order.count), coupling.of) -
           order.axis.begin();
  };
  std::stable_sort(couplings.begin(), couplings.end(),
                   [&](const AxisCoupling& a, const AxisCoupling& b) { return place(a) < place(b); });
  return couplings;
}

void slopes_by_commands(const Machine& machine, double* slopes) {
  for (const AxisCoupling& coupling : couplings_in_order(machine)) {
    slopes[coupling.of] += coupling.ratio * slopes[coupling.axis];
  }
}

namespace {

/// What the axes that it is coupled to add to the position of an axis, within their travels.
PositionLimits part_of_others(const Machine& machine, std::size_t axis) {
  PositionLimits part;
  for (const AxisCoupling& coupling : machine.couplings) {
    if (coupling.axis != axis) continue;
    const Axis& of = machine.axes[coupling.of];
    const double one = coupling.ratio * of.travel_min, other = coupling.ratio * of.travel_max;
    part.from += std::min(one, other);
    part.to += std::max(one, other);
  }
  return part;
}

}  // namespace

PositionLimits position_limits(const Machine& machine, std::size_t axis) {
  const Axis& one = machine.axes[axis];
  PositionLimits limits{one.travel_min, one.travel_max};
  if (one.endless || !is_coupled(machine, axis)) return limits;
  const PositionLimits others = part_of_others(machine, axis);
  return {limits.from + others.from, limits.to + others.to};
}

PositionLimits commands_within(const Machine& machine, std::size_t axis, const PositionLimits& limits) {
  if (!is_coupled(machine, axis)) return limits;
  const PositionLimits others = part_of_others(machine, axis);
  return {limits.from - others.from, limits.to - others.to};
}

std::string first_coupling(const Machine& machine) {
  if (machine.couplings.empty()) return {};
  const AxisCoupling& first = machine.couplings.front();
  return machine.axes[first.axis].name + " is coupled to " + machine.axes[first.of].name;
}

std::string position_formula(const Machine& machine, std::size_t axis) {
  std::string text;
  for (const AxisCoupling& coupling : machine.couplings) {
    if (coupling.axis != axis) continue;
    const Axis &one = machine.axes[axis], &of = machine.axes[coupling.of];
    const bool same = one.kind == of.kind, rotary = one.kind == AxisKind::rotary;
    const double ratio = same ? coupling.ratio : rotary ? coupling.ratio / kDegree : coupling.ratio * kDegree;
    text += fmt::format("{} {} {:.10g}{} {}", text.empty() ? one.name + " = command" : "", ratio < 0 ? "-" : "+",
                        std::abs(ratio),
                        same     ? ""
                        : rotary ? " deg/mm"
                                 : " mm/deg",
                        of.name);
  }
  return text;
}

}  // namespace abbe
