#include "abbe/formats/nc/nc_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace abbe {
namespace {

/// The word in a block that says where it goes.
[[noreturn]] void fail_o(const NcBlock& block, const std::string& problem, const std::string& expected = "") {
  block.cursor.fail(block.o_word, problem, expected);
}

}  // namespace

NcFlow::NcFlow(std::string_view text, const std::string& file, NcParameters& parameters, NcExpression& expression,
               const Limits& limits)
    : text_(text),
      file_(file),
      parameters_(parameters),
      expression_(expression),
      limits_(limits),
      furthest_(limits.depth + 1) {}

bool NcFlow::next_line(std::string_view& line, std::size_t& number) {
  if (place_.offset >= text_.size()) return false;
  last_ = place_;
  const char* const begin = text_.data() + place_.offset;
  const std::size_t left = text_.size() - place_.offset;
  const auto* const end = static_cast<const char*>(std::memchr(begin, '\n', left));
  const std::size_t length = end == nullptr ? left : static_cast<std::size_t>(end - begin);
  line = {begin, length};
  place_.offset += length + (end == nullptr ? 0 : 1);
  number = ++place_.line;
  std::size_t& furthest = furthest_[calls_.size()];
  if (place_.offset > furthest) {
    furthest = place_.offset;
    repeated_moves_ = 0;
  }
  return true;
}

void NcFlow::find_o_words() {
  if (found_) return;
  found_ = true;
  NcBlock block;
  const NcBlockReader reader(file_, expression_);
  std::map<std::string, std::vector<std::size_t>> open;  // loops and branches by their names
  std::map<std::string, std::size_t> latest;
  Place place;
  while (place.offset < text_.size()) {
    const Place here = place;
    const std::size_t end = std::min(text_.find('\n', place.offset), text_.size());
    const std::string_view line = text_.substr(place.offset, end - place.offset);
    place.offset = std::min(end + 1, text_.size());
    ++place.line;
    if (!reader.read_flow(line, place.line, block)) continue;
    const std::size_t i = entries_.size();
    Entry entry{here, place, block.flow};
    const auto before = latest.find(block.label);
    if (before != latest.end()) entries_[before->second].next = i;
    latest[block.label] = i;
    std::vector<std::size_t>& opened = open[block.label];
    const auto close = [&](NcFlowWord one, NcFlowWord other) {
      if (opened.empty() || (entries_[opened.back()].word != one && entries_[opened.back()].word != other)) {
        fail_o(block, "nothing that begins this stands before it", "the beginning with the same name");
      }
      entry.start = opened.back();
    };
    switch (block.flow) {
      case NcFlowWord::label:
      case NcFlowWord::sub:
        if (!subs_.emplace(block.label, i).second) fail_o(block, "a subroutine of this name exists already");
        if (block.flow == NcFlowWord::sub) opened.push_back(i);
        break;
      case NcFlowWord::endsub:
        close(NcFlowWord::sub, NcFlowWord::sub);
        opened.pop_back();
        break;
      case NcFlowWord::while_loop:
        if (!opened.empty() && entries_[opened.back()].word == NcFlowWord::do_loop) {
          entry.start = opened.back();
          entry.taken = true;
          opened.pop_back();
        } else {
          opened.push_back(i);
        }
        break;
      case NcFlowWord::do_loop:
      case NcFlowWord::if_block:
      case NcFlowWord::repeat:
        opened.push_back(i);
        break;
      case NcFlowWord::endwhile:
        close(NcFlowWord::while_loop, NcFlowWord::while_loop);
        opened.pop_back();
        break;
      case NcFlowWord::endrepeat:
        close(NcFlowWord::repeat, NcFlowWord::repeat);
        opened.pop_back();
        break;
      case NcFlowWord::elseif:
      case NcFlowWord::else_block:
        close(NcFlowWord::if_block, NcFlowWord::if_block);
        break;
      case NcFlowWord::endif:
        close(NcFlowWord::if_block, NcFlowWord::if_block);
        opened.pop_back();
        break;
      case NcFlowWord::break_loop:
      case NcFlowWord::continue_loop:
        if (opened.empty()) fail_o(block, "no loop of this name stands around it");
        entry.start = opened.back();
        break;
      default:
        break;
    }
    entries_.push_back(entry);
  }
}

std::size_t NcFlow::entry_of(const NcBlock& block) {
  find_o_words();
  const auto found = std::lower_bound(entries_.begin(), entries_.end(), last_.offset,
                                      [](const Entry& e, std::size_t offset) { return e.here.offset < offset; });
  if (found == entries_.end() || found->here.offset != last_.offset) fail_o(block, "is not expected here");
  return static_cast<std::size_t>(found - entries_.begin());
}

