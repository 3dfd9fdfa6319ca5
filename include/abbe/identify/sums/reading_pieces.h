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

/// Number of readings of a piece that is not the last of its observations.
///
/// It is the least multiple of Observations::kBlockSize with which the blocks make at most 48 pieces. More than 3.1
/// million readings make about one piece per 65,536 readings, at most 256. Pieces of 32,768 readings and more are
/// rounded up to a multiple of 4096.
/// @param blocks  of all observations
std::size_t readings_of_piece(std::size_t blocks);

/// Divides the readings of a problem, used or not, into pieces.
///
/// A piece holds readings of one set of observations, one after the other: readings_of_piece(), or the rest. As every
/// set of observations begins a piece of its own, there may be as many more pieces as there are sets. The division
/// depends on the numbers of readings only.
std::vector<ReadingPiece> divide_readings(const Problem& problem);

/// The share of one of several processes: consecutive pieces, evenly; empty if there are more processes than pieces.
/// @param process  0 .. processes - 1
PieceRange share_of_pieces(std::size_t pieces, std::size_t process, std::size_t processes);

}  // namespace abbe
