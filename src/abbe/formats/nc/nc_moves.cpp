// Moves of an NC program: straight lines, arcs, references.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/formats/nc/nc_interpreter.h"
#include "abbe/formats/nc/nc_units.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {

void NcInterpreter::fail_unknown(std::uint32_t words, const std::string& why) const {
  std::string names;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((words >> k & 1) == 0) continue;
    if (!names.empty()) names += ", ";
    names += "XYZABCUVW"[k];
  }
  NcCursor place = block_.cursor;
  place.at = place.begin;
  place.skip_blanks();
  const char* const first = place.at;
  place.fail(first,
             fmt::format("where {} {} is not known here, and {}", names, names.size() > 1 ? "stand" : "stands", why),
             "a G0 before it that names these axes, or where they stand when the program begins (--start X_mm=0)");
}

NcInterpreter::Words NcInterpreter::ends(std::uint32_t& known) const {
  Words end = position_;
  known = known_;
  const bool in_machine = codes_[NcGroup::non_modal] == 530;
  if (in_machine && modes_.tool_centre) {
    block_.fail(codes_.word(block_, NcGroup::non_modal), "G53 while tool centre control is on", "G49 before it");
  }
  if (in_machine && !modes_.absolute) {
    block_.fail(codes_.word(block_, NcGroup::non_modal), "G53 in incremental distances", "G90");
  }
  for (std::uint32_t axes = codes_.axes; axes != 0; axes &= axes - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(axes));
    const double value = block_.value("xyzabcuvw"[k]) * unit(k);
    if (modes_.absolute) {
      end[k] = in_machine ? value : value + offset_[k];
      known |= std::uint32_t{1} << k;
    } else {
      if (value != 0 && (known_ >> k & 1) == 0) fail_unknown(std::uint32_t{1} << k, "G91 counts from there");
      end[k] += value;
    }
  }
  return end;
}

void NcInterpreter::check_feed(const char* what) {
  const auto missing = [&](const char* problem, const char* expected) {
    NcCursor place = block_.cursor;
    place.at = place.begin;
    place.skip_blanks();
    const char* const first = place.at;
    place.fail(first, fmt::format("{} {}", what, problem), expected);
  };
  if (modes_.feed_mode == FeedMode::inverse_time && !block_.has('f')) {
    missing("with inverse time and without F", "F in 1/min in every block of such moves");
  }
  if (!(modes_.feed > 0)) missing("without a feed", "F before or in this block");
  if (modes_.feed_mode == FeedMode::per_revolution && !(spindle_speed_ > 0)) {
    missing("with a feed per revolution and without a speed of the spindle", "S before or in this block");
  }
}

void NcInterpreter::emit(ProgramMove& move, const Words& end, std::uint32_t known) {
  move.line = block_.cursor.line;
  move.coordinates = modes_.tool_centre ? ProgramCoordinates::tool_centre : ProgramCoordinates::axes;
  move.feed_mode = modes_.feed_mode;
  const std::uint32_t unknown = machine_words_ & ~known_;
  if (tilt_.counts) {
    constexpr std::uint32_t kLinear = 7;
    if ((kLinear & ~known) != 0) fail_unknown(kLinear & ~known, "in a tilted plane every move takes all three");
    if (move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise) turn_arc_to_axes(move);
  }
  const Words& start = tilt_.counts ? machine_position_ : position_;
  const Words target = tilt_.counts ? axes_of_plane(end) : end;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    const double to = is_rotary_word(k) ? kDegree : 1;
    move.start[k] = start[k] * to;
    move.end[k] = target[k] * to;
  }
  for (std::size_t k = 0; k < 3; ++k) move.tool_length[k] = tool_offset_[k];
  if (move.kind != MoveKind::rapid) {
    if (unknown != 0) fail_unknown(unknown, "a move at work begins there");
    move.feed = modes_.feed;
    if (modes_.feed_mode == FeedMode::per_minute && moves_only_rotary_axes(move)) {
      move.feed *= kDegree;
    } else if (modes_.feed_mode != FeedMode::inverse_time && modes_.feed_inches) {
      move.feed *= kInch;
    }
  }
  if (move.spindle == SpindleMove::thread || move.spindle == SpindleMove::rigid_tapping) {
    move.feed_mode = FeedMode::per_revolution;
    move.feed = block_.value('k') * unit(0);
  }
  if (!system_is_said_[modes_.system] && first_assumed_offset_line_ == 0 && codes_[NcGroup::non_modal] != 530) {
    first_assumed_offset_line_ = move.line;
  }
  if (flow_.moves() > options_.most_repeated_moves) {
    throw InputError(
        {.file = file_, .line = move.line},
        fmt::format("{} moves in a loop that reaches no new line of the program", options_.most_repeated_moves),
        "a loop that ends");
  }
  // Where a rapid move begins does not matter to where it ends.
  if (unknown != 0) move.start = move.end;
  writer_.move(move, known & machine_words_, (machine_words_ & ~known) == 0);
  position_ = end;
  machine_position_ = target;
  known_ = known;
}