std::size_t NcFlow::find(const NcBlock& block, std::size_t entry, NcFlowWord one, NcFlowWord other) {
  const std::size_t start = entries_[entry].start == kNone ? entry : entries_[entry].start;
  for (std::size_t i = entries_[entry].next; i != kNone; i = entries_[i].next) {
    if ((entries_[i].word == one || entries_[i].word == other) && entries_[i].start == start) return i;
  }
  fail_o(block, "what ends it is missing", "its end with the same name");
}

void NcFlow::jump(const NcBlock& block, const Place& place) {
  if (place.offset <= last_.offset && ++idle_jumps_ > limits_.idle_jumps) {
    block.cursor.fail(block.cursor.begin, fmt::format("{} rounds of loops or calls without a move", limits_.idle_jumps),
                      "a loop that moves or ends");
  }
  place_ = place;
}

double NcFlow::argument(NcBlock& block) {
  if (block.cursor.peek() != '[') block.cursor.fail(block.cursor.at, "a value is missing", "a value in [ ]");
  return expression_.read_value(block.cursor);
}

void NcFlow::expect_end(NcBlock& block) {
  const char c = block.cursor.peek();
  if (c != 0 && c != '(' && c != ';') {
    block.cursor.fail(block.cursor.at, "is not expected behind an O word", "a comment or the end of the line");
  }
}

void NcFlow::run(NcBlock& block) {
  const std::size_t i = entry_of(block);
  switch (block.flow) {
    case NcFlowWord::label:
      break;
    case NcFlowWord::sub:
      jump(block, entries_[find(block, i, NcFlowWord::endsub, NcFlowWord::endsub)].behind);
      break;
    case NcFlowWord::endsub:
    case NcFlowWord::return_to_caller:
      return_value(block);
      break;
    case NcFlowWord::call:
      call(block);
      break;
    case NcFlowWord::if_block:
    case NcFlowWord::elseif:
    case NcFlowWord::else_block:
    case NcFlowWord::endif:
      branch(block, i);
      break;
    default:
      loop(block, i);
  }
}

void NcFlow::call(NcBlock& block) {
  const auto sub = subs_.find(block.label);
  if (sub == subs_.end()) {
    fail_o(block, "there is no subroutine of this name in the file",
           "a subroutine in the same file: those of other files are not read");
  }
  std::vector<double> arguments;
  while (block.cursor.peek() == '[') {
    if (arguments.size() == kNcLocalParameters) block.cursor.fail(block.cursor.at, "more than 30 arguments");
    arguments.push_back(argument(block));
  }
  expect_end(block);
  enter(block, sub->second, false, 1);
  parameters_.enter(arguments);
}

void NcFlow::enter(const NcBlock& block, std::size_t sub, bool is_subprogram, long long times) {
  if (calls_.size() >= limits_.depth) {
    block.cursor.fail(block.cursor.begin, fmt::format("more than {} calls within calls", limits_.depth));
  }
  Call& call = calls_.emplace_back();
  call.back = place_;
  call.sub = sub;
  call.is_subprogram = is_subprogram;
  call.left = times - 1;
  // Also forwards: a subroutine behind its call may call on for ever.
  if (++idle_jumps_ > limits_.idle_jumps) jump(block, {});
  place_ = entries_[sub].behind;
}

void NcFlow::call_subprogram(const NcBlock& block, const NcWord& word, double label, double repeats) {
  find_o_words();
  const auto sub = subs_.find(fmt::format("{}", std::llround(label)));
  if (sub == subs_.end()) {
    block.fail(word, fmt::format("there is no subprogram O{} in the file", std::llround(label)),
               "a subprogram in the same file: those of other files are not read");
  }
  if (std::llround(repeats) < 1) return;
  enter(block, sub->second, true, std::llround(repeats));
  parameters_.enter_subprogram();
}

void NcFlow::end_subprogram(const NcBlock& block, const NcWord& word) {
  if (calls_.empty()) {
    block.fail(word, "M99 outside a subprogram restarts the program endlessly", "M2 or M30 at the end");
  }
  leave(block);
}

void NcFlow::leave(const NcBlock& block) {
  Call& call = calls_.back();
  if (call.left > 0) {
    --call.left;
    call.loops.clear();
    parameters_.leave_subprogram();
    parameters_.enter_subprogram();
    jump(block, entries_[call.sub].behind);
    return;
  }
  if (call.is_subprogram) {
    parameters_.leave_subprogram();
  } else {
    parameters_.leave();
  }
  const Place back = call.back;
  calls_.pop_back();
  jump(block, back);
}

