#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "abbe/compensate/axis_directions.h"
#include "abbe/compensate/program/piece_bound.h"
#include "abbe/compensate/program/program_move.h"
#include "abbe/compensate/program/program_report.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/compensate/tables/corrected_node.h"

namespace abbe {

/// Corrected poses of moves that follow each other, before reversal is looked at: move i goes from nodes[first[i]] over
/// those after it to nodes[first[i + 1] - 1]. A move without nodes cannot be made.
struct ProgramWay {
  std::vector<CorrectedNode> nodes;
  std::vector<double> shares;          ///< [nodes] of the move, 0 at its first node
  std::vector<std::size_t> first;      ///< [moves + 1]
  std::vector<AxisApproach> approach;  ///< [nodes] in which the node is reached; of the first one before the move

  void clear();
};

/// One motion that reaches a node, or takes up the play of one axis.
struct ProgramStep {
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);

  CorrectedNode node;
  std::size_t taken_up = npos;  ///< axis
  bool rotary = false;          ///< taken up: only rotary axes move
  /// Of the functional point by that axis, mm; of rotary axes at the longest lever of the machine's tool.
  double way = 0;
  std::size_t to = 0;  ///< ProgramWay::nodes; of a take-up the end of the piece that follows
  AxisApproach approach{};
};

/// Directions of the axes with reversal values along a program and what their commands get for it. Axes on whose side
/// of approach errors depend are followed as well: nodes are corrected for the errors after their approaches.
///
/// Directions are those of the corrected axis positions (of what the axes are driven to), with a dead band
/// (AxisDirections). Between nodes axes do not turn round but by less than it. Where an axis takes another direction, a
/// motion of it alone by its reversal value comes first. Derivation: docs/programs.md, "Reversal".
class ProgramReversals {
 public:
  ProgramReversals() : directions_(std::vector<double>{}) {}
  /// @param dead_band       mm; of rotary axes at the longest lever that the functional point of the machine's tool has
  ///                        over the travel, with ProgramMove::tool_length on top
  /// @param dead_band_turn  rad; of rotary axes no more than this
  ProgramReversals(const Machine& machine, const ErrorSet& errors, const WordAxes& words, const PieceBounder& bounder,
                   double dead_band, double dead_band_turn);

  bool act() const { return !axes_.empty(); }
  /// Dead bands with the machine's own tool: with a tool length those of rotary axes are smaller.
  const std::vector<ReversalAxis>& axes() const { return axes_; }
  /// @param lags_count  the dead bands are part of the tolerance of the path
  PlayBounds play(bool lags_count) const;

  /// Directions at all nodes of moves that follow those given before.
  /// @param moves  those of the way
  void follow(std::span<const ProgramMove> moves, ProgramWay& way);

  /// Motions of one move. Thread-safe.
  void steps(const NodeCorrection& correction, const ProgramMove& move, std::size_t tool, const ProgramWay& way,
             std::size_t index, std::vector<ProgramStep>& steps) const;
  /// How far the linear axes go together between two nodes, or the rotary ones carry the point; mm.
  double moved(const CorrectedNode& from, const CorrectedNode& to) const;
  /// A node as it is commanded after these approaches.
  CorrectedNode commanded(const NodeCorrection& correction, const ProgramMove& move, std::size_t tool,
                          const CorrectedNode& node, const AxisApproach& approach) const;

 private:
  /// @param tool_length  mm, of the vector by which the tool is longer than the machine's
  double dead_band_of(std::size_t axis, double tool_length) const;
  void take_tool(const std::array<double, 3>& length);

  bool only_turns(const CorrectedNode& from, const CorrectedNode& to) const;

  std::vector<ReversalAxis> axes_;
  AxisDirections directions_;
  double dead_band_ = 0, dead_band_turn_ = 0;
  std::array<double, 3> tool_length_{};  ///< mm, that the dead bands are for
  std::vector<double> lever_;            ///< [axes] mm of the point of the machine's tool per unit of the axis
  std::vector<bool> rotary_;             ///< [axes]
  std::vector<double> stood_;            ///< [axes_] commands as programmed, where the way so far ends
};

}  // namespace abbe