void NcInterpreter::rapid(const Words& end, std::uint32_t known) {
  ProgramMove move;
  move.kind = MoveKind::rapid;
  emit(move, end, known);
}

void NcInterpreter::straight(const Words& end, std::uint32_t known, SpindleMove spindle) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.spindle = spindle;
  emit(move, end, known);
}

void NcInterpreter::thread(NcCode motion) {
  const NcWord& word = codes_.has(NcGroup::motion) ? codes_.word(block_, NcGroup::motion) : block_.words[0];
  const char* const name = motion == 330 ? "G33" : "G33.1";
  if (codes_.axes == 0) block_.fail(word, fmt::format("{} without axis words", name));
  if ((codes_.axes & ~std::uint32_t{7}) != 0) block_.fail(word, fmt::format("{} with words other than X, Y, Z", name));
  if (!block_.has('k')) block_.fail(word, fmt::format("{} without its pitch", name), "K");
  if (!(block_.value('k') > 0)) block_.fail('k', "the pitch is not positive");
  std::uint32_t known = 0;
  const Words end = ends(known), before = position_, machine_before = machine_position_;
  if (end == before) block_.fail(word, fmt::format("{} that does not move", name));
  if (spindle_ == 0) block_.fail(word, fmt::format("{} and the spindle does not turn", name), "M3 or M4 before it");
  straight(end, known, motion == 330 ? SpindleMove::thread : SpindleMove::rigid_tapping);
  if (motion == 331) {
    // The control goes back by itself.
    position_ = before;
    machine_position_ = machine_before;
  }
}

void NcInterpreter::move_by_word(NcCode motion) {
  if (motion == 330 || motion == 331) {
    thread(motion);
    return;
  }
  if (motion > 30) {
    cycle(motion);
    return;
  }
  if (motion >= 20) {
    arc(motion);
    return;
  }
  // G53 is of the axes in a tilted plane too.
  const bool leaves_plane = tilt_.on && codes_[NcGroup::non_modal] == 530;
  if (leaves_plane) leave_plane();
  std::uint32_t known = 0;
  const Words end = ends(known);
  if (motion == 0) {
    rapid(end, known);
  } else {
    check_feed("G1");
    straight(end, known);
  }
  if (leaves_plane) enter_plane();
}

void NcInterpreter::go_to_reference() {
  const NcWord& word = codes_.word(block_, NcGroup::non_modal);
  const Reference& home = home_[codes_[NcGroup::non_modal] == 280 ? 0 : 1];
  if (modes_.tool_centre) block_.fail(word, "a reference position while tool centre control is on", "G49 before it");
  const std::uint32_t axes = codes_.axes != 0 ? codes_.axes : machine_words_;
  if ((axes & ~home.known) != 0) {
    block_.fail(word, "the reference position is not known", "parameters 5161 (G28) or 5181 (G30) and the following");
  }
  if (codes_.axes != 0) {
    std::uint32_t known = 0;
    const Words through = ends(known);
    rapid(through, known);
  }
  Words end = position_;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((axes >> k & 1) != 0) end[k] = home.value[k];
  }
  rapid(end, known_ | axes);
}

