#pragma once

#include <cstddef>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Grid over what is known of the travel; of a whole turn the end, which is its beginning, is left out.
/// @param count  positions of every axis that moves
/// @param grid   out, [axes]: positions of each axis
PoseList travel_grid(const Machine& machine, const ErrorSet& errors, std::size_t count, std::vector<std::size_t>& grid);

}  // namespace abbe
