#pragma once

#include "abbe/compensate/axis_error_bound.h"
#include "abbe/compensate/program/factor_bounds.h"

namespace abbe {

/// Bounds of a vector x(s) of the nominal chain and of its difference e(s) = actual - nominal. `bend` of the difference
/// holds twice the sum of jumps besides, so that max|g''| / 8 + sum|jumps| / 4 is an eighth of it.
struct Majorant {
  double speed = 0, bend = 0;
  double off = 0, off_speed = 0, off_bend = 0;

  void add(double value, double rate, double second) {
    off += value;
    off_speed += rate;
    off_bend += second;
  }

  /// (R - 1) v added, with bounds of R - 1 and its derivatives; v = nominal + difference.
  void turn(double length, double value, double rate, double second) {
    const double v = length + off, v_speed = speed + off_speed, v_bend = bend + off_bend;
    add(value * v, rate * v + value * v_speed, second * v + 2 * rate * v_speed + value * v_bend);
  }
};

/// E - 1 of an axis along s.
struct ErrorAlong {
  ErrorAlong(const AxisErrorBound& e, double speed, double bend)
      : shift(e.shift),
        shift_rate(e.shift_slope * speed),
        shift_second(e.shift_bend * speed * speed + e.shift_slope * bend + 2 * e.shift_jumps * speed),
        turn(e.turn),
        turn_rate(e.turn_slope * speed),
        turn_second(e.turn_bend * speed * speed + e.turn_slope * bend + 2 * e.turn_jumps * speed) {}

  /// Error motions with a state besides: sums of vectors, of which the angles make one rotation again.
  void add_with_states(const BoundAlong& shifts, const BoundAlong& angles);

  double shift, shift_rate, shift_second;
  double turn, turn_rate, turn_second;
};

/// Line of an axis along s: how far it is turned, and how far the axis is from its command.
struct LineBound {
  double turn = 0, turn_rate = 0, turn_second = 0;  ///< of the matrix K - 1
  double offset_second = 0;                         ///< of actual - commanded
};

/// A rotary axis at q' about a displaced line instead of at q about its own.
/// @param actual_speed  of q'
void rotate(Majorant& m, double length, double across, double speed, double actual_speed, double offset,
            double offset_speed, const LineBound& line);

/// What a rotary axis leaves of a shift of its line, (1 - K Rot K') d.
void shift_line(Majorant& m, const BoundAlong& shift, double actual_speed, const LineBound& line);

}  // namespace abbe
