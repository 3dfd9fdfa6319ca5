// ChunkCorrection: the pieces of moves of a machine with reversal values, once the directions of its axes are known.
#include <algorithm>
#include <cmath>

#include "abbe/compensate/program/chunk_correction.h"

namespace abbe {

bool ChunkCorrection::turns_with_spindle(const ProgramMove& move, std::size_t i, const ProgramWay& way) const {
  if (move.spindle == SpindleMove::none) return false;
  const std::size_t first = way.first[i], last = way.first[i + 1] - 1;
  return std::any_of(reversals_.axes().begin(), reversals_.axes().end(), [&](const ReversalAxis& axis) {
    const std::size_t a = axis.axis;
    const double moved = std::abs(way.nodes[last].corrected_position[a] - way.nodes[first].corrected_position[a]);
    return way.approach[last][a] != way.approach[first][a] ||
           (move.spindle == SpindleMove::rigid_tapping && moved > axis.dead_band);
  });
}

void ChunkCorrection::give_steps(const ProgramMove& move, std::size_t i, ProgramChunk& chunk) const {
  const ProgramWay& way = chunk.way;
  if (way.first[i] == way.first[i + 1]) {
    chunk.pieces.pieces.push_back({move.end, move.feed, move.feed_mode});
    return;
  }
  if (turns_with_spindle(move, i, way)) chunk.report.play_with_spindle.add(move.line);
  const double duration = move_duration(move);
  reversals_.steps(correction_, move, chunk.tool[i], way, i, chunk.steps);
  WordValues at =
      reversals_.commanded(correction_, move, chunk.tool[i], way.nodes[way.first[i]], way.approach[way.first[i]])
          .corrected;
  for (const ProgramStep& step : chunk.steps) {
    const double share = way.shares[step.to] - way.shares[step.to - 1];
    if (step.taken_up == ProgramStep::npos) {
      give_piece(move, duration, share, at, step.node, chunk, step.approach);
      for (const ReversalAxis& axis : reversals_.axes()) {
        if (step.approach[axis.axis] == 0) chunk.report.direction_unknown[axis.axis].add(move.line);
      }
    } else {
      const bool rotary = machine_.axes[step.taken_up].kind == AxisKind::rotary;
      CorrectedPiece piece{step.node.corrected, move.feed, move.feed_mode};
      set_take_up_feed(move, rotary, step.way, duration * share,
                       reversals_.moved(way.nodes[step.to - 1], way.nodes[step.to]), piece);
      if (piece.feed_mode != move.feed_mode) chunk.report.inverse_time.add(move.line);
      // Between moves of a cycle or two, LinuxCNC 2.9 loses its way where it may round corners (docs/programs.md).
      piece.exact = move.kind == MoveKind::rapid;
      chunk.pieces.pieces.push_back(piece);
      chunk.report.take_ups[step.taken_up].add(move.line);
    }
    at = step.node.corrected;
  }
}

void ChunkCorrection::give_all_steps(std::span<const ProgramMove> moves, ProgramChunk& chunk) const {
  for (std::size_t i = 0; i < moves.size(); ++i) {
    chunk.pieces.first.push_back(chunk.pieces.pieces.size());
    give_steps(moves[i], i, chunk);
  }
  chunk.report.pieces = chunk.pieces.pieces.size();
}

}  // namespace abbe
