#pragma once

#include <vector>

#include "abbe/compensate/program/program_move.h"

namespace abbe {

/// For programs whose X, Y, Z mean the functional point throughout although no word says so: the control has the
/// kinematics of the machine, as LinuxCNC with xyzac-trt-kins.
///
/// There a position is the point plus the tool length offset in force, which the kinematics take off again. Moves go to
/// the other corrector as tool centre moves, without that offset, and what comes back gets it again.
class ToolCentreMoves : public MoveCorrector {
 public:
  explicit ToolCentreMoves(MoveCorrector& corrector) : corrector_(&corrector) {}
  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override;

 private:
  MoveCorrector* corrector_;
  std::vector<ProgramMove> moves_;
};

}  // namespace abbe
