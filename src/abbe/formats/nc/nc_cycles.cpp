#include "abbe/formats/nc/nc_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// How far above the bottom of the hole so far the next peck begins; LinuxCNC 2.9.
constexpr double kPeckClearance_mm = 0.254;
constexpr std::size_t kMostPecks = 100'000;

bool is_pecking(NcCode motion) { return motion == 730 || motion == 830; }
bool is_tapping(NcCode motion) { return motion == 740 || motion == 840; }
bool dwells_at_bottom(NcCode motion) { return motion == 820 || motion == 860 || motion == 890; }

}  // namespace

void NcCycles::check(const NcCodedBlock& block) const {
  const NcWord& word = block.motion_word();
  if (state_.offsets.tool_centre()) {
    block.fail(word, "a canned cycle while tool centre control is on", "G49 before it");
  }
  if (block.code(NcGroup::non_modal) == 530) block.fail(word, "a canned cycle with G53");
  if (block.axes == 0) block.fail(word, "a canned cycle without axis words");
  if ((block.axes & ~kXyzWords) != 0) block.fail(word, "a canned cycle with words other than X, Y, Z");
  if (state_.modes.feed_mode == FeedMode::inverse_time) {
    block.fail(word, "a canned cycle with inverse time", "G94");
  }
  moves_.check_feed(block, "a canned cycle");
}

void NcCycles::take_words(const NcCodedBlock& block, NcCode motion, std::size_t depth) {
  const NcWord& word = block.motion_word();
  const bool goes_on = state_.modes.motion == motion && code_ == motion;
  const auto take = [&](char letter, double& stored) {
    if (block.has(letter)) {
      stored = block.value(letter);
    } else if (!goes_on) {
      block.fail(word, fmt::format("{} is missing in this cycle", static_cast<char>(letter - 'a' + 'A')));
    }
  };
  take('r', r_);
  take(kAxisLetters[depth], bottom_);
  if (dwells_at_bottom(motion)) take('p', dwell_);
  // Without P that of the cycle before it, as in LinuxCNC 2.9; none in the beginning.
  if (is_tapping(motion) && block.has('p')) dwell_ = block.value('p');
  if ((dwells_at_bottom(motion) || is_tapping(motion)) && dwell_ < 0)
    block.fail(word, "the time of the dwell is negative");
  const int direction = state_.spindle.direction();
  if (is_tapping(motion) && direction != (motion == 840 ? 3 : 4)) {
    block.fail(word, "the spindle does not turn as this cycle requires", motion == 840 ? "M3" : "M4");
  }
  if (is_pecking(motion)) {
    take('q', step_);
    if (!(step_ > 0)) block.fail(word, "the step Q is not positive");
  }
  if (motion == 860 && direction == 0) {
    block.fail(word, "the spindle does not turn, which this cycle stops", "M3 or M4");
  }
  code_ = motion;
  // The level before the first of several cycles: they return to it, and incremental R counts from it.
  if (state_.modes.motion < 730 || state_.modes.motion == 800) level_ = state_.position.values()[depth];
}

NcCycles::Heights NcCycles::heights(const NcCodedBlock& block, std::size_t depth) const {
  const NcModes& modes = state_.modes;
  const double length = modes.unit(depth), zero = state_.position.zero()[depth];
  const double r = modes.absolute ? r_ * length + zero : level_ + r_ * length;
  const double bottom = modes.absolute ? bottom_ * length + zero : r + bottom_ * length;
  if (!(bottom <= r)) block.fail(block.motion_word(), "R is below the bottom of the hole", "R above it");
  return {depth, r, bottom, modes.retract_to_r ? r : std::max(r, level_)};
}

NcPlace NcCycles::above_next_hole(const NcCodedBlock& block, const Heights& heights) const {
  const NcPosition& position = state_.position;
  NcPlace above = position.here();
  for_axes(block.axes & ~axis_bit(heights.axis), [&](std::size_t k) {
    const double value = state_.modes.length(block, k);
    above.values[k] = state_.modes.absolute ? value + position.zero()[k] : position.values()[k] + value;
    above.known |= axis_bit(k);
  });
  // From above R at the height where it stands, though it be below that to which G98 has it return again.
  if (!(position.values()[heights.axis] > heights.r)) above.values[heights.axis] = heights.clear;
  return above;
}

