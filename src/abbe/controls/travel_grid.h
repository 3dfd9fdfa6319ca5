#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Positions per axis of the grid on which corrections are judged: those asked for, else 9, or 5 above three axes.
/// @throws InputError naming --positions for less than 2, and for more than a million poses
std::size_t judged_positions(const Machine& machine, const std::optional<std::size_t>& positions);

/// Grid over what is known of the travel; of a whole turn the end, which is its beginning, is left out.
/// @param count  positions of every axis that moves
/// @param grid   out, [axes]: positions of each axis
PoseList travel_grid(const Machine& machine, const ErrorSet& errors, std::size_t count, std::vector<std::size_t>& grid);

}  // namespace abbe
