#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

// Random poses at which `run` and `verify` judge an identification: the same results have the same poses in both.

/// Ranges over which all of the given errors are known.
///
/// @param errors  at least one set; of ranges without a position in common the first one's stays, so that its poses
/// have
///                no result and are told of
/// @return [axes] two positions each, mm or rad
std::vector<AxisRange> unseen_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors);

/// Poses drawn evenly from ranges; the same seed gives the same ones.
///
/// @param ranges           [axes], mm or rad
/// @param both_directions  every axis comes from either side at random, which PoseList::approach states; else it is
///                         empty
/// @throws std::invalid_argument as random_plan()
PoseList random_unseen_poses(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count,
                             std::uint64_t seed, bool both_directions);

/// Seed of the poses of a study, apart from that of its readings.
std::uint64_t unseen_seed(std::uint64_t study_seed);

}  // namespace abbe
