#pragma once

// For tests: correctors that change nothing.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "abbe/compensate/program/move_path.h"
#include "abbe/formats/nc/nc_program.h"

namespace abbe {

/// Keeps the moves; arcs become chords that stay within a tolerance of the arc.
class UnchangedMoves final : public MoveCorrector {
 public:
  explicit UnchangedMoves(double chord_mm = 1e-3) : chord_mm_(chord_mm) {}

  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : moves) {
      if (move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise) {
        arc(move, corrected.pieces);
      } else {
        corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
      }
      corrected.first.push_back(corrected.pieces.size());
      seen.push_back(move);
    }
  }

  std::vector<ProgramMove> seen;

 private:
  void arc(const ProgramMove& move, std::vector<CorrectedPiece>& pieces) const {
    if (move.plane == ArcPlane::tilted) {
      const MovePath path(move);
      constexpr int kPieces = 100;
      for (int i = 1; i <= kPieces; ++i) {
        CorrectedPiece& piece = pieces.emplace_back();
        piece.feed = move.feed;
        path.at(static_cast<double>(i) / kPieces, piece.end);
      }
      return;
    }
    const std::size_t a = move.plane == ArcPlane::XY ? 0 : move.plane == ArcPlane::ZX ? 2 : 1, b = (a + 1) % 3;
    const double from_a = move.start[a] - move.arc_centre[a], from_b = move.start[b] - move.arc_centre[b];
    const double to_a = move.end[a] - move.arc_centre[a], to_b = move.end[b] - move.arc_centre[b];
    const double radius = std::hypot(from_a, from_b), end_radius = std::hypot(to_a, to_b);
    const double turn = 2 * std::numbers::pi;
    double angle = std::atan2(to_b, to_a) - std::atan2(from_b, from_a);
    const bool clockwise = move.kind == MoveKind::arc_clockwise;
    if (clockwise) angle = -angle;
    while (angle <= 1e-12) angle += turn;
    while (angle > turn + 1e-12) angle -= turn;
    angle += turn * (move.arc_turns - 1);
    const int count = std::max(4, static_cast<int>(std::ceil(angle / std::sqrt(8 * chord_mm_ / radius))));
    for (int i = 1; i <= count; ++i) {
      const double share = static_cast<double>(i) / count;
      CorrectedPiece piece{move.end, move.feed, move.feed_mode};
      if (move.feed_mode == FeedMode::inverse_time) piece.feed *= count;
      for (std::size_t k = 0; k < kAxisWords; ++k) piece.end[k] = move.start[k] + share * (move.end[k] - move.start[k]);
      const double at = std::atan2(from_b, from_a) + (clockwise ? -1 : 1) * share * angle;
      const double r = radius + share * (end_radius - radius);
      piece.end[a] = move.arc_centre[a] + r * std::cos(at);
      piece.end[b] = move.arc_centre[b] + r * std::sin(at);
      if (i == count) piece.end = move.end;
      pieces.push_back(piece);
    }
  }

  double chord_mm_;
};

/// A program through a corrector that changes nothing.
struct RunProgram {
  std::vector<ProgramMove> moves;
  std::string text;
  NcProgramResult result;
};

/// All axes stand at zero when the program begins; the machine has all six of X Y Z A B C.
inline NcProgramOptions options_at_zero() {
  NcProgramOptions options;
  for (std::size_t k = 0; k < 6; ++k) options.start[k] = 0;
  options.tools = NcToolTable{{1, {0, 0, 50}}, {2, {1, 2, 30}}};
  return options;
}

inline RunProgram run_program(std::string_view text, const NcProgramOptions& options = options_at_zero()) {
  UnchangedMoves corrector;
  RunProgram run;
  run.result = correct_nc_program(text, "p.ngc", options, corrector, [&](std::string_view part) { run.text += part; });
  run.moves = std::move(corrector.seen);
  return run;
}

}  // namespace abbe