void NcInterpreter::arc(NcCode motion) {
  const NcWord* const word = codes_.has(NcGroup::motion) ? &codes_.word(block_, NcGroup::motion) : nullptr;
  const auto fail = [&](const std::string& problem, const std::string& expected) {
    if (word != nullptr) block_.fail(*word, problem, expected);
    block_.fail(block_.words[0], problem, expected);
  };
  check_feed(motion == 20 ? "G2" : "G3");
  // First, second and normal axis of the plane: X Y Z, Z X Y, Y Z X.
  const std::size_t first = modes_.plane == ArcPlane::XY ? 0 : modes_.plane == ArcPlane::ZX ? 2 : 1;
  const std::size_t second = (first + 1) % 3, normal = (first + 2) % 3;
  const bool has_centre = block_.has('i') || block_.has('j') || block_.has('k');
  if (block_.has("ijk"[normal])) block_.fail("ijk"[normal], "is not a centre in this plane", "a letter of the plane");
  if (has_centre && block_.has('r')) block_.fail('r', "a radius beside a centre");
  if (!has_centre && !block_.has('r')) fail("an arc without a centre or a radius", "I J K, or R");
  ProgramMove move;
  move.kind = motion == 20 ? MoveKind::arc_clockwise : MoveKind::arc_counterclockwise;
  move.plane = modes_.plane;
  std::uint32_t known = 0;
  const Words end = ends(known);
  const std::uint32_t plane_axes = (std::uint32_t{1} << first) | (std::uint32_t{1} << second);
  if ((plane_axes & ~known_) != 0) fail_unknown(plane_axes & ~known_, "an arc begins there");
  if (block_.has('r') && (codes_.axes & plane_axes) == 0) {
    fail("an arc by its radius without an end in its plane", "the end point");
  }
  if (block_.has('p')) {
    const double turns = block_.value('p');
    if (!(turns >= 1 && turns <= 1e6) || std::abs(turns - std::round(turns)) > 1e-4) {
      block_.fail('p', "is not a number of turns", "a whole number from 1 to 1,000,000");
    }
    move.arc_turns = static_cast<int>(std::lround(turns));
  }
  if (has_centre) {
    arc_by_centre(move, end, first, second);
  } else {
    arc_by_radius(move, end, first, second);
  }
  emit(move, end, known);
}

void NcInterpreter::arc_by_centre(ProgramMove& move, const Words& end, std::size_t first, std::size_t second) {
  for (const std::size_t k : {first, second}) {
    const char letter = "ijk"[k];
    const bool given = block_.has(letter);
    if (modes_.arc_absolute && !given) {
      block_.fail(block_.words[0], "an arc with half a centre", "both coordinates of the centre with G90.1");
    }
    const double value = given ? block_.value(letter) * unit(k) : 0;
    move.arc_centre[k] = modes_.arc_absolute ? value + offset_[k] : value + position_[k];
  }
  // What rounding to 0.01 mm or 0.001 inch of start, end and centre can do.
  // Source: LinuxCNC 2.9, measured: tolerance 0.02 sqrt(2) mm, 0.002 sqrt(2) inch; see docs/nc-programs.md.
  const double tolerance = 2 * std::numbers::sqrt2 * (modes_.inches ? 0.001 * kInch : 0.01);
  const double from_start =
      std::hypot(position_[first] - move.arc_centre[first], position_[second] - move.arc_centre[second]);
  const double from_end = std::hypot(end[first] - move.arc_centre[first], end[second] - move.arc_centre[second]);
  const double difference = std::abs(from_start - from_end);
  if (from_start < 1e-9 || from_end < 1e-9) {
    block_.fail(block_.words[0], "an arc of radius zero", "a centre away from start and end");
  }
  if (difference > 100 * tolerance || (difference > tolerance && difference > 1e-3 * std::max(from_start, from_end))) {
    block_.fail(
        block_.words[0],
        fmt::format("the end of the arc is {:.4f} mm from its centre, the start {:.4f} mm", from_end, from_start),
        "a centre as far from both");
  }
}

void NcInterpreter::arc_by_radius(ProgramMove& move, const Words& end, std::size_t first, std::size_t second) {
  const double radius = block_.value('r') * unit(0);
  const double along = end[first] - position_[first], across = end[second] - position_[second];
  const double chord = std::hypot(along, across);
  if (chord == 0) block_.fail('r', "the arc ends where it begins, which its radius does not say", "a centre by I J K");
  const double size = std::abs(radius), half = chord / 2;
  // Source: LinuxCNC 2.9, measured: 0.00127 mm, 0.00005 inch.
  if (half - size > 0.00005 * kInch) {
    block_.fail('r', fmt::format("the radius is too small to reach the end, which is {:.4f} mm away", chord),
                "at least half of that");
  }
  const double height = half >= size ? 0 : std::sqrt((size - half) * (size + half));
  // A positive radius is the arc of at most half a turn: its centre is on the right of G2's chord, on the left of G3's.
  const bool on_the_left = (move.kind == MoveKind::arc_counterclockwise) == (radius > 0);
  const double side = on_the_left ? height : -height;
  move.arc_centre[first] = position_[first] + along / 2 - side * across / chord;
  move.arc_centre[second] = position_[second] + across / 2 + side * along / chord;
}

}  // namespace abbe
