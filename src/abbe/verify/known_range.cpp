#include "abbe/verify/known_range.h"

#include <algorithm>

#include "abbe/machine/coupling.h"

namespace abbe {

bool narrow_to_known_range(const Machine& machine, const ErrorSet& errors, std::size_t axis, AxisRange& range) {
  if (!is_coupled(machine, axis) || machine.axes[axis].endless) return narrow_to_known_positions(errors, axis, range);
  const PositionLimits limits = position_limits(machine, axis);
  AxisRange known{.from = limits.from, .to = limits.to};
  if (!narrow_to_known_positions(errors, axis, known)) return false;
  const PositionLimits commands = commands_within(machine, axis, {known.from, known.to});
  const AxisRange narrowed{std::max(range.from, commands.from), std::min(range.to, commands.to), range.count,
                           range.step};
  // Where the others alone lead out of the range no commands stay within it: poses are then left out one by one.
  if (!(narrowed.from < narrowed.to)) return false;
  const bool changes = narrowed.from != range.from || narrowed.to != range.to;
  range = narrowed;
  return changes;
}

bool narrow_to_known_positions(const ErrorSet& errors, std::size_t axis, AxisRange& range) {
  const double from = range.from, to = range.to;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != axis || motion.basis.periodic) continue;
    const Basis& basis = motion.basis;
    if (basis.kind == BasisKind::fourier && basis.to - basis.from >= basis.period * (1 - 1e-9)) continue;
    range.from = std::max(range.from, basis.from);
    range.to = std::min(range.to, basis.to);
  }
  return range.from != from || range.to != to;
}

AxisRange known_range(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t count) {
  AxisRange range = full_ranges(machine, count)[axis];
  narrow_to_known_range(machine, errors, axis, range);
  range.count = range.is_fixed() ? 1 : count;
  return range;
}

std::vector<AxisRange> common_known_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors,
                                           std::size_t count) {
  std::vector<AxisRange> ranges;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    AxisRange range = known_range(machine, *errors.front(), i, count);
    for (const ErrorSet* set : errors) {
      const AxisRange other = known_range(machine, *set, i, count);
      if (std::max(range.from, other.from) > std::min(range.to, other.to)) continue;
      range.from = std::max(range.from, other.from);
      range.to = std::min(range.to, other.to);
    }
    range.count = range.is_fixed() ? 1 : count;
    ranges.push_back(range);
  }
  return ranges;
}

}  // namespace abbe
