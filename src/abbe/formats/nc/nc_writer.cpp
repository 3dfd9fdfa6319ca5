#include "abbe/formats/nc/nc_writer.h"

#include <fmt/format.h>

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

constexpr std::array<char, kAxisWords> kLetters = {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'};
constexpr std::size_t kChunk = std::size_t{1} << 18;
/// Longest line of words that are written here: nine axes, a feed and modes.
constexpr std::size_t kLongestLine = 512;
/// LinuxCNC refuses lines of 256 characters and more.
constexpr std::size_t kLongestBlock = 250;
constexpr std::size_t kPiecesTogether = 500'000;
constexpr std::size_t kFirstBatch = 256;  // moves, of which is not known yet how many pieces they become

}  // namespace

NcWriter::NcWriter(const std::string& file, const NcProgramOptions& options, MoveCorrector& corrector,
                   const std::function<void(std::string_view)>& write)
    : file_(file),
      options_(options),
      corrector_(corrector),
      write_(write),
      frames_(1),
      paths_{"G64"},
      batch_(std::clamp<std::size_t>(options.batch, 1, kFirstBatch)) {
  out_.resize(kChunk + kLongestLine);
  at_ = out_.data();
  frames_[0].inches = options.inches;
  moves_.reserve(options.batch);
  items_.reserve(options.batch);
  frame_ = frames_[0];
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    decimals_[k] = decimals(k);
    scale_[k] = program_scale(k);
  }
}

void refuse_spent_budget(const NcProgramOptions& options, std::size_t pieces) {
  if (options.budget == nullptr) return;
  const ProgramBudget::Spent spent = options.budget->spent(pieces);
  if (spent != ProgramBudget::Spent::nothing) throw NcGivenUp{spent};
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
  if (moves_.size() >= batch_ || texts_.size() > kChunk) flush();
}

void NcWriter::flush() {
  std::size_t i = 0, pieces = 0;
  refuse_spent_budget(options_);
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
    refuse_spent_budget(options_, corrected_.pieces.size());
    pieces += corrected_.pieces.size();
    for (std::size_t k = i; k < end; ++k) {
      const std::size_t first = corrected_.first[k - i];
      write_item(k, corrected_.pieces.data() + first, corrected_.first[k - i + 1] - first);
    }
    i = end;
  }
  // Of moves that become many pieces few go together: the pieces are in memory.
  batch_ = std::clamp<std::size_t>(kPiecesTogether * moves_.size() / std::max<std::size_t>(pieces, 1), 1,
                                   std::max<std::size_t>(options_.batch, 1));
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

}  // namespace abbe
