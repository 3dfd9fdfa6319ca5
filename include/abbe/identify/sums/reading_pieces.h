#pragma once

#include <cstddef>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// Readings that are summed by themselves: the sums of all pieces are then added in order.
struct ReadingPiece {
  std::size_t observations = 0;  ///< index into Problem::observations
  std::size_t first = 0;         ///< reading
  std::size_t last = 0;          ///< one past the last reading
};

/// Consecutive pieces, first .. last - 1.
struct PieceRange {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t count() const { return last - first; }
  bool operator==(const PieceRange&) const = default;
};

/// Divides the readings of a problem, used or not, into pieces.
///
/// A piece holds readings of one set of observations, one after the other: a multiple of Observations::kBlockSize, or
/// the rest. The multiple is the least with which the blocks of all observations make no more than 48 pieces; as every
/// set of observations begins a piece of its own, there may be as many more as there are sets. The division depends on
/// the numbers of readings only.
std::vector<ReadingPiece> divide_readings(const Problem& problem);

/// The share of one of several processes: consecutive pieces, evenly; empty if there are more processes than pieces.
/// @param process  0 .. processes - 1
PieceRange share_of_pieces(std::size_t pieces, std::size_t process, std::size_t processes);

}  // namespace abbe
