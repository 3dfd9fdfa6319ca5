#pragma once

#include <cstdint>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Where one axis may be during a measurement; mm or rad.
///
/// Aguado et al., fig. 5, for X, Z, C: A) three full ranges; B) C fixed, X and Z full; C) X and Z fixed, C full.
struct AxisRange {
  double from = 0;
  double to = 0;          ///< equal to from: the axis is held there
  std::size_t count = 5;  ///< grid: number of positions
  double step = 0;        ///< random: positions are whole multiples of it; 0: any

  static AxisRange fixed(double position) { return {position, position, 1, 0}; }
  bool is_fixed() const { return from == to; }
};

/// Full travel of all axes; endless rotary axes one turn from 0. On a grid the last position of a whole turn is left
/// out, so that none is measured twice.
std::vector<AxisRange> full_ranges(const Machine& machine, std::size_t count_per_axis);

/// All combinations, in boustrophedon order: from one pose to the next only one axis moves by one step. Poses:
/// product of the counts (a fixed axis counts one). The last axis moves most often.
/// @throws std::invalid_argument, as all plans: ranges not one per axis, outside the travel, or count 0
PoseList grid_plan(const Machine& machine, const std::vector<AxisRange>& ranges);

/// `count` poses on a straight line (in axis space) from all `from` to all `to`, both included;
/// `to` may be below `from`, as in step_diagonal_plan().
PoseList line_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count);

/// From all `from` to all `to` in equal steps, one axis moving at a time: sequential step diagonal. In every step the
/// axes move one after the other in `order`; a pose follows each of these moves.
/// @param order  axes that move, in their order within a step; indices into the chain, each once
/// @return 1 + steps * order.size() poses
/// @throws std::invalid_argument also if an axis with a range is not in `order`, or steps is 0
/// Source: Wang, Review of Scientific Instruments 71 (2000) 3933; its limits: docs/interferometer.md.
PoseList step_diagonal_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t steps,
                            const std::vector<std::size_t>& order);

/// `count` poses uniform over the ranges. Pose k depends on seed and k only.
PoseList random_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count,
                     std::uint64_t seed);

/// `count` poses on an Archimedean spiral of `turns` turns, evenly spaced in area, in the ellipse that touches the
/// ranges of two axes; the other axes run evenly from `from` to `to`.
PoseList spiral_plan(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count, double turns,
                     std::size_t first_axis, std::size_t second_axis);

/// Same poses, shorter travel: nearest neighbour from the first pose, then improvement by reversing parts (2-opt) until
/// nothing within 50 neighbours helps. Distance: largest axis travel in units of that axis's whole range.
PoseList order_by_travel(const Machine& machine, const PoseList& poses);

/// Sum of the distances order_by_travel() minimises.
double travel(const Machine& machine, const PoseList& poses);

/// One plan after the other.
PoseList join(const PoseList& first, const PoseList& second);

}  // namespace abbe
