#pragma once

// Over which ranges of its axes the errors of a machine are known.
#include <cstddef>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Narrows a range of commands of an axis to where all its error motions are known, wherever the axes are that it is
/// coupled to within their travels. If there is no such place the range stays. @returns false if it is as it was
bool narrow_to_known_range(const Machine& machine, const ErrorSet& errors, std::size_t axis, AxisRange& range);

/// The same for positions of an axis, whatever commands they have. It may become empty (from > to).
bool narrow_to_known_positions(const ErrorSet& errors, std::size_t axis, AxisRange& range);

/// Range of an axis over which all its error motions are known; the travel where it has none.
AxisRange known_range(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t count);

/// The range of every axis over which all of the given errors are known.
///
/// Where two sets have no position of an axis in common, the range of the first one stays: poses there have no result,
/// and that is said.
/// @param errors  at least one set
/// @param count   positions per axis; 1 where a range is a single position
std::vector<AxisRange> common_known_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors,
                                           std::size_t count);

}  // namespace abbe
