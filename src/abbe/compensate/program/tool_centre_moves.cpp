#include "abbe/compensate/program/tool_centre_moves.h"

namespace abbe {

void ToolCentreMoves::correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) {
  moves_.assign(moves.begin(), moves.end());
  for (ProgramMove& move : moves_) {
    if (move.coordinates == ProgramCoordinates::tool_centre) continue;
    move.coordinates = ProgramCoordinates::tool_centre;
    for (std::size_t i = 0; i < 3; ++i) {
      move.start[i] -= move.tool_length[i];
      move.end[i] -= move.tool_length[i];
      move.arc_centre[i] -= move.tool_length[i];
    }
  }
  corrector_->correct(moves_, corrected);
  for (std::size_t k = 0; k < moves.size(); ++k) {
    if (moves[k].coordinates == ProgramCoordinates::tool_centre) continue;
    for (std::size_t p = corrected.first[k]; p < corrected.first[k + 1]; ++p) {
      for (std::size_t i = 0; i < 3; ++i) corrected.pieces[p].end[i] += moves[k].tool_length[i];
    }
  }
}

}  // namespace abbe
