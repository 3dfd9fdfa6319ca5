#include "abbe/compensate/program/piece_majorant.h"

#include <algorithm>
#include <cmath>

namespace abbe {

void ErrorAlong::add_with_states(const BoundAlong& shifts, const BoundAlong& angles) {
  shift += shifts.value;
  shift_rate += shifts.rate;
  shift_second += shifts.second;
  // As AxisErrorCells::bound(): bounds of R - 1 are bounds of the angles too.
  const double value = turn + angles.value, rate = turn_rate + angles.rate, second = turn_second + angles.second;
  const double skewed = std::min(value, 1.0), stretch = std::sqrt(1 + skewed);
  turn = stretch * value;
  turn_rate = stretch * rate;
  turn_second = stretch * second + (2 + skewed) * rate * rate;
}

void rotate(Majorant& m, double length, double across, double speed, double actual_speed, double offset,
            double offset_speed, const LineBound& line) {
  // e <- Rot(q) e + [K Rot(q') K' - Rot(q)] (x + e)
  const Majorant before = m;
  m.off_speed += speed * before.off;
  m.off_bend += 2 * speed * before.off_speed + speed * speed * before.off;
  // Along the axis line Rot(q') - Rot(q) is zero: the lever is the distance from the line.
  const double turn = std::min(offset, 2.0), turn_speed = offset_speed + turn * speed;
  const double turn_bend = 2 * speed * offset_speed + offset_speed * offset_speed + turn * speed * speed;
  const double v_speed = before.speed + before.off_speed, v_bend = before.bend + before.off_bend;
  const double v = across + before.off;
  m.add(turn * v, turn_speed * v + turn * v_speed, turn_bend * v + 2 * turn_speed * v_speed + turn * v_bend);
  m.add(0, 0, line.offset_second * v);
  const double tilt = 2 * line.turn, w = length + before.off;
  m.add(tilt * w, tilt * (actual_speed * w + v_speed),
        tilt * (actual_speed * actual_speed * w + 2 * actual_speed * v_speed + v_bend));
  if (line.turn_rate > 0 || line.turn_second > 0 || line.offset_second > 0) {
    // K changes too: derivatives of (K - 1) Rot K' + Rot (K' - 1) that the line above does not have.
    const double k = line.turn, rate = line.turn_rate, second = line.turn_second;
    const double more_rate = (2 + k) * rate;
    const double more_second =
        (2 + k) * second + (4 + 2 * k) * rate * actual_speed + 2 * rate * rate + tilt * line.offset_second;
    m.add(0, more_rate * w, more_second * w + 2 * more_rate * v_speed);
  }
  m.bend = before.bend + 2 * speed * before.speed + speed * speed * across;
  m.speed = before.speed + speed * across;
}

void shift_line(Majorant& m, const BoundAlong& shift, double actual_speed, const LineBound& line) {
  m.add(2 * shift.value, shift.value * actual_speed, shift.value * (actual_speed * actual_speed));
  const double k = line.turn_rate;
  m.add(0, 2 * k * shift.value + 2 * shift.rate,
        (4 * actual_speed * k + 2 * line.turn_second + 2 * k * k + line.offset_second) * shift.value +
            2 * (actual_speed + 2 * k) * shift.rate + 2 * shift.second);
}

}  // namespace abbe
