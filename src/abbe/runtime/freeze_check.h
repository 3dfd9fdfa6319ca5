#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "abbe/runtime/freeze.h"
#include "abbe/runtime/freeze_states.h"

namespace abbe {

/// Positions between which all error motions of an axis are known.
std::array<double, 2> map_of(const ErrorSet& errors, std::size_t axis);

/// Commands of an axis, within its travel, at which it is in its map wherever the axes stand that it is coupled to; the
/// travel if there are none. Not of endless axes.
std::array<double, 2> commands_in_map(const Machine& machine, const ErrorSet& errors, std::size_t axis);

/// How far the tool point moves at most per unit of each given factor, over the poses and tools that are tried and
/// uphill from there; mm, [factors].
std::vector<double> largest_per_unit(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan,
                                     const FreezeOptions& options);

/// Largest corrections at poses and states all over travel, map and ranges and at three tool lengths, and uphill from
/// there: FrozenCompensation's largest_correction, with where, and largest_correction_turn.
void survey_corrections(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                        const FrozenStatePlan& plan, FrozenCompensation& result);

/// Loads the bytes of a frozen compensation, largest corrections included, and compares its calls with the full model
/// at the same poses and states; fills in what else FrozenCompensation says of them, or a problem.
void freeze_check(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                  const FrozenStatePlan& plan, FrozenCompensation& result);

}  // namespace abbe
