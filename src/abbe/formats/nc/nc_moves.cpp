#include "abbe/formats/nc/nc_moves.h"

#include <fmt/format.h>

#include "abbe/formats/nc/nc_arc.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

void set_radians(const NcAxisValues& words, WordValues& radians) {
  for (std::size_t k = 0; k < kAxisWords; ++k) radians[k] = words[k] * (is_rotary_word(k) ? kDegree : 1);
}

WordValues in_radians(const NcAxisValues& words) {
  WordValues radians;
  set_radians(words, radians);
  return radians;
}

/// As ProgramMove says it.
double feed_of(const ProgramMove& move, const NcModes& modes) {
  if (modes.feed_mode == FeedMode::per_minute && moves_only_rotary_axes(move)) return modes.feed * kDegree;
  return modes.feed_mode != FeedMode::inverse_time && modes.feed_inches ? modes.feed * kInch : modes.feed;
}

}  // namespace

NcMoves::NcMoves(NcState& state, NcFlow& flow, NcWriter& writer, const std::string& file,
                 const NcProgramOptions& options)
    : state_(state), position_(state.position), flow_(flow), writer_(writer), file_(file), options_(options) {}

NcPlace NcMoves::target(const NcCodedBlock& block) const {
  const NcModes& modes = state_.modes;
  NcPlace target = position_.here();
  const bool in_machine = block.code(NcGroup::non_modal) == 530;
  if (in_machine && state_.offsets.tool_centre()) {
    block.fail(block.word(NcGroup::non_modal), "G53 while tool centre control is on", "G49 before it");
  }
  if (in_machine && !modes.absolute) {
    block.fail(block.word(NcGroup::non_modal), "G53 in incremental distances", "G90");
  }
  for_axes(block.axes, [&](std::size_t k) {
    const double value = modes.length(block, k);
    if (modes.absolute) {
      target.values[k] = in_machine ? value : value + position_.zero()[k];
      target.known |= axis_bit(k);
    } else {
      if (value != 0) position_.require(axis_bit(k), block, "G91 counts from there");
      target.values[k] += value;
    }
  });
  return target;
}

void NcMoves::check_feed(const NcCodedBlock& block, const char* what) const {
  const auto missing = [&](const char* problem, const char* expected) {
    block.fail_at_begin(fmt::format("{} {}", what, problem), expected);
  };
  if (state_.modes.feed_mode == FeedMode::inverse_time && !block.has('f')) {
    missing("with inverse time and without F", "F in 1/min in every block of such moves");
  }
  if (!(state_.modes.feed > 0)) missing("without a feed", "F before or in this block");
  if (state_.modes.feed_mode == FeedMode::per_revolution && !(state_.spindle.speed() > 0)) {
    missing("with a feed per revolution and without a speed of the spindle", "S before or in this block");
  }
}

void NcMoves::emit(const NcCodedBlock& block, ProgramMove& move, const NcPlace& target) {
  move.line = block.cursor.line;
  move.coordinates = state_.offsets.tool_centre() ? ProgramCoordinates::tool_centre : ProgramCoordinates::axes;
  move.feed_mode = state_.modes.feed_mode;
  const std::uint32_t unknown = position_.unknown();
  if (position_.counts_in_plane()) {
    require_known_words(kXyzWords & ~target.known, block, "in a tilted plane every move takes all three");
    if (move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise) {
      // Axes that are not at right angles show a circle of a turned workpiece as an ellipse.
      if (!position_.plane()->keeps_arcs()) {
        block.fail(block.words[0], "an arc in a tilted plane, on a machine whose X, Y and Z are not at right angles",
                   "straight moves: in these axes it is not an arc");
      }
      position_.plane()->turn_arc(position_.values(), move);
    }
  }
  const NcAxisValues end = position_.axes_at(target.values);
  set_radians(position_.axes(), move.start);
  set_radians(end, move.end);
  for (std::size_t k = 0; k < 3; ++k) move.tool_length[k] = state_.offsets.tool()[k];
  if (move.kind != MoveKind::rapid) {
    if (unknown != 0) require_known_words(unknown, block, "a move at work begins there");
    move.feed = feed_of(move, state_.modes);
  }
  if (move.spindle == SpindleMove::thread || move.spindle == SpindleMove::rigid_tapping) {
    move.feed_mode = FeedMode::per_revolution;
    move.feed = block.value('k') * state_.modes.unit(0);
  }
  if (first_assumed_offset_line_ == 0 && !state_.offsets.is_system_said() && block.code(NcGroup::non_modal) != 530) {
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
  const std::uint32_t machine_words = position_.machine_words();
  writer_.move(move, target.known & machine_words, (machine_words & ~target.known) == 0);
  position_.go(target, end);
}

void NcMoves::rapid(const NcCodedBlock& block, const NcPlace& target) {
  ProgramMove move;
  move.kind = MoveKind::rapid;
  emit(block, move, target);
}

void NcMoves::straight(const NcCodedBlock& block, const NcPlace& target, SpindleMove spindle) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.spindle = spindle;
  emit(block, move, target);
}

