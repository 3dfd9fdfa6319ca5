#include "abbe/identify/sums/reading_pieces.h"

#include <algorithm>

namespace abbe {
namespace {

// Of few readings, more pieces cost more memory and reduction than they gain in balance. Of many readings, more
// processes can share more pieces; the sums of all of them have to fit into one message of MPI.
constexpr std::size_t kFewPieces = 48, kMostPieces = 256;
// Blocks of a piece before there are more than few.
constexpr std::size_t kLongPiece = 512;
// Readings in files are converted in parts of so many blocks. Long pieces hold whole ones, so that none is converted
// for two pieces.
constexpr std::size_t kPart = 32, kWholeParts = 8 * kPart;

}  // namespace

std::size_t readings_of_piece(std::size_t blocks) {
  const std::size_t pieces = std::clamp((blocks + kLongPiece - 1) / kLongPiece, kFewPieces, kMostPieces);
  const std::size_t together = std::max<std::size_t>(1, (blocks + pieces - 1) / pieces);
  return Observations::kBlockSize * (together < kWholeParts ? together : (together + kPart - 1) / kPart * kPart);
}

std::vector<ReadingPiece> divide_readings(const Problem& problem) {
  constexpr std::size_t kBlock = Observations::kBlockSize;
  std::size_t blocks = 0;
  for (const SelectedObservations& selected : problem.observations)
    blocks += (selected.observations->reading_count() + kBlock - 1) / kBlock;
  const std::size_t together = readings_of_piece(blocks);
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
