component touch_ball "A touch probe over a ball on the table of the trunnion mill, whose rotary axes are not where they should be";

pin in float position-#[5] "X, Y, Z in mm, A, C in degrees: where the motors are";
pin out bit touching "the tip is nearer to the ball than both radii";
param rw float centre-#[3] "of the ball, mm, frame of the table";
param rw float radii = 15.5 "of ball and tip together, mm";
param rw float location-a-#[6] "EX0A EY0A EZ0A in mm, EA0A EB0A EC0A in rad";
param rw float location-c-#[6] "of C likewise";

function _;
license "GPL";
;;

/* Written from docs/conventions.md alone, so that nothing of the library judges itself: chain w C' A' Y' b X Z t of
 * examples/machines/trunnion-mill.machine.toml. */
#include <rtapi_math.h>

static const double degree = 0.017453292519943295;
static const double centre_a[3] = {0, 0.02, 50}, centre_c[3] = {0, 0, 0};
static const double tip_height = 560 - 150;

static void turn(int axis, double angle, double p[3]) {
  int i = (axis + 1) % 3, j = (axis + 2) % 3;
  double c = cos(angle), s = sin(angle), at_i = p[i], at_j = p[j];
  p[i] = c * at_i - s * at_j;
  p[j] = s * at_i + c * at_j;
}

/* p becomes L Trans(c) Rot(u, angle) Trans(-c) L^-1 p, where L is Rz Ry Rx and a shift about c. */
static void turned_about_its_line(int axis, double angle, const double c[3], const double location[6], double p[3]) {
  int i;
  for (i = 0; i < 3; ++i) p[i] -= c[i] + location[i];
  turn(2, -location[5], p);
  turn(1, -location[4], p);
  turn(0, -location[3], p);
  turn(axis, angle, p);
  turn(0, location[3], p);
  turn(1, location[4], p);
  turn(2, location[5], p);
  for (i = 0; i < 3; ++i) p[i] += c[i] + location[i];
}

FUNCTION(_) {
  double ball[3], a[6], c[6], x, y, z;
  int i;
  for (i = 0; i < 3; ++i) ball[i] = centre(i);
  for (i = 0; i < 6; ++i) {
    a[i] = location_a(i);
    c[i] = location_c(i);
  }
  /* Primed axes: the table moves the other way. */
  turned_about_its_line(2, -position(4) * degree, centre_c, c, ball);
  turned_about_its_line(0, -position(3) * degree, centre_a, a, ball);
  x = ball[0] - position(0);
  y = ball[1] - position(1);
  z = ball[2] - (tip_height + position(2));
  touching = sqrt(x * x + y * y + z * z) < radii;
}
