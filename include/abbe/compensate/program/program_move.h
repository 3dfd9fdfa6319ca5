#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

/// Words of a program that move an axis, in the order of RS274/NGC.
enum class AxisWord : std::uint8_t { X, Y, Z, A, B, C, U, V, W };
inline constexpr std::size_t kAxisWords = 9;
/// Whether the axis word with this index is A, B or C, those of rotary axes.
inline constexpr bool is_rotary_word(std::size_t word) { return word >= 3 && word <= 5; }

/// One value per axis word; mm, or rad for A B C.
using WordValues = std::array<double, kAxisWords>;

enum class MoveKind : std::uint8_t {
  rapid,                 ///< G0, and the rapid parts of canned cycles
  straight,              ///< G1
  arc_clockwise,         ///< G2, seen from the positive end of the plane's normal: X x Y = Z in words
  arc_counterclockwise,  ///< G3
};

/// How a straight move is tied to the spindle. All but the first stay one piece: the control would slow down between.
enum class SpindleMove : std::uint8_t {
  none,
  tapping,        ///< G84, G74 at the feed F with a tap holder that gives way
  thread,         ///< G33: feed per revolution is the pitch along the path
  rigid_tapping,  ///< G33.1: the same, and back to where it began with the spindle reversed
};

// NOLINTNEXTLINE(readability-identifier-naming): planes have the names of their axes
enum class ArcPlane : std::uint8_t {
  XY,      ///< G17
  ZX,      ///< G18
  YZ,      ///< G19
  tilted,  ///< at right angles to ProgramMove::arc_normal
};

enum class FeedMode : std::uint8_t {
  inverse_time,    ///< G93: 1/min, of this move
  per_minute,      ///< G94: mm/min, or rad/min where only rotary axes move
  per_revolution,  ///< G95: mm/revolution
};

/// What the values of X, Y, Z mean to the control that runs the program.
enum class ProgramCoordinates : std::uint8_t {
  axes,         ///< positions of the linear axes
  tool_centre,  ///< functional point in the workpiece frame: the control has the nominal kinematics (TCPC, RTCP)
};

/// One motion as a control carries it out: every modal setting, offset, unit, expression and cycle resolved.
///
/// Positions are what the control commands: program value + work offset (G54-G59.3, G92) + tool length offset (G43),
/// with `tool_centre` without the latter, which is in the nominal kinematics then.
struct ProgramMove {
  std::size_t line = 0;  ///< of the program, from 1
  MoveKind kind = MoveKind::rapid;
  SpindleMove spindle = SpindleMove::none;
  ProgramCoordinates coordinates = ProgramCoordinates::axes;
  FeedMode feed_mode = FeedMode::per_minute;
  double feed = 0;                      ///< as FeedMode says; unused by rapid moves
  WordValues start{};                   ///< mm, rad; words that the machine does not have: 0
  WordValues end{};                     ///< mm, rad
  ArcPlane plane = ArcPlane::XY;        ///< arcs
  std::array<double, 3> arc_centre{};   ///< X, Y, Z, mm; the coordinate along the normal is unused
  std::array<double, 3> arc_normal{};   ///< of a tilted plane, in words X, Y, Z; of length one
  int arc_turns = 1;                    ///< full circles begun, P of RS274/NGC: 1 for up to one turn
  std::array<double, 3> tool_length{};  ///< X, Y, Z of the tool length offset in force, mm (G43, G43.1, G43.2)
};

/// mm; a shorter distance is no motion, but the rounding of one and the same position. LinuxCNC 2.9 does the same
/// (emccanon.cc).
inline constexpr double kNoMotion_mm = 1e-7;

/// Whether a straight move is rotary only: its feed per minute is then an angle.
inline bool moves_only_rotary_axes(const ProgramMove& move) {
  if (move.kind != MoveKind::straight) return false;
  bool linear = false, rotary = false;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if (k >= 3 && k < 6) {
      rotary = rotary || move.start[k] != move.end[k];
    } else {
      linear = linear || std::abs(move.end[k] - move.start[k]) > kNoMotion_mm;
    }
  }
  return rotary && !linear;
}

/// A piece of a corrected move: the control moves all words to its end in a straight line.
struct CorrectedPiece {
  WordValues end{};  ///< mm, rad
  double feed = 0;   ///< as `feed_mode`
  FeedMode feed_mode = FeedMode::per_minute;
  bool exact = false;  ///< the control goes through its end and does not round the corner to the next piece
};

/// Pieces of several moves, in their order: those of move i are pieces[first[i]] to pieces[first[i + 1] - 1].
struct CorrectedPieces {
  std::vector<CorrectedPiece> pieces;
  std::vector<std::size_t> first;  ///< [moves + 1]
};

/// Corrects the moves of a program: the interface between formats (text) and compensate (moves).
class MoveCorrector {
 public:
  virtual ~MoveCorrector() = default;

  /// Called with the moves of a program in order, in batches of any size. Every move gives at least one piece; the
  /// pieces of the last call may be overwritten.
  virtual void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) = 0;
};

}  // namespace abbe
