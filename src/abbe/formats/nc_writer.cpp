#include "abbe/formats/nc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "abbe/formats/decimal_text.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/nc_number.h"
#include "abbe/formats/nc_units.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::array<char, kAxisWords> kLetters = {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'};
constexpr std::size_t kChunk = std::size_t{1} << 18;
/// Longest line of words that are written here: nine axes, a feed and modes.
constexpr std::size_t kLongestLine = 512;
/// LinuxCNC refuses lines of 256 characters and more.
constexpr std::size_t kLongestBlock = 250;
constexpr double kLargestUnits = 9e15;

char* write_text(std::string_view text, char* at) {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

constexpr std::uint32_t kRotaryWords = 0b111000;

/// Half away from zero; a number that no word has if it is too large.
std::int64_t rounded(double units) {
  if (!(std::abs(units) < kLargestUnits)) return std::numeric_limits<std::int64_t>::min();
  return static_cast<std::int64_t>(units + (units < 0 ? -0.5 : 0.5));
}

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

NcWriter::NcWriter(const std::string& file, const NcProgramOptions& options, MoveCorrector& corrector,
                   const std::function<void(std::string_view)>& write)
    : file_(file), options_(options), corrector_(corrector), write_(write), frames_(1), paths_{"G64"} {
  out_.resize(kChunk + kLongestLine);
  at_ = out_.data();
  frames_[0].inches = options.inches;
  const std::size_t batch = std::max<std::size_t>(options.batch, 1);
  moves_.reserve(batch);
  items_.reserve(batch);
  frame_ = frames_[0];
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    decimals_[k] = decimals(k);
    scale_[k] = program_scale(k);
  }
}

int NcWriter::decimals(std::size_t axis) const {
  if (is_rotary_word(axis)) return std::clamp(options_.decimals_deg, 0, 9);
  return std::clamp(options_.decimals_mm, 0, 9) + (frame_.inches ? 1 : 0);
}

double NcWriter::program_scale(std::size_t axis) const {
  const double power = kExactPowersOfTen[static_cast<std::size_t>(decimals(axis))];
  return frame_.inches && !is_rotary_word(axis) ? power / kInch : power;
}

void NcWriter::fail(const ProgramMove& move, const std::string& problem) const {
  throw InputError({.file = file_, .line = move.line}, problem);
}

void NcWriter::line(std::string_view text) {
  texts_ += text;
  texts_ += '\n';
  if (texts_.size() > kChunk) flush();
}

void NcWriter::words_as_line() {
  if (!has_words()) return;
  const std::size_t begin = texts_.size();
  for (const std::string* part : {&number_, &words_, &comments_}) {
    if (part->empty()) continue;
    if (texts_.size() > begin) texts_ += ' ';
    texts_ += *part;
  }
  texts_ += '\n';
  number_.clear();
  words_.clear();
  comments_.clear();
}

void NcWriter::said_feed_mode(FeedMode mode) {
  events_.sets_mode = true;
  events_.mode = mode;
}

void NcWriter::set_path(std::string_view block) { paths_.emplace_back(block); }

void NcWriter::set_frame(const NcProgramFrame& frame) { frames_.push_back(frame); }

void NcWriter::forget_linear_axes() { events_.forget_linear = true; }

void NcWriter::move(const ProgramMove& move, std::uint32_t words, bool is_corrected) {
  if (move_count_ >= options_.most_moves) {
    fail(move, fmt::format("more than {} moves: a loop that does not end?", options_.most_moves));
  }
  ++move_count_;
  if (!is_corrected) {
    if (uncorrected_++ == 0) first_uncorrected_line_ = move.line;
  }
  // A long comment gets a line of its own.
  if (words_.size() + comments_.size() + 20 * kAxisWords > kLongestBlock && !comments_.empty()) {
    texts_ += comments_;
    texts_ += '\n';
    comments_.clear();
  }
  if (words_.size() + 20 * kAxisWords > kLongestBlock) words_as_line();
  Item& item = items_.emplace_back();
  item.lines = static_cast<std::uint32_t>(texts_.size());
  item.number = item.words = item.comments = item.lines;
  if (has_words()) {
    texts_ += number_;
    item.number = static_cast<std::uint32_t>(texts_.size());
    texts_ += words_;
    item.words = static_cast<std::uint32_t>(texts_.size());
    texts_ += comments_;
    item.comments = static_cast<std::uint32_t>(texts_.size());
    number_.clear();
    words_.clear();
    comments_.clear();
  }
  item.axes = words;
  item.frame = static_cast<std::uint32_t>(frames_.size() - 1);
  item.events = events_;
  item.path = static_cast<std::uint32_t>(paths_.size() - 1);
  item.is_corrected = is_corrected;
  events_ = {};
  moves_.push_back(move);
  if (moves_.size() >= options_.batch || texts_.size() > kChunk) flush();
}

