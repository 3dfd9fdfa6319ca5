#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/program/move_splitting.h"
#include "abbe/compensate/program/program_budget.h"
#include "abbe/compensate/program/program_move.h"
#include "abbe/compensate/program/program_report.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

struct ProgramCorrectionOptions {
  CorrectionOptions inverse;
  PathTolerance tolerance;        ///< of feed moves
  double rapid_tolerance = 0.01;  ///< mm, of rapid moves, whose orientation is not looked at between their ends
  /// mm, of axes with reversal values, of rotary ones at the longest lever of the functional point with the tool in
  /// force and no more than the tolerance of the orientation; 0: an eighth of the tolerances and part of them, else
  /// what it costs comes on top of them.
  double reversal_dead_band = 0;
  /// By this share of the tool length offset in force the tool is too long: of a workpiece that expands
  /// (WorkpieceErrors), because the machine file's tool alone is in the errors.
  double tool_length_share = 0;
  double limit = 0;                     ///< mm; corrections of the functional point above it are counted; 0: no limit
  std::vector<double> rest;             ///< [axes] commands of axes that no word moves, mm or rad; empty: zero
  int threads = 0;                      ///< 0: as many as the machine has
  std::size_t largest_pieces = 100000;  ///< of one move
  /// Where it is spent, moves are no longer split: correct() ends soon, and its pieces are no corrected program. Not
  /// owned; null: none.
  const ProgramBudget* budget = nullptr;
};

/// Corrects the moves of a program so that the tool of a machine with errors follows the commanded path.
///
/// Axes with reversal values get half of it against the direction of their last motion, and a motion of their own by
/// all of it where they turn round (ProgramReversals).
///
/// The ends of moves are corrected by CompensatedInverse; a move whose path between them cannot be proven to stay
/// within the tolerance (PieceBounder) is split. Dense programs pass with one pose and a share of a common bound per
/// move. The tool is the machine file's, lengthened by ProgramMove::tool_length. Results do not depend on the batches
/// nor on the number of threads. Method and proof: docs/programs.md.
class ProgramCorrection : public MoveCorrector {
 public:
  ProgramCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                    const ProgramCorrectionOptions& options = {});
  ~ProgramCorrection() override;
  ProgramCorrection(ProgramCorrection&&) noexcept;
  ProgramCorrection& operator=(ProgramCorrection&&) noexcept;

  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override;

  /// Of all moves so far.
  const ProgramReport& report() const;
  /// Axes whose reversal values are compensated, with their dead bands for the machine file's tool.
  const std::vector<ReversalAxis>& reversals() const;
  /// What makes this object unusable; empty if it is sound. Unusable, moves come back as they are.
  const std::string& problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
