#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "abbe/compensate/program/move_path.h"
#include "abbe/compensate/program/piece_bound.h"
#include "abbe/compensate/tables/corrected_node.h"

namespace abbe {

struct PathTolerance {
  double position = 1e-3;     ///< mm, of the functional point from the commanded path
  double orientation = 1e-5;  ///< rad, of the tool's direction; infinite: not looked at
};

/// Part of a move between two corrected poses.
struct MovePiece {
  const CorrectedNode* from = nullptr;
  const CorrectedNode* to = nullptr;
  const MovePath* path = nullptr;  ///< of the whole move; null: a straight line
  double share = 1;                ///< of the move
};

/// Bound of one piece, or of several at once, which is that of each: straight moves with the same tool and coordinates.
PieceBound bound_pieces(const PieceBounder& bounder, std::size_t axes, ProgramCoordinates coordinates,
                        const Eigen::Vector3d& tool, std::span<const MovePiece> pieces);

/// Bound over tolerance: at most 1 if the piece is good; else about the square of the number of parts needed.
/// @param piece  null: of several pieces at once
double bound_excess(const PieceBounder& bounder, const PathTolerance& tolerance, const PieceBound& bound,
                    const MovePiece* piece);

/// Splits one move until every piece stays within the tolerance. Keeps its memory for the next move.
///
/// Where an end of the move is held at the end of a travel, the shortest possible piece leads to where the point is
/// reached. The rest stays within the tolerance; that piece within the tolerance plus the error left at its end.
class MoveSplitter {
 public:
  MoveSplitter(const NodeCorrection& correction, const PieceBounder& bounder, std::size_t axes,
               std::size_t largest_pieces)
      : correction_(&correction), bounder_(&bounder), axes_(axes), largest_pieces_(largest_pieces) {}

  /// @returns false if that takes too many pieces; nodes() then hold what was done so far
  bool split(const ProgramMove& move, std::size_t tool, const PathTolerance& tolerance, const CorrectedNode& start,
             const CorrectedNode& end);

  /// The same for part of a move, its ends corrected for these approaches.
  /// @param from, to  shares of the move where it begins and ends
  bool split_part(const ProgramMove& move, std::size_t tool, const PathTolerance& tolerance,
                  const AxisApproach& approach, const CorrectedNode& start, double from, const CorrectedNode& end,
                  double to);

  /// Start, ends of pieces, end; of the last move.
  const std::vector<CorrectedNode>& nodes() const { return nodes_; }
  const std::vector<double>& shares() const { return at_; }  ///< [nodes] s of each, from 0 to 1

 private:
  bool refine(const MovePath& path, const ProgramMove& move, std::size_t tool, const PathTolerance& tolerance,
              const AxisApproach& approach);
  void part_at_travel(const MovePath& path, ProgramCoordinates coordinates, std::size_t tool);

  const NodeCorrection* correction_;
  const PieceBounder* bounder_;
  std::size_t axes_, largest_pieces_;
  std::vector<CorrectedNode> nodes_, next_, fresh_;
  std::vector<double> at_, next_at_;
  std::vector<std::size_t> parts_;  ///< [pieces] into how many each goes; 1: it stays
  std::vector<char> proven_, next_proven_;
};

}  // namespace abbe