void NcWriter::flush() {
  std::size_t i = 0;
  while (i < moves_.size()) {
    if (!items_[i].is_corrected) {
      CorrectedPiece piece;
      piece.end = moves_[i].end;
      write_item(i++, &piece, 1);
      continue;
    }
    std::size_t end = i;
    while (end < moves_.size() && items_[end].is_corrected) ++end;
    corrector_.correct(std::span<const ProgramMove>(moves_).subspan(i, end - i), corrected_);
    for (std::size_t k = i; k < end; ++k) {
      const std::size_t first = corrected_.first[k - i];
      write_item(k, corrected_.pieces.data() + first, corrected_.first[k - i + 1] - first);
    }
    i = end;
  }
  const std::size_t behind = items_.empty() ? 0 : items_.back().comments;
  append(std::string_view(texts_).substr(behind));
  apply(events_);
  events_ = {};
  texts_.clear();
  moves_.clear();
  items_.clear();
  use_frame(frames_.size() - 1);
  frames_.erase(frames_.begin(), frames_.end() - 1);
  paths_.erase(paths_.begin(), paths_.end() - 1);
}

void NcWriter::finish() {
  words_as_line();
  flush();
  write_({out_.data(), static_cast<std::size_t>(at_ - out_.data())});
  at_ = out_.data();
}

void NcWriter::reserve(std::size_t bytes) {
  if (static_cast<std::size_t>(at_ - out_.data()) + bytes <= out_.size()) return;
  write_({out_.data(), static_cast<std::size_t>(at_ - out_.data())});
  if (bytes > out_.size()) out_.resize(bytes);
  at_ = out_.data();
}

void NcWriter::append(std::string_view text) {
  if (text.empty()) return;
  reserve(text.size());
  at_ = write_text(text, at_);
}

void NcWriter::apply(const Events& events) {
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

bool NcWriter::position(std::size_t axis, double& value) const {
  value = static_cast<double>(said_[axis]) / scale_[axis] + frame_.offset[axis];
  return (is_said_ >> axis & 1) != 0;
}

void NcWriter::use_frame(std::size_t index) {
  const NcProgramFrame& frame = frames_[index];
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

void NcWriter::write_item(std::size_t i, const CorrectedPiece* pieces, std::size_t count) {
  const Item& item = items_[i];
  const std::size_t begin = i == 0 ? 0 : items_[i - 1].comments;
  append(std::string_view(texts_).substr(begin, item.lines - begin));
  apply(item.events);
  use_frame(item.frame);
  if ((item.axes & ~is_said_) != 0) {
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((is_said_ >> k & 1) == 0) stands_[k] = moves_[i].start[k];
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (moves_[i].spindle == SpindleMove::rigid_tapping) {
      // The control goes back to where it stood.
      const std::array<std::int64_t, kAxisWords> said = said_;
      write_piece(moves_[i], item, pieces[k], k == 0);
      said_ = said;
      continue;
    }
    write_piece(moves_[i], item, pieces[k], k == 0);
    stands_ = pieces[k].end;
  }
  write_path(item, false);
  piece_count_ += count;
}

void NcWriter::write_path(const Item& item, bool exact) {
  const std::string& path = paths_[item.path];
  if (path.empty() || exact == exact_) return;
  append(exact ? "G61" : path);
  append("\n");
  exact_ = exact;
}

void NcWriter::write_piece(const ProgramMove& move, const Item& item, const CorrectedPiece& piece, bool first) {
  std::array<std::int64_t, kAxisWords> words;  // NOLINT(cppcoreguidelines-pro-type-member-init): as far as `axes` says
  std::uint32_t changed = 0, moved = 0;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((item.axes >> k & 1) == 0) continue;
    const double units = word_units(k, piece.end[k]);
    if (!(std::abs(units) < kLargestUnits)) fail(move, "the corrected position is not a number that can be written");
    words[k] = rounded(units);
    const std::uint32_t bit = std::uint32_t{1} << k;
    if ((is_said_ & bit) == 0) {
      changed |= bit;
      if (words[k] != rounded(word_units(k, stands_[k]))) moved |= bit;
    } else if (words[k] != said_[k] && !is_no_motion(k, words[k])) {
      changed |= bit;
      moved |= bit;
    }
  }
  const std::string_view texts = texts_;
  const bool has_text = first && item.comments > item.lines;
  if (changed == 0 && !has_text) return;
  write_path(item, piece.exact);
  reserve(kLongestLine + (first ? item.comments - item.lines : 0));
  char* at = at_;
  if (first && item.words > item.lines) {
    if (item.number > item.lines) {
      at = write_text(texts.substr(item.lines, item.number - item.lines), at);
      *at++ = ' ';
    }
    if (item.words > item.number) {
      at = write_text(texts.substr(item.number, item.words - item.number), at);
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
      *at++ = kLetters[k];
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
  if (first && item.comments > item.words) {
    at = write_text(texts.substr(item.words, item.comments - item.words), at);
    *at++ = ' ';
  }
  at[-1] = '\n';
  at_ = at;
  if (static_cast<std::size_t>(at_ - out_.data()) >= kChunk) reserve(out_.size());
}

bool NcWriter::is_no_motion(std::size_t axis, std::int64_t word) const {
  // Only with more decimals than six can a word change by so little.
  return decimals_[axis] > 6 && std::abs(static_cast<double>(word - said_[axis])) <= kNoMotion_mm * scale_[axis];
}

double NcWriter::word_units(std::size_t axis, double value) const {
  return ((is_rotary_word(axis) ? value / kDegree : value) - frame_.offset[axis]) * scale_[axis];
}

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
      const std::int64_t from = (is_said_ >> k & 1) != 0 ? said_[k] : rounded(word_units(k, stands_[k]));
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
