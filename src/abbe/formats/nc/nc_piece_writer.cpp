#include "abbe/formats/nc/nc_piece_writer.h"

#include <algorithm>
#include <cmath>

#include "abbe/formats/nc/nc_number.h"
#include "abbe/formats/nc/nc_units.h"
#include "abbe/formats/nc/nc_word_units.h"
#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 18;
/// Longest line of words that are written here: nine axes, a feed and modes.
constexpr std::size_t kLongestLine = 512;

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

NcPieceWriter::NcPieceWriter(const std::string& file, const NcProgramOptions& options,
                             const std::function<void(std::string_view)>& write)
    : file_(file), options_(options), write_(write) {
  out_.resize(kBuffer + kLongestLine);
  at_ = out_.data();
  frame_.inches = options.inches;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    decimals_[k] = decimals(k);
    scale_[k] = program_scale(k);
  }
}

int NcPieceWriter::decimals(std::size_t axis) const {
  if (is_rotary_word(axis)) return std::clamp(options_.decimals_deg, 0, 9);
  return std::clamp(options_.decimals_mm, 0, 9) + (frame_.inches ? 1 : 0);
}

double NcPieceWriter::program_scale(std::size_t axis) const {
  const double power = kExactPowersOfTen[static_cast<std::size_t>(decimals(axis))];
  return frame_.inches && !is_rotary_word(axis) ? power / kInch : power;
}

void NcPieceWriter::fail(const ProgramMove& move, const std::string& problem) const {
  throw InputError({.file = file_, .line = move.line}, problem);
}

void NcPieceWriter::flush() {
  write_({out_.data(), static_cast<std::size_t>(at_ - out_.data())});
  at_ = out_.data();
}

void NcPieceWriter::reserve(std::size_t bytes) {
  if (static_cast<std::size_t>(at_ - out_.data()) + bytes <= out_.size()) return;
  flush();
  if (bytes > out_.size()) out_.resize(bytes);
  at_ = out_.data();
}

void NcPieceWriter::text(std::string_view lines) {
  if (lines.empty()) return;
  reserve(lines.size());
  at_ = write_text(lines, at_);
}

void NcPieceWriter::apply(const NcControlEvents& events) {
  if (events.forget_feed) feed_ = -1;
  if (events.said_units) units_said_ = true;
  if (events.said_absolute) absolute_said_ = true;
  if (events.forget_linear) is_said_ &= ~std::uint32_t{7};
  if (events.sets_mode) {
    // LinuxCNC forgets its feed with these words even if they change nothing.
    feed_ = -1;
    mode_ = events.mode;
    mode_said_ = true;
  }
}

bool NcPieceWriter::position(std::size_t axis, double& value) const {
  value = static_cast<double>(said_[axis]) / scale_[axis] + frame_.offset[axis];
  return (is_said_ >> axis & 1) != 0;
}

void NcPieceWriter::use_frame(const NcProgramFrame& frame) {
  if (frame.inches == frame_.inches && frame.offset == frame_.offset) return;
  std::array<double, kAxisWords> stands{};
  for (std::size_t k = 0; k < kAxisWords; ++k) position(k, stands[k]);
  frame_ = frame;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    decimals_[k] = decimals(k);
    scale_[k] = program_scale(k);
    const double units = (stands[k] - frame_.offset[k]) * scale_[k];
    said_[k] = std::abs(units) < kLargestUnits ? std::llround(units) : 0;
    if (!(std::abs(units) < kLargestUnits)) is_said_ &= ~(std::uint32_t{1} << k);
  }
}

void NcPieceWriter::move(const ProgramMove& move, const NcMoveText& with, std::span<const CorrectedPiece> pieces) {
  if ((with.axes & ~is_said_) != 0) {
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((is_said_ >> k & 1) == 0) stands_[k] = move.start[k];
    }
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (move.spindle == SpindleMove::rigid_tapping) {
      // The control goes back to where it stood.
      const std::array<std::int64_t, kAxisWords> said = said_;
      write_piece(move, with, pieces[k], k == 0);
      said_ = said;
      continue;
    }
    write_piece(move, with, pieces[k], k == 0);
    stands_ = pieces[k].end;
  }
  write_path(with.path, false);
  piece_count_ += pieces.size();
}

void NcPieceWriter::write_path(std::string_view path, bool exact) {
  if (path.empty() || exact == exact_) return;
  text(exact ? "G61" : path);
  text("\n");
  exact_ = exact;
}

