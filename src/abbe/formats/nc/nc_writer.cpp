#include "abbe/formats/nc/nc_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kMostText = std::size_t{1} << 18;
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
      out_(file, options, write),
      frames_(1),
      paths_{"G64"},
      batch_(std::clamp<std::size_t>(options.batch, 1, kFirstBatch)) {
  frames_[0].inches = options.inches;
  moves_.reserve(options.batch);
  items_.reserve(options.batch);
}

void refuse_spent_budget(const NcProgramOptions& options, std::size_t pieces) {
  if (options.budget == nullptr) return;
  const ProgramBudget::Spent spent = options.budget->spent(pieces);
  if (spent != ProgramBudget::Spent::nothing) throw NcGivenUp{spent};
}

void NcWriter::line(std::string_view text) {
  texts_ += text;
  texts_ += '\n';
  if (texts_.size() > kMostText) flush();
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
    throw InputError({.file = file_, .line = move.line},
                     fmt::format("more than {} moves: a loop that does not end?", options_.most_moves));
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
  if (moves_.size() >= batch_ || texts_.size() > kMostText) flush();
}

void NcWriter::flush() {
  std::size_t i = 0, pieces = 0;
  refuse_spent_budget(options_);
  while (i < moves_.size()) {
    if (!items_[i].is_corrected) {
      CorrectedPiece piece;
      piece.end = moves_[i].end;
      write_item(i++, {&piece, 1});
      continue;
    }
    std::size_t end = i;
    while (end < moves_.size() && items_[end].is_corrected) ++end;
    corrector_.correct(std::span<const ProgramMove>(moves_).subspan(i, end - i), corrected_);
    refuse_spent_budget(options_, corrected_.pieces.size());
    pieces += corrected_.pieces.size();
    for (std::size_t k = i; k < end; ++k) {
      const std::size_t first = corrected_.first[k - i];
      write_item(k, std::span(corrected_.pieces).subspan(first, corrected_.first[k - i + 1] - first));
    }
    i = end;
  }
  // Of moves that become many pieces few go together: the pieces are in memory.
  batch_ = std::clamp<std::size_t>(kPiecesTogether * moves_.size() / std::max<std::size_t>(pieces, 1), 1,
                                   std::max<std::size_t>(options_.batch, 1));
  const std::size_t behind = items_.empty() ? 0 : items_.back().comments;
  out_.text(std::string_view(texts_).substr(behind));
  out_.apply(events_);
  events_ = {};
  texts_.clear();
  moves_.clear();
  items_.clear();
  out_.use_frame(frames_.back());
  frames_.erase(frames_.begin(), frames_.end() - 1);
  paths_.erase(paths_.begin(), paths_.end() - 1);
}

void NcWriter::finish() {
  words_as_line();
  flush();
  out_.flush();
}

void NcWriter::write_item(std::size_t i, std::span<const CorrectedPiece> pieces) {
  const Item& item = items_[i];
  const std::size_t begin = i == 0 ? 0 : items_[i - 1].comments;
  const std::string_view texts = texts_;
  out_.text(texts.substr(begin, item.lines - begin));
  out_.apply(item.events);
  out_.use_frame(frames_[item.frame]);
  NcMoveText with;
  with.number = texts.substr(item.lines, item.number - item.lines);
  with.words = texts.substr(item.number, item.words - item.number);
  with.comments = texts.substr(item.words, item.comments - item.words);
  with.axes = item.axes;
  with.path = paths_[item.path];
  out_.move(moves_[i], with, pieces);
}

}  // namespace abbe
