#pragma once

#include "abbe/compensate/program/program_move.h"

namespace abbe {

/// Path of one move in the words of its program: a straight line, or an arc or helix in X, Y, Z with all other words
/// linear in the angle. Where the radii of start and end differ, the radius is linear in the angle too, so that the arc
/// ends where the program says.
class MovePath {
 public:
  explicit MovePath(const ProgramMove& move);

  bool is_arc() const { return arc_; }
  /// Words at 0 <= s <= 1; exactly the start at 0 and the end at 1.
  void at(double s, WordValues& words) const;

  /// Bound of the second derivative of X, Y, Z by s, mm: 0 for a line. A chord over a share h of the move leaves the
  /// arc by at most h^2 / 8 of it (the sagitta r (1 - cos(h angle / 2)) is a little less).
  double bend() const { return bend_; }
  /// Bound of the rates of X, Y, Z by s, each; mm.
  std::array<double, 3> speed() const { return speed_; }
  /// Of an arc or helix, mm; where the radii differ, a bound of it.
  double arc_length() const { return arc_length_; }

 private:
  void set_turn(double from, double to);

  const ProgramMove* move_;
  bool arc_ = false, tilted_ = false;
  std::size_t first_ = 0, second_ = 1;  ///< words of the plane, from the first to the second counterclockwise
  double radius_ = 0, radius_end_ = 0, angle_ = 0, turn_ = 0;
  std::array<double, 3> outwards_{}, onwards_{};  ///< tilted: from the centre to the start, and ahead from there
  double bend_ = 0, arc_length_ = 0;
  std::array<double, 3> speed_{};
};

/// Length from which a control computes the duration of a straight motion, as LinuxCNC does: that of X Y Z if any of
/// them moves, else of U V W, else of the rotary words; mm or rad. Source: LinuxCNC, G-code reference, "Feed rate".
double feed_length(const WordValues& start, const WordValues& end);

/// Duration of a move as programmed, minutes; negative: not known (rapid moves, feed per revolution, no feed).
double move_duration(const ProgramMove& move);

/// Sets the feed of a piece so that it takes its share of the duration of the move.
///
/// G93: inverse time. G94: the feed of the move if the control then takes that duration, to 1 %; else inverse time (as
/// for a rotary move to which the correction adds a little linear motion, which would set the feed in the control).
/// @param duration  of the move, minutes, as move_duration()
/// @param share     of the move that the piece is
void set_piece_feed(const ProgramMove& move, double duration, double share, const WordValues& start,
                    CorrectedPiece& piece);

/// Sets the feed of a motion of one axis alone that belongs to a piece: that of the move, if the move is of the same
/// kind of axis; else, and with inverse time, a feed at which it is as fast as the piece and takes no longer.
/// @param rotary    of the axis
/// @param way       of the functional point by that motion, mm
/// @param duration  of the piece, minutes; not above 0: not known
/// @param moved     by the functional point in the piece, mm
void set_take_up_feed(const ProgramMove& move, bool rotary, double way, double duration, double moved,
                      CorrectedPiece& piece);

}  // namespace abbe