void NcCycles::rapid_to(const NcCodedBlock& block, const Heights& heights, double height) {
  NcPlace to = state_.position.here();
  to.values[heights.axis] = height;
  moves_.rapid(block, to);
}

void NcCycles::straight_to(const NcCodedBlock& block, const Heights& heights, double height, SpindleMove spindle) {
  NcPlace to = state_.position.here();
  to.values[heights.axis] = height;
  moves_.straight(block, to, spindle);
}

void NcCycles::run(const NcCodedBlock& block, NcCode motion) {
  const NcModes& modes = state_.modes;
  check(block);
  const std::size_t depth = modes.plane == ArcPlane::XY ? 2 : modes.plane == ArcPlane::ZX ? 1 : 0;
  take_words(block, motion, depth);
  const double repeats = block.has('l') ? block.value('l') : 1;
  if (!(repeats >= 1 && repeats <= 1e6) || std::abs(repeats - std::round(repeats)) > 1e-4) {
    block.fail('l', "is not a number of repeats", "a whole number from 1 to 1000000");
  }
  state_.position.require(modes.absolute ? axis_bit(depth) : kXyzWords, block, "the cycle begins there");
  const Heights to = heights(block, depth);

  // Source: LinuxCNC 2.9, measured: up to R first where the level is below it, and between the holes at the height to
  // which the cycle returns.
  if (level_ < to.r) rapid_to(block, to, to.r);
  const std::string path = state_.path.block();
  if (!path.empty()) writer_.line("G61");
  writer_.set_path("");
  for (long i = 0; i < std::lround(repeats); ++i) {
    moves_.rapid(block, above_next_hole(block, to));
    if (state_.position.values()[depth] != to.r) rapid_to(block, to, to.r);
    drill(block, motion, to);
  }
  if (!path.empty()) writer_.line(path);
  writer_.set_path(state_.path.rounding_block());
}

void NcCycles::peck(const NcCodedBlock& block, NcCode motion, const Heights& heights) {
  const double step = step_ * state_.modes.unit(heights.axis);
  if (!((heights.r - heights.bottom) / step <= static_cast<double>(kMostPecks))) {
    block.fail(block.words[0], fmt::format("the hole takes more than {} pecks", kMostPecks), "a larger Q");
  }
  for (double height = heights.r - step; height > heights.bottom; height -= step) {
    straight_to(block, heights, height);
    if (motion == 830) rapid_to(block, heights, heights.r);
    rapid_to(block, heights, height + kPeckClearance_mm);
  }
}

void NcCycles::tap(const NcCodedBlock& block, NcCode motion, const Heights& heights) {
  // Source: LinuxCNC 2.9, measured. At the feed, so the tap holder must give way; overrides would spoil the thread.
  const bool right = motion == 840, overrides = state_.spindle.has_overrides();
  if (overrides) writer_.line("M49");
  straight_to(block, heights, heights.bottom, SpindleMove::tapping);
  writer_.line("M5");
  writer_.line(right ? "M4" : "M3");
  if (dwell_ > 0) writer_.line(fmt::format("G4 P{}", dwell_));
  straight_to(block, heights, heights.clear, SpindleMove::tapping);
  writer_.line("M5");
  writer_.line(right ? "M3" : "M4");
  if (overrides) writer_.line("M48");
}

void NcCycles::drill(const NcCodedBlock& block, NcCode motion, const Heights& heights) {
  if (is_tapping(motion)) {
    tap(block, motion, heights);
    return;
  }
  if (is_pecking(motion)) peck(block, motion, heights);
  straight_to(block, heights, heights.bottom);
  if (dwells_at_bottom(motion)) writer_.line(fmt::format("G4 P{}", dwell_));
  if (motion == 860) {
    writer_.line("M5");
    rapid_to(block, heights, heights.clear);
    writer_.line(state_.spindle.direction() == 3 ? "M3" : "M4");
    return;
  }
  if (motion == 890) {
    straight_to(block, heights, heights.clear);
    return;
  }
  if (motion == 850) {
    straight_to(block, heights, heights.r);
    if (heights.clear == heights.r) return;
  }
  rapid_to(block, heights, heights.clear);
}

}  // namespace abbe
