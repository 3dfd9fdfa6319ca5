#include "abbe/compensate/program/program_correction.h"

#include <algorithm>
#include <optional>

#include "abbe/compensate/program/chunk_correction.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

constexpr std::size_t kChunk = 256;  // moves worked on together
constexpr std::size_t kChunksWithWay = 8;

}  // namespace

struct ProgramCorrection::Implementation {
  Implementation(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                 const ProgramCorrectionOptions& options)
      : worker(machine, errors, words, options), threads(options.threads) {}

  void correct_batch(std::span<const ProgramMove> moves, CorrectedPieces& corrected) {
    const std::size_t count = (moves.size() + kChunk - 1) / kChunk;
    while (chunks.size() < count) chunks.push_back(std::make_unique<ProgramChunk>());
    const auto moves_of = [&](std::size_t c) {
      return moves.subspan(c * kChunk, std::min(kChunk, moves.size() - c * kChunk));
    };
    for (std::size_t c = 0; c < count; ++c) worker.find_tools(moves_of(c), *chunks[c]);
    for_each_block(count, threads, [&](std::size_t c) {
      const ProgramMove* before = c > 0 ? &moves[c * kChunk - 1] : last_move ? &*last_move : nullptr;
      worker.work(moves_of(c), before, *chunks[c]);
    });
    if (worker.reversals().act()) {
      for (std::size_t c = 0; c < count; ++c) worker.follow(moves_of(c), *chunks[c]);
      for_each_block(count, threads, [&](std::size_t c) { worker.give_all_steps(moves_of(c), *chunks[c]); });
    }
    std::size_t pieces = corrected.pieces.size();
    for (std::size_t c = 0; c < count; ++c) pieces += chunks[c]->pieces.pieces.size();
    corrected.pieces.reserve(pieces);
    for (std::size_t c = 0; c < count; ++c) {
      const ProgramChunk& chunk = *chunks[c];
      const std::size_t before = corrected.pieces.size();
      for (const std::size_t first : chunk.pieces.first) corrected.first.push_back(before + first);
      corrected.pieces.insert(corrected.pieces.end(), chunk.pieces.pieces.begin(), chunk.pieces.pieces.end());
      total.add(chunk.report);
    }
    last_move = moves.back();
  }

  ChunkCorrection worker;
  int threads;
  std::vector<std::unique_ptr<ProgramChunk>> chunks;
  std::optional<ProgramMove> last_move;
  ProgramReport total;
};

ProgramCorrection::ProgramCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                                     const ProgramCorrectionOptions& options)
    : implementation_(std::make_unique<Implementation>(machine, errors, words, options)) {}
ProgramCorrection::~ProgramCorrection() = default;
ProgramCorrection::ProgramCorrection(ProgramCorrection&&) noexcept = default;
ProgramCorrection& ProgramCorrection::operator=(ProgramCorrection&&) noexcept = default;

void ProgramCorrection::correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) {
  Implementation& self = *implementation_;
  corrected.pieces.clear();
  corrected.first.clear();
  self.worker.begin_batch();
  if (!self.worker.problem().empty()) {
    for (const ProgramMove& move : moves) {
      corrected.first.push_back(corrected.pieces.size());
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
    }
    corrected.first.push_back(corrected.pieces.size());
    return;
  }
  // With reversal values the poses of moves are kept until the directions are known: of few moves at a time.
  const std::size_t batch = self.worker.reversals().act() ? kChunksWithWay * kChunk : moves.size();
  for (std::size_t first = 0; first < moves.size(); first += batch) {
    self.correct_batch(moves.subspan(first, std::min(batch, moves.size() - first)), corrected);
  }
  corrected.first.push_back(corrected.pieces.size());
}

const ProgramReport& ProgramCorrection::report() const { return implementation_->total; }
const std::string& ProgramCorrection::problem() const { return implementation_->worker.problem(); }
const std::vector<ReversalAxis>& ProgramCorrection::reversals() const {
  return implementation_->worker.reversals().axes();
}

}  // namespace abbe
