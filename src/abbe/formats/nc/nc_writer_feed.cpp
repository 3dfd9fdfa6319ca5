// Modes, feeds and pitches of corrected programs.
#include <algorithm>
#include <cmath>

#include "abbe/formats/nc/nc_number.h"
#include "abbe/formats/nc/nc_units.h"
#include "abbe/formats/nc/nc_word_units.h"
#include "abbe/formats/nc/nc_writer.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

std::string_view mode_word(FeedMode mode) {
  switch (mode) {
    case FeedMode::inverse_time:
      return "G93 ";
    case FeedMode::per_minute:
      return "G94 ";
    case FeedMode::per_revolution:
      break;
  }
  return "G95 ";
}

}  // namespace

double NcWriter::feed_word(const ProgramMove& move, const CorrectedPiece& piece, std::uint32_t moved,
                           FeedMode& mode) const {
  const double length_unit = frame_.inches ? kInch : 1;
  if (mode == FeedMode::inverse_time || move.kind == MoveKind::rapid) return piece.feed;
  if (mode == FeedMode::per_revolution) return piece.feed / length_unit;
  // Where only rotary axes move, F is an angle per minute to the control, and in the move.
  const bool is_angle = moved != 0 && (moved & ~kRotaryWords) == 0;
  if (is_angle == moves_only_rotary_axes(move) || moved == 0) return piece.feed / (is_angle ? kDegree : length_unit);
  // Rounding has made one of the other: the time says what is meant.
  constexpr double kFastest_per_min = 1e8;
  double squared = 0;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if (is_rotary_word(k) != is_angle) squared += (piece.end[k] - stands_[k]) * (piece.end[k] - stands_[k]);
  }
  mode = FeedMode::inverse_time;
  return squared > 0 ? std::min(piece.feed / std::sqrt(squared), kFastest_per_min) : kFastest_per_min;
}

FeedMode NcWriter::slow_feed(const ProgramMove& move, const std::array<std::int64_t, kAxisWords>& words,
                             std::uint32_t changed, double& feed) const {
  // In inverse time LinuxCNC 2.9 makes of F a feed per minute, and of one below this value this value.
  constexpr double kSlowestOfInverseTime = 0.1;
  if (move.feed_mode == FeedMode::inverse_time && !moves_only_rotary_axes(move)) return FeedMode::inverse_time;
  const double per_minute = feed_length(words, changed) * feed;
  if (!(per_minute > 0 && per_minute < kSlowestOfInverseTime)) return FeedMode::inverse_time;
  feed = per_minute;
  return FeedMode::per_minute;
}

double NcWriter::feed_of_angle(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed,
                               double feed) const {
  const double angle = feed_length(words, changed & kRotaryWords);
  const double length = feed_length(words, changed);
  return angle > 0 && length > 0 ? feed * length / angle : feed;
}

double NcWriter::feed_length(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed) const {
  for (const std::uint32_t group : {0b111U, 0b111000000U, kRotaryWords}) {
    if ((changed & group) == 0) continue;
    double squared = 0;
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if (((changed & group) >> k & 1) == 0) continue;
      const std::int64_t from = (is_said_ >> k & 1) != 0 ? said_[k] : rounded_units(word_units(k, stands_[k]));
      const double way = static_cast<double>(words[k] - from) / scale_[k];
      squared += way * way;
    }
    return std::sqrt(squared) / (group != kRotaryWords && frame_.inches ? kInch : 1);
  }
  return 0;
}

char* NcWriter::write_modes(const ProgramMove& move, FeedMode mode, char* at) {
  if (!units_said_) at = write_text(frame_.inches ? "G20 " : "G21 ", at);
  if (!absolute_said_) at = write_text("G90 ", at);
  units_said_ = absolute_said_ = true;
  // G33 and G33.1 have their pitch in any mode.
  const bool has_feed =
      move.kind != MoveKind::rapid && move.spindle != SpindleMove::thread && move.spindle != SpindleMove::rigid_tapping;
  if (has_feed && (!mode_said_ || mode_ != mode)) {
    at = write_text(mode_word(mode), at);
    mode_ = mode;
    mode_said_ = true;
    feed_ = -1;
  }
  return at;
}

char* NcWriter::write_pitch(const ProgramMove& move, double pitch, char* at) const {
  if (!(pitch > 0) || !(pitch < 1e6)) fail(move, "the corrected pitch is not a positive number");
  at = write_text(" K", at);
  return write_scaled(std::max<std::int64_t>(std::llround(pitch * 1e9), 1), 9, true, at);
}

char* NcWriter::write_feed(const ProgramMove& move, FeedMode mode, double feed, char* at) {
  if (!(feed > 0) || !(feed < 1e9)) fail(move, "the corrected feed is not above zero and below 1e9");
  // The same number said in the other unit is another feed to lengths.
  if (feed == feed_ && feed_in_inches_ == frame_.inches && mode != FeedMode::inverse_time) return at;
  const int digits = feed < 1 ? 9 : 6;
  const auto number = static_cast<std::int64_t>(std::llround(feed * (feed < 1 ? 1e9 : 1e6)));
  at = write_text(" F", at);
  at = write_scaled(std::max<std::int64_t>(number, 1), digits, true, at);
  feed_ = feed;
  feed_in_inches_ = frame_.inches;
  return at;
}
}  // namespace abbe
