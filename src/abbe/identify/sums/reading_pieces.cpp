#include "abbe/identify/sums/reading_pieces.h"

#include <algorithm>

namespace abbe {
namespace {

// More pieces than this cost more memory and reduction than they gain in balance.
constexpr std::size_t kMostPieces = 48;

}  // namespace

std::vector<ReadingPiece> divide_readings(const Problem& problem) {
  constexpr std::size_t kBlock = Observations::kBlockSize;
  std::size_t blocks = 0;
  for (const SelectedObservations& selected : problem.observations)
    blocks += (selected.observations->reading_count() + kBlock - 1) / kBlock;
  const std::size_t together = kBlock * std::max<std::size_t>(1, (blocks + kMostPieces - 1) / kMostPieces);
  std::vector<ReadingPiece> pieces;
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const std::size_t count = problem.observations[o].observations->reading_count();
    for (std::size_t first = 0; first < count; first += together)
      pieces.push_back({o, first, std::min(count, first + together)});
  }
  return pieces;
}

PieceRange share_of_pieces(std::size_t pieces, std::size_t process, std::size_t processes) {
  return {pieces * process / processes, pieces * (process + 1) / processes};
}

}  // namespace abbe