void NcFlow::return_value(NcBlock& block) {
  if (calls_.empty()) fail_o(block, "ends a subroutine that was not called");
  const bool returns = block.cursor.peek() == '[';
  const double value = returns ? argument(block) : 0;
  expect_end(block);
  leave(block);
  parameters_.set("_value", value);
  parameters_.set("_value_returned", returns ? 1 : 0);
}

void NcFlow::branch(NcBlock& block, std::size_t entry) {
  if (block.flow == NcFlowWord::endif) {
    expect_end(block);
    return;
  }
  if (block.flow != NcFlowWord::if_block) {
    // Reached from above: the branch before it was taken.
    jump(block, entries_[find(block, entry, NcFlowWord::endif, NcFlowWord::endif)].behind);
    return;
  }
  double condition = argument(block);
  expect_end(block);
  std::size_t at = entry;
  while (condition == 0) {
    const std::size_t start = entries_[at].start == kNone ? at : entries_[at].start;
    std::size_t next = entries_[at].next;
    while (next != kNone && entries_[next].start != start) next = entries_[next].next;
    if (next == kNone) fail_o(block, "what ends it is missing", "endif with the same name");
    at = next;
    if (entries_[at].word != NcFlowWord::elseif) break;
    const std::size_t end = std::min(text_.find('\n', entries_[at].here.offset), text_.size());
    NcBlock other;
    NcBlockReader(file_, expression_)
        .read(text_.substr(entries_[at].here.offset, end - entries_[at].here.offset), entries_[at].behind.line, other);
    condition = argument(other);
    expect_end(other);
  }
  if (at != entry) jump(block, entries_[at].behind);
}

void NcFlow::loop(NcBlock& block, std::size_t entry) {
  const Entry& here = entries_[entry];
  switch (block.flow) {
    case NcFlowWord::while_loop: {
      const bool goes_on = argument(block) != 0;
      expect_end(block);
      if (here.taken) {
        if (goes_on) jump(block, entries_[here.start].behind);
      } else if (!goes_on) {
        jump(block, entries_[find(block, entry, NcFlowWord::endwhile, NcFlowWord::endwhile)].behind);
      }
      break;
    }
    case NcFlowWord::endwhile:
      jump(block, entries_[here.start].here);
      break;
    case NcFlowWord::repeat: {
      const long long times = std::llround(argument(block));
      expect_end(block);
      const std::size_t end = find(block, entry, NcFlowWord::endrepeat, NcFlowWord::endrepeat);
      if (times < 1) {
        jump(block, entries_[end].behind);
        break;
      }
      if (loops().size() > 1000) fail_o(block, "more than 1000 loops within loops");
      loops().push_back({entry, times - 1});
      break;
    }
    case NcFlowWord::endrepeat: {
      std::vector<Loop>& open = loops();
      if (open.empty() || open.back().entry != here.start) fail_o(block, "ends a loop that was not begun");
      if (open.back().left-- > 0) {
        jump(block, entries_[here.start].behind);
      } else {
        open.pop_back();
      }
      break;
    }
    case NcFlowWord::break_loop:
    case NcFlowWord::continue_loop:
      leave_loop(block, entry);
      break;
    default:
      break;
  }
}

void NcFlow::leave_loop(NcBlock& block, std::size_t entry) {
  expect_end(block);
  const std::size_t start = entries_[entry].start;
  const NcFlowWord kind = entries_[start].word;
  if (kind != NcFlowWord::while_loop && kind != NcFlowWord::do_loop && kind != NcFlowWord::repeat) {
    fail_o(block, "no loop of this name stands around it");
  }
  const NcFlowWord last = kind == NcFlowWord::repeat    ? NcFlowWord::endrepeat
                          : kind == NcFlowWord::do_loop ? NcFlowWord::while_loop
                                                        : NcFlowWord::endwhile;
  const std::size_t end = find(block, entry, last, last);
  std::vector<Loop>& open = loops();
  // Loops inside the one that is left end with it.
  if (kind == NcFlowWord::repeat) {
    while (!open.empty() && open.back().entry != start) open.pop_back();
    if (open.empty()) fail_o(block, "the loop was not begun");
    if (block.flow == NcFlowWord::break_loop) open.pop_back();
  } else {
    while (!open.empty() && open.back().entry > start && open.back().entry < end) open.pop_back();
  }
  jump(block, block.flow == NcFlowWord::break_loop ? entries_[end].behind : entries_[end].here);
}

}  // namespace abbe