void NcPieceWriter::write_piece(const ProgramMove& move, const NcMoveText& with, const CorrectedPiece& piece,
                                bool first) {
  std::array<std::int64_t, kAxisWords> words;  // NOLINT(cppcoreguidelines-pro-type-member-init): as far as `axes` says
  std::uint32_t changed = 0, moved = 0;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((with.axes >> k & 1) == 0) continue;
    const double units = word_units(k, piece.end[k]);
    if (!(std::abs(units) < kLargestUnits)) fail(move, "the corrected position is not a number that can be written");
    words[k] = rounded_units(units);
    const std::uint32_t bit = std::uint32_t{1} << k;
    if ((is_said_ & bit) == 0) {
      changed |= bit;
      if (words[k] != rounded_units(word_units(k, stands_[k]))) moved |= bit;
    } else if (words[k] != said_[k] && !is_no_motion(k, words[k])) {
      changed |= bit;
      moved |= bit;
    }
  }
  const std::size_t text_size = first ? with.number.size() + with.words.size() + with.comments.size() : 0;
  if (changed == 0 && text_size == 0) return;
  write_path(with.path, piece.exact);
  reserve(kLongestLine + text_size);
  char* at = at_;
  if (first) {
    for (const std::string_view part : {with.number, with.words}) {
      if (part.empty()) continue;
      at = write_text(part, at);
      *at++ = ' ';
    }
  }
  if (changed != 0) {
    const bool rapid = move.kind == MoveKind::rapid;
    FeedMode mode = piece.feed_mode;
    double feed = feed_word(move, piece, moved, mode);
    if (mode == FeedMode::inverse_time) {
      mode = slow_feed(move, words, changed, feed);
    } else if (mode == FeedMode::per_revolution && moves_only_rotary_axes(move)) {
      feed = feed_of_angle(words, changed, feed);
    }
    at = write_modes(move, mode, at);
    const bool has_pitch = move.spindle == SpindleMove::thread || move.spindle == SpindleMove::rigid_tapping;
    if (has_pitch && ((changed & ~std::uint32_t{7}) != 0 || (is_said_ & changed) != changed)) {
      fail(move, "a thread whose correction moves other axes than X, Y, Z, or from an unknown place");
    }
    at = write_text(rapid                                        ? "G0"
                    : move.spindle == SpindleMove::thread        ? "G33"
                    : move.spindle == SpindleMove::rigid_tapping ? "G33.1"
                                                                 : "G1",
                    at);
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((changed >> k & 1) == 0) continue;
      *at++ = ' ';
      *at++ = kWrittenAxisLetters[k];
      at = write_scaled(words[k], decimals_[k], false, at);
      said_[k] = words[k];
    }
    is_said_ |= changed;
    if (has_pitch) {
      at = write_pitch(move, feed, at);
    } else if (!rapid) {
      at = write_feed(move, mode, feed, at);
    }
    *at++ = ' ';
  }
  if (first && !with.comments.empty()) {
    at = write_text(with.comments, at);
    *at++ = ' ';
  }
  at[-1] = '\n';
  at_ = at;
  if (static_cast<std::size_t>(at_ - out_.data()) >= kBuffer) reserve(out_.size());
}

bool NcPieceWriter::is_no_motion(std::size_t axis, std::int64_t word) const {
  // Only with more decimals than six can a word change by so little.
  return decimals_[axis] > 6 && std::abs(static_cast<double>(word - said_[axis])) <= kNoMotion_mm * scale_[axis];
}

double NcPieceWriter::word_units(std::size_t axis, double value) const {
  return ((is_rotary_word(axis) ? value / kDegree : value) - frame_.offset[axis]) * scale_[axis];
}

double NcPieceWriter::feed_word(const ProgramMove& move, const CorrectedPiece& piece, std::uint32_t moved,
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

FeedMode NcPieceWriter::slow_feed(const ProgramMove& move, const std::array<std::int64_t, kAxisWords>& words,
                                  std::uint32_t changed, double& feed) const {
  // In inverse time LinuxCNC 2.9 makes of F a feed per minute, and of one below this value this value.
  constexpr double kSlowestOfInverseTime = 0.1;
  if (move.feed_mode == FeedMode::inverse_time && !moves_only_rotary_axes(move)) return FeedMode::inverse_time;
  const double per_minute = feed_length(words, changed) * feed;
  if (!(per_minute > 0 && per_minute < kSlowestOfInverseTime)) return FeedMode::inverse_time;
  feed = per_minute;
  return FeedMode::per_minute;
}

double NcPieceWriter::feed_of_angle(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed,
                                    double feed) const {
  const double angle = feed_length(words, changed & kRotaryWords);
  const double length = feed_length(words, changed);
  return angle > 0 && length > 0 ? feed * length / angle : feed;
}

double NcPieceWriter::feed_length(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed) const {
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

char* NcPieceWriter::write_modes(const ProgramMove& move, FeedMode mode, char* at) {
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

char* NcPieceWriter::write_pitch(const ProgramMove& move, double pitch, char* at) const {
  if (!(pitch > 0) || !(pitch < 1e6)) fail(move, "the corrected pitch is not a positive number");
  at = write_text(" K", at);
  return write_scaled(std::max<std::int64_t>(std::llround(pitch * 1e9), 1), 9, true, at);
}

char* NcPieceWriter::write_feed(const ProgramMove& move, FeedMode mode, double feed, char* at) {
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
