#pragma once

// Internal to compensate.
#include <atomic>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/compensate/program/program_correction.h"
#include "abbe/compensate/program/program_reversals.h"

namespace abbe {

/// Moves that follow each other and what becomes of them.
struct ProgramChunk {
  std::vector<CorrectedNode> nodes;
  std::vector<std::size_t> start, end;  ///< nodes of each move
  std::vector<std::size_t> tool;        ///< of each move; ChunkCorrection::kNoTool: it cannot be made
  std::vector<char> from_before;        ///< the start is where the move before ended
  std::vector<char> proven;             ///< one piece will do
  CorrectedPieces pieces;
  ProgramReport report;
  std::optional<MoveSplitter> splitter;
  ProgramWay way;  ///< with reversal values only: the poses before directions are known
  std::vector<ProgramStep> steps;
};

/// What ProgramCorrection does with some moves of a program: their ends corrected, pieces proven or split, and what is
/// to be said of them. Different chunks may be worked on at the same time.
class ChunkCorrection {
 public:
  static constexpr std::size_t kNoTool = static_cast<std::size_t>(-1);

  /// @param options  its budget, if there is one, has to live on
  ChunkCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                  const ProgramCorrectionOptions& options);

  const std::string& problem() const { return problem_; }  ///< why nothing can be corrected; empty: none
  const ProgramReversals& reversals() const { return reversals_; }

  /// Pieces are counted against the budget from here on.
  void begin_batch() { pieces_of_batch_ = 0; }
  /// Looks up the tool of each move, one chunk after the other.
  void find_tools(std::span<const ProgramMove> moves, ProgramChunk& chunk);
  /// Pieces of each move, or with reversal values the way from which they follow when the directions are known.
  /// @param before  the move before the first one; null: none
  void work(std::span<const ProgramMove> moves, const ProgramMove* before, ProgramChunk& chunk) const;
  /// Follows the directions of the axes through a chunk, in the order of the program; with reversal values only.
  void follow(std::span<const ProgramMove> moves, ProgramChunk& chunk) { reversals_.follow(moves, chunk.way); }
  /// What is left to do when the directions are known.
  void give_all_steps(std::span<const ProgramMove> moves, ProgramChunk& chunk) const;

 private:
  bool can_be_made(const ProgramMove& move) const;
  PathTolerance tolerance_of(const ProgramMove& move) const;
  void place_nodes(std::span<const ProgramMove> moves, const ProgramMove* before, ProgramChunk& chunk) const;
  void correct_nodes(std::span<const ProgramMove> moves, ProgramChunk& chunk) const;
  /// One bound for several moves in a row, where they are alike; it proves each of them.
  void prove_groups(std::span<const ProgramMove> moves, ProgramChunk& chunk) const;
  /// A place within the travel whose correction points outwards at its end, where the axes stay.
  bool is_held(const CorrectedNode& node) const;
  static ProgramPlace place_of(double value, const ProgramMove& move, const CorrectedNode& node,
                               const AxisApproach& approach = {});
  void state(const ProgramMove& move, const CorrectedNode& node, ProgramReport& report,
             const AxisApproach& approach = {}) const;
  void give_piece(const ProgramMove& move, double duration, double share, const WordValues& from,
                  const CorrectedNode& to, ProgramChunk& chunk, const AxisApproach& approach = {}) const;
  /// Poses of a move: pieces of the program, or with reversal values nodes of its way, which become pieces when the
  /// directions are known.
  void give_nodes(const ProgramMove& move, std::span<const CorrectedNode> nodes, std::span<const double> shares,
                  ProgramChunk& chunk) const;
  /// A move that is not split: how far its path may be from the commanded one.
  void bound_single(const ProgramMove& move, std::size_t i, const CorrectedNode& start, const CorrectedNode& end,
                    ProgramChunk& chunk) const;
  /// Whether a move at work begins and ends within the travel, so that what can be proven of it is proven.
  /// @param earlier  the move before; null: none
  bool goes_from_or_to_held(const ProgramMove& move, const ProgramMove* earlier, const CorrectedNode& start,
                            const CorrectedNode& end, ProgramChunk& chunk) const;
  bool is_spent() const;
  void give_move(const ProgramMove& move, const ProgramMove* earlier, std::size_t i, ProgramChunk& chunk) const;
  /// Whether an axis with a reversal value turns round in a move with the spindle: where it begins, or where a tap
  /// does.
  bool turns_with_spindle(const ProgramMove& move, std::size_t i, const ProgramWay& way) const;
  /// The way of one move as it is when the sides of approach are known: its pieces are proven again, or split.
  ProgramWay way_after_approaches(const ProgramMove& move, std::size_t i, ProgramChunk& chunk) const;
  void give_steps(const ProgramMove& move, std::size_t index, ProgramChunk& chunk) const;

  Machine machine_;
  WordAxes words_;
  ProgramCorrectionOptions options_;
  NodeCorrection correction_;
  std::string problem_;
  std::optional<PieceBounder> bounder_;
  ProgramReversals reversals_;
  mutable std::atomic<std::size_t> pieces_of_batch_ = 0;
};

}  // namespace abbe
