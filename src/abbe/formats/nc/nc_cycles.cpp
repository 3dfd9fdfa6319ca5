// Canned cycles of an NC program, expanded into moves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/nc/nc_interpreter.h"

namespace abbe {
namespace {

/// How far above the bottom of the hole so far the next peck begins; LinuxCNC 2.9.
constexpr double kPeckClearance_mm = 0.254;
constexpr std::size_t kMostPecks = 100'000;

}  // namespace

void NcInterpreter::cycle(NcCode motion) {
  const NcWord& word = codes_.has(NcGroup::motion) ? codes_.word(block_, NcGroup::motion) : block_.words[0];
  if (modes_.tool_centre) block_.fail(word, "a canned cycle while tool centre control is on", "G49 before it");
  if (codes_[NcGroup::non_modal] == 530) block_.fail(word, "a canned cycle with G53");
  if (codes_.axes == 0) block_.fail(word, "a canned cycle without axis words");
  if ((codes_.axes & ~std::uint32_t{7}) != 0) block_.fail(word, "a canned cycle with words other than X, Y, Z");
  if (modes_.feed_mode == FeedMode::inverse_time) block_.fail(word, "a canned cycle with inverse time", "G94");
  check_feed("a canned cycle");
  const std::size_t depth = modes_.plane == ArcPlane::XY ? 2 : modes_.plane == ArcPlane::ZX ? 1 : 0;
  const std::size_t first = (depth + 1) % 3, second = (depth + 2) % 3;
  const bool goes_on = modes_.motion == motion && cycle_.code == motion;
  const char depth_letter = "xyz"[depth];
  const auto take = [&](char letter, double& stored, bool known) {
    if (block_.has(letter)) {
      stored = block_.value(letter);
    } else if (!known) {
      block_.fail(word, fmt::format("{} is missing in this cycle", static_cast<char>(letter - 'a' + 'A')));
    }
  };
  take('r', cycle_.r, goes_on);
  take(depth_letter, cycle_.bottom, goes_on);
  if (motion == 820 || motion == 860 || motion == 890) {
    take('p', cycle_.dwell, goes_on);
    if (cycle_.dwell < 0) block_.fail(word, "the time of the dwell is negative");
  }
  if (motion == 740 || motion == 840) {
    // Without P that of the cycle before it, as in LinuxCNC 2.9; none in the beginning.
    if (block_.has('p')) cycle_.dwell = block_.value('p');
    if (cycle_.dwell < 0) block_.fail(word, "the time of the dwell is negative");
    if (spindle_ != (motion == 840 ? 3 : 4)) {
      block_.fail(word, "the spindle does not turn as this cycle needs it", motion == 840 ? "M3" : "M4");
    }
  }
  if (motion == 730 || motion == 830) {
    take('q', cycle_.step, goes_on);
    if (!(cycle_.step > 0)) block_.fail(word, "the step Q is not positive");
  }
  if (motion == 860 && spindle_ == 0)
    block_.fail(word, "the spindle does not turn, which this cycle stops", "M3 or M4");
  cycle_.code = motion;
  // The level before the first of several cycles: they return to it, and incremental R counts from it.
  if (modes_.motion < 730 || modes_.motion == 800) cycle_.level = position_[depth];
  const double repeats = block_.has('l') ? block_.value('l') : 1;
  if (!(repeats >= 1 && repeats <= 1e6) || std::abs(repeats - std::round(repeats)) > 1e-4) {
    block_.fail('l', "is not a number of repeats", "a whole number from 1");
  }
  const std::uint32_t needed = modes_.absolute ? std::uint32_t{1} << depth : 7;
  if ((needed & ~known_) != 0) fail_unknown(needed & ~known_, "the cycle begins there");

  const double length = unit(depth);
  const double r = modes_.absolute ? cycle_.r * length + offset_[depth] : cycle_.level + cycle_.r * length;
  const double bottom = modes_.absolute ? cycle_.bottom * length + offset_[depth] : r + cycle_.bottom * length;
  if (!(bottom <= r)) block_.fail(word, "R is below the bottom of the hole", "R above it");
  const double clear = modes_.retract_to_r ? r : std::max(r, cycle_.level);

  // Source: LinuxCNC 2.9, measured: up to R first where the level is below it, and between the holes at the height to
  // which the cycle returns.
  if (cycle_.level < r) {
    Words up = position_;
    up[depth] = r;
    rapid(up, known_);
  }
  const std::string path = modes_.exact_path ? "" : path_words_.empty() ? "G64" : path_words_;
  if (!path.empty()) writer_.line("G61");
  writer_.set_path("");
  for (long i = 0; i < std::lround(repeats); ++i) {
    Words above = position_;
    std::uint32_t known = known_;
    for (const std::size_t k : {first, second}) {
      if (!block_.has("xyz"[k])) continue;
      const double value = block_.value("xyz"[k]) * unit(k);
      above[k] = modes_.absolute ? value + offset_[k] : position_[k] + value;
      known |= std::uint32_t{1} << k;
    }
    // From above R at the height where it stands, though it be below that to which G98 has it return again.
    if (!(position_[depth] > r)) above[depth] = clear;
    rapid(above, known);
    if (position_[depth] != r) {
      above[depth] = r;
      rapid(above, known_);
    }
    drill(motion, above, bottom, clear, depth);
  }
  if (!path.empty()) writer_.line(path);
  writer_.set_path(modes_.stops_in_corners ? "" : path);
}

void NcInterpreter::drill(NcCode motion, const Words& above, double bottom, double clear, std::size_t depth) {
  const auto to = [&](double height) {
    Words end = above;
    end[depth] = height;
    return end;
  };
  const double r = above[depth];
  if (motion == 730 || motion == 830) {
    const double step = cycle_.step * unit(depth);
    if (!((r - bottom) / step <= static_cast<double>(kMostPecks))) {
      block_.fail(block_.words[0], fmt::format("the hole takes more than {} pecks", kMostPecks), "a larger Q");
    }
    for (double height = r - step; height > bottom; height -= step) {
      straight(to(height), known_);
      if (motion == 830) rapid(to(r), known_);
      rapid(to(height + kPeckClearance_mm), known_);
    }
  }
  if (motion == 740 || motion == 840) {
    // Source: LinuxCNC 2.9, measured. At the feed, so the tap holder must give way; overrides would spoil the thread.
    const bool right = motion == 840;
    if (overrides_) writer_.line("M49");
    straight(to(bottom), known_, SpindleMove::tapping);
    writer_.line("M5");
    writer_.line(right ? "M4" : "M3");
    if (cycle_.dwell > 0) writer_.line(fmt::format("G4 P{}", cycle_.dwell));
    straight(to(clear), known_, SpindleMove::tapping);
    writer_.line("M5");
    writer_.line(right ? "M3" : "M4");
    if (overrides_) writer_.line("M48");
    return;
  }
  straight(to(bottom), known_);
  if (motion == 820 || motion == 860 || motion == 890) writer_.line(fmt::format("G4 P{}", cycle_.dwell));
  if (motion == 860) {
    writer_.line("M5");
    rapid(to(clear), known_);
    writer_.line(spindle_ == 3 ? "M3" : "M4");
    return;
  }
  if (motion == 890) {
    straight(to(clear), known_);
    return;
  }
  if (motion == 850) {
    straight(to(r), known_);
    if (clear == r) return;
  }
  rapid(to(clear), known_);
}

}  // namespace abbe
