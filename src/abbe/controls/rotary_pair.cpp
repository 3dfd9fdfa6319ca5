#include "abbe/controls/rotary_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr double kParallel = 1e-9;

[[noreturn]] void refuse_chain(const std::string& format, const std::string& why, const std::string& expected) {
  throw InputError({.field = "--for " + format}, why, expected + "; --for values takes every machine");
}

/// One along each of X, Y, Z, positive where the tool moves that way against the workpiece.
void check_linear_directions(const Machine& machine, const std::string& format) {
  std::vector<std::size_t> along(3, 0);
  std::size_t count = 0;
  for (const Axis& axis : machine.axes) {
    if (axis.kind != AxisKind::linear) continue;
    ++count;
    const double against = axis.side == ChainSide::workpiece ? -axis.sense() : axis.sense();
    const Eigen::Vector3d moves = against * axis.direction;
    std::size_t found = 3;
    for (std::size_t k = 0; k < 3; ++k) {
      if ((moves - Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k))).norm() < kParallel) found = k;
    }
    if (found == 3) {
      refuse_chain(format, fmt::format("{} does not move the tool along +X, +Y or +Z of the workpiece", axis.name),
                   "linear axes along X, Y and Z with the signs of ISO 841");
    }
    ++along[found];
  }
  if (count != 3 || along[0] != 1 || along[1] != 1 || along[2] != 1) {
    refuse_chain(format,
                 count == 3 ? "two linear axes are parallel" : fmt::format("the machine has {} linear axes", count),
                 "three linear axes, one along each of X, Y and Z");
  }
}

}  // namespace

void require_linear_axes(const Machine& machine, const std::string& format) {
  check_linear_directions(machine, format);
  // From the workpiece to the bed, and from the bed to the tool: rotary axes are outside.
  const std::size_t table_axes = machine.workpiece_axis_count();
  const auto is_rotary = [](const Axis& axis) { return axis.kind == AxisKind::rotary; };
  const auto begin = machine.axes.begin(), bed = begin + static_cast<std::ptrdiff_t>(table_axes);
  for (auto axis = begin; axis != machine.axes.end(); ++axis) {
    if (is_rotary(*axis)) continue;
    const bool carried = axis < bed ? std::any_of(axis + 1, bed, is_rotary) : std::any_of(bed, axis, is_rotary);
    if (carried) {
      refuse_chain(format, fmt::format("a rotary axis carries {}", axis->name),
                   "rotary axes next to the workpiece and to the tool");
    }
  }
}

RotaryPair rotary_pair(const Machine& machine, const std::string& format) {
  std::vector<std::size_t> of_table, of_head;
  const std::size_t table_axes = machine.workpiece_axis_count();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::rotary) (i < table_axes ? of_table : of_head).push_back(i);
  }
  const std::size_t count = of_table.size() + of_head.size();
  if (count != 2) {
    refuse_chain(format, fmt::format("the machine has {} rotary {}", count, count == 1 ? "axis" : "axes"),
                 "two rotary axes");
  }
  require_linear_axes(machine, format);
  if (of_table.size() == 2) return {RotaryPairKind::table, of_table[1], of_table[0]};
  if (of_head.size() == 2) return {RotaryPairKind::head, of_head[0], of_head[1]};
  return {RotaryPairKind::mixed, of_head[0], of_table[0]};
}

}  // namespace abbe