void NcMoves::line(const NcCodedBlock& block, NcCode motion) {
  // G53 is of the axes in a tilted plane too.
  const bool leaves_plane = position_.plane() && block.code(NcGroup::non_modal) == 530;
  if (leaves_plane) position_.leave_plane();
  const NcPlace to = target(block);
  if (motion == 0) {
    rapid(block, to);
  } else {
    check_feed(block, "G1");
    straight(block, to);
  }
  if (leaves_plane) enter_plane(block);
}

void NcMoves::arc(const NcCodedBlock& block, NcCode motion) {
  check_feed(block, motion == 20 ? "G2" : "G3");
  check_arc_words(block, state_.modes);
  const NcPlace to = target(block);
  ProgramMove move = arc_of_block(block, motion, state_.modes, position_, to);
  emit(block, move, to);
}

void NcMoves::thread(const NcCodedBlock& block, NcCode motion) {
  const NcWord& word = block.motion_word();
  const char* const name = motion == 330 ? "G33" : "G33.1";
  if (block.axes == 0) block.fail(word, fmt::format("{} without axis words", name));
  if ((block.axes & ~kXyzWords) != 0) block.fail(word, fmt::format("{} with words other than X, Y, Z", name));
  if (!block.has('k')) block.fail(word, fmt::format("{} without its pitch", name), "K");
  if (!(block.value('k') > 0)) block.fail('k', "the pitch is not positive");
  const NcPlace to = target(block);
  const NcAxisValues before = position_.values(), axes_before = position_.axes();
  if (to.values == before) block.fail(word, fmt::format("{} that does not move", name));
  if (state_.spindle.direction() == 0) {
    block.fail(word, fmt::format("{} and the spindle does not turn", name), "M3 or M4 before it");
  }
  straight(block, to, motion == 330 ? SpindleMove::thread : SpindleMove::rigid_tapping);
  // The control goes back by itself.
  if (motion == 331) position_.go({before, position_.known()}, axes_before);
}

void NcMoves::reference(const NcCodedBlock& block) {
  const NcWord& word = block.word(NcGroup::non_modal);
  const NcPlace& home = state_.references[block.code(NcGroup::non_modal) == 280 ? 0 : 1];
  if (state_.offsets.tool_centre()) {
    block.fail(word, "a reference position while tool centre control is on", "G49 before it");
  }
  const std::uint32_t axes = block.axes != 0 ? block.axes : position_.machine_words();
  if ((axes & ~home.known) != 0) {
    block.fail(word, "the reference position is not known", "parameters 5161 (G28) or 5181 (G30) and the following");
  }
  if (block.axes != 0) rapid(block, target(block));
  NcPlace to = position_.here();
  for_axes(axes, [&](std::size_t k) { to.values[k] = home.values[k]; });
  to.known |= axes;
  rapid(block, to);
}

void NcMoves::enter_plane(const NcCodedBlock& block) {
  position_.require(position_.machine_words() & kRotaryWords, block, "a tilted plane counts from there");
  const NcAxisValues offset = state_.offsets.sum();
  const WordValues at_zero = in_radians(offset), stands = in_radians(position_.values());
  const std::array<double, 3> tool = {state_.offsets.tool()[0], state_.offsets.tool()[1], state_.offsets.tool()[2]};
  position_.enter_plane([&](const Eigen::Vector3d& in_plane) {
    const Eigen::Vector3d place = position_.plane()->place(in_plane);
    WordValues words = stands;
    for (Eigen::Index k = 0; k < 3; ++k) {
      words[static_cast<std::size_t>(k)] = offset[static_cast<std::size_t>(k)] + place[k];
    }
    if (!words_are_points()) options_.planes->turn_with_workpiece(at_zero, tool, words);
    return Eigen::Vector3d(words[0], words[1], words[2]);
  });
}

void NcMoves::turn_to_plane(const NcCodedBlock& block) {
  position_.leave_plane();
  const Eigen::Vector3d normal = position_.plane()->normal();
  const NcAxisValues& stands = position_.values();
  WordValues words = in_radians(stands);
  const std::string problem =
      options_.planes->turn_tool(words_are_points() ? ProgramCoordinates::tool_centre : ProgramCoordinates::axes,
                                 {normal[0], normal[1], normal[2]}, in_radians(state_.offsets.sum()), words);
  if (!problem.empty()) {
    block.fail(block.word(NcGroup::non_modal), problem,
               "another plane, or a start position from which that is possible");
  }
  NcPlace to = position_.here();
  for_axes(position_.machine_words() & kRotaryWords, [&](std::size_t k) {
    if (words[k] != stands[k] * kDegree) to.values[k] = words[k] / kDegree;
  });
  // At the feed where the program moves at one, else at rapid traverse.
  if (state_.modes.motion >= 10 && state_.modes.motion <= 30) {
    check_feed(block, "G53.1");
    straight(block, to);
  } else {
    rapid(block, to);
  }
  enter_plane(block);
}

}  // namespace abbe
