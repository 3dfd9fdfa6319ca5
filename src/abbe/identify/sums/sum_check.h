#pragma once

#include <cstdint>
#include <vector>

#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe {

/// Refuses a sum that is not the whole answer to a request about these readings.
/// @param fingerprints  [pieces] of the readings at the request's reference
/// @throws SumError
void check_sum(const SumOfReadings& sum, const SumRequest& request, const Problem& problem,
               const std::vector<ReadingPiece>& pieces, const std::vector<std::uint64_t>& fingerprints);

/// Values of a piece with c columns of a problem with p parameters, see SumKind.
bool is_size_of_values(SumKind kind, std::size_t size, std::size_t readings, std::size_t c, std::size_t p);

}  // namespace abbe
