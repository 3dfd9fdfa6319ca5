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
  double rapid_tolerance = 0.01;  ///< mm, of rapid moves; their orientation is checked at their ends only
  /// mm, dead band of axes with reversal values. For rotary axes it applies at the longest lever of the functional
  /// point with the active tool, and is at most the orientation tolerance. 0: an eighth of the tolerances, and its
  /// effect counts as part of them; any other value: its effect comes on top of them.
  double reversal_dead_band = 0;
  /// The tool is too long by this share of the active tool length offset: for a workpiece that expands
  /// (WorkpieceErrors), because the errors include only the tool of the machine file.
  double tool_length_share = 0;
  double limit = 0;                     ///< mm; corrections of the functional point above it are counted; 0: no limit
  std::vector<double> rest;             ///< [axes] commands of axes that no word moves, mm or rad; empty: zero
  int threads = 0;                      ///< 0: as many as the machine has
  std::size_t largest_pieces = 100000;  ///< of one move
  /// Once it is spent, moves are no longer split: correct() soon returns, and its pieces are not a corrected program.
  /// Not owned; null: no limits.
  const ProgramBudget* budget = nullptr;
};

/// Corrects the moves of a program so that the tool of a machine with errors follows the commanded path.
///
/// Axes with a reversal value are offset by half of it against the direction of their last motion. Where they reverse,
/// a separate motion takes up all of it (ProgramReversals).
///
/// The ends of moves are corrected by CompensatedInverse; a move whose path between them cannot be proven to stay
/// within the tolerance (PieceBounder) is split. In dense programs a move costs one pose and a share of a common
/// bound. The tool is the machine file's, lengthened by ProgramMove::tool_length. Results do not depend on the batches
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
  /// Why this object is unusable; empty if it is sound. An unusable object returns moves unchanged.
  const std::string& problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
