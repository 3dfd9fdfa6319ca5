#include "abbe/formats/nc/nc_arc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

/// First, second and normal axis of a plane: X Y Z, Z X Y, Y Z X.
struct ArcAxes {
  std::size_t first, second, normal;

  explicit ArcAxes(ArcPlane plane)
      : first(plane == ArcPlane::XY   ? 0
              : plane == ArcPlane::ZX ? 2
                                      : 1),
        second((first + 1) % 3),
        normal((first + 2) % 3) {}
};

void set_arc_by_centre(const NcCodedBlock& block, const NcModes& modes, const NcPosition& position,
                       const NcAxisValues& end, const ArcAxes& axes, ProgramMove& move) {
  const NcAxisValues& start = position.values();
  for (const std::size_t k : {axes.first, axes.second}) {
    const char letter = "ijk"[k];
    const bool given = block.has(letter);
    if (modes.arc_absolute && !given) {
      block.fail(block.words[0], "an arc with half a centre", "both coordinates of the centre with G90.1");
    }
    const double value = given ? block.value(letter) * modes.unit(k) : 0;
    move.arc_centre[k] = modes.arc_absolute ? value + position.zero()[k] : value + start[k];
  }
  // What rounding to 0.01 mm or 0.001 inch of start, end and centre can do.
  // Source: LinuxCNC 2.9, measured: tolerance 0.02 sqrt(2) mm, 0.002 sqrt(2) inch; see docs/nc-programs.md.
  const double tolerance = 2 * std::numbers::sqrt2 * (modes.inches ? 0.001 * kInch : 0.01);
  const auto radius_at = [&](const NcAxisValues& place) {
    return std::hypot(place[axes.first] - move.arc_centre[axes.first],
                      place[axes.second] - move.arc_centre[axes.second]);
  };
  const double from_start = radius_at(start), from_end = radius_at(end);
  const double difference = std::abs(from_start - from_end);
  if (from_start < 1e-9 || from_end < 1e-9) {
    block.fail(block.words[0], "an arc of radius zero", "a centre away from start and end");
  }
  if (difference > 100 * tolerance || (difference > tolerance && difference > 1e-3 * std::max(from_start, from_end))) {
    block.fail(
        block.words[0],
        fmt::format("the end of the arc is {:.4f} mm from its centre, the start {:.4f} mm", from_end, from_start),
        "a centre as far from both");
  }
}

void set_arc_by_radius(const NcCodedBlock& block, double radius, const NcAxisValues& start, const NcAxisValues& end,
                       const ArcAxes& axes, ProgramMove& move) {
  const double along = end[axes.first] - start[axes.first], across = end[axes.second] - start[axes.second];
  const double chord = std::hypot(along, across);
  if (chord == 0)
    block.fail('r', "the arc ends where it begins, so its radius does not determine it", "a centre by I J K");
  const double size = std::abs(radius), half = chord / 2;
  // Source: LinuxCNC 2.9, measured: 0.00127 mm, 0.00005 inch.
  if (half - size > 0.00005 * kInch) {
    block.fail('r', fmt::format("the radius is too small to reach the end, which is {:.4f} mm away", chord),
               "at least half of that");
  }
  const double height = half >= size ? 0 : std::sqrt((size - half) * (size + half));
  // A positive radius is the arc of at most half a turn: its centre is on the right of G2's chord, on the left of G3's.
  const bool on_the_left = (move.kind == MoveKind::arc_counterclockwise) == (radius > 0);
  const double side = on_the_left ? height : -height;
  move.arc_centre[axes.first] = start[axes.first] + along / 2 - side * across / chord;
  move.arc_centre[axes.second] = start[axes.second] + across / 2 + side * along / chord;
}

}  // namespace

void check_arc_words(const NcCodedBlock& block, const NcModes& modes) {
  const char normal = "ijk"[ArcAxes(modes.plane).normal];
  if (block.has(normal)) block.fail(normal, "is not a centre in this plane", "a letter of the plane");
  if (block.has_centre() && block.has('r')) block.fail('r', "a radius beside a centre");
  if (!block.has_centre() && !block.has('r')) {
    block.fail(block.motion_word(), "an arc without a centre or a radius", "I J K, or R");
  }
}

ProgramMove arc_of_block(const NcCodedBlock& block, NcCode motion, const NcModes& modes, const NcPosition& position,
                         const NcPlace& target) {
  const ArcAxes axes(modes.plane);
  ProgramMove move;
  move.kind = motion == 20 ? MoveKind::arc_clockwise : MoveKind::arc_counterclockwise;
  move.plane = modes.plane;
  const std::uint32_t plane_axes = axis_bit(axes.first) | axis_bit(axes.second);
  position.require(plane_axes, block, "an arc begins there");
  if (block.has('r') && (block.axes & plane_axes) == 0) {
    block.fail(block.motion_word(), "an arc by its radius without an end in its plane", "the end point");
  }
  if (block.has('p')) {
    const double turns = block.value('p');
    if (!(turns >= 1 && turns <= 1e6) || std::abs(turns - std::round(turns)) > 1e-4) {
      block.fail('p', "is not a number of turns", "a whole number from 1 to 1,000,000");
    }
    move.arc_turns = static_cast<int>(std::lround(turns));
  }
  if (block.has_centre()) {
    set_arc_by_centre(block, modes, position, target.values, axes, move);
  } else {
    set_arc_by_radius(block, block.value('r') * modes.unit(0), position.values(), target.values, axes, move);
  }
  return move;
}

}  // namespace abbe
