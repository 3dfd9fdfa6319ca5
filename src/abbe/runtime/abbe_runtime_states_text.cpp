#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/runtime/frozen_channels.h"
#include "abbe/runtime/frozen_layout.h"

// Lines of words, so that other programs can write it too (linuxcnc/keep-states):
//
//   abbe-states 1
//   compensation 0123456789abcdef   checksum of the file
//   time 1764364800.25              s since 1970-01-01 UTC
//   channel ambient 21.5            used, in its unit
//   lag column 20.75
//   end

namespace abbe {
namespace {

constexpr std::string_view kFirstLine = "abbe-states 1";

/// Text in a room; too much of it makes its length 0.
class StatesText {
 public:
  StatesText(char* text, std::size_t size) : text_(text), size_(size) {}
  void add(std::string_view words) {
    if (fits_ && words.size() + used_ + 1 <= size_) {
      std::memcpy(text_ + used_, words.data(), words.size());
      used_ += words.size();
    } else {
      fits_ = false;
    }
  }
  void number(double value) {
    char digits[40];
    add({digits, static_cast<std::size_t>(std::to_chars(digits, digits + sizeof digits, value).ptr - digits)});
  }
  void checksum(std::uint64_t sum) {
    for (int shift = 60; shift >= 0; shift -= 4)
      add(std::string_view("0123456789abcdef").substr(sum >> shift & 15U, 1));
  }
  std::size_t end() {
    if (size_ > 0) text_[fits_ ? used_ : 0] = 0;
    return fits_ ? used_ : 0;
  }

 private:
  char* text_;
  std::size_t size_, used_ = 0;
  bool fits_ = true;
};

/// Lines of two or three words.
class StatesLines {
 public:
  explicit StatesLines(std::string_view text) : rest_(text) {}
  /// @returns false at the end, or if the line has no end
  bool next() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) return false;
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return true;
  }
  std::string_view line() const { return line_; }
  /// What follows these words.
  bool after(std::string_view word, std::string_view name, std::string_view& value) const {
    std::string_view left = line_;
    for (const std::string_view one : {word, name}) {
      if (one.empty()) continue;
      if (left.substr(0, one.size()) != one || left.substr(one.size(), 1) != " ") return false;
      left.remove_prefix(one.size() + 1);
    }
    value = left;
    return true;
  }
  bool number(std::string_view word, std::string_view name, double& value) const {
    std::string_view digits;
    if (!after(word, name, digits)) return false;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return read.ec == std::errc() && read.ptr == digits.data() + digits.size() && std::isfinite(value);
  }

 private:
  std::string_view rest_, line_;
};

const FrozenState& state_at(const FrozenStates& s, std::size_t c) { return s.state[s.channel[c]]; }

}  // namespace

extern "C" {

size_t abbe_runtime_states_text(const abbe_runtime_states* states, double unix_s, char* text,
                                size_t size) ABBE_NOEXCEPT {
  if (states == nullptr || text == nullptr || !std::isfinite(unix_s) || states->read->states == nullptr) return 0;
  const FrozenStates& s = *states->read->states;
  StatesText out(text, size);
  out.add(kFirstLine);
  out.add("\ncompensation ");
  out.checksum(states->read->information.checksum);
  out.add("\ntime ");
  out.number(unix_s);
  for (std::size_t c = 0; c < s.channels; ++c) {
    if (states->channel[c].flags != 0) return 0;
    out.add("\nchannel ");
    out.add(state_at(s, c).name);
    out.add(" ");
    out.number(states->channel[c].used);
  }
  for (std::size_t k = 0; k < s.lags; ++k) {
    out.add("\nlag ");
    out.add(s.state[s.lag[k]].name);
    out.add(" ");
    out.number(states->lag[k].value);
  }
  out.add("\nend\n");
  return out.end();
}

int abbe_runtime_states_restore_text(abbe_runtime_states* states, const char* text, size_t size, double unix_s,
                                     double largest_age_s) ABBE_NOEXCEPT {
  if (states == nullptr || text == nullptr) return ABBE_NULL;
  if (states->read->states == nullptr) return ABBE_FILE_FOREIGN;
  const FrozenStates& s = *states->read->states;
  StatesLines lines({text, size});
  if (size > 100000 || !lines.next() || lines.line() != kFirstLine) return ABBE_FILE_FOREIGN;
  std::string_view sum;
  if (!lines.next()) return ABBE_FILE_SHORT;
  char digits[20];
  StatesText own(digits, sizeof digits);
  own.checksum(states->read->information.checksum);
  if (!lines.after("compensation", "", sum) || sum != std::string_view(digits, own.end())) return ABBE_FILE_FOREIGN;
  double then = 0, channels[kFrozenStates] = {}, lags[kFrozenStates] = {};
  if (!lines.next()) return ABBE_FILE_SHORT;
  if (!lines.number("time", "", then)) return ABBE_FILE_CONTENT;
  // In any order, each of them once.
  bool has_channel[kFrozenStates] = {}, has_lag[kFrozenStates] = {};
  std::size_t found = 0;
  while (true) {
    if (!lines.next()) return ABBE_FILE_SHORT;
    if (lines.line() == "end") break;
    const std::size_t before = found;
    for (std::size_t c = 0; c < s.channels; ++c) {
      if (has_channel[c] || !lines.number("channel", state_at(s, c).name, channels[c])) continue;
      has_channel[c] = true;
      ++found;
    }
    for (std::size_t k = 0; k < s.lags; ++k) {
      if (has_lag[k] || !lines.number("lag", s.state[s.lag[k]].name, lags[k])) continue;
      has_lag[k] = true;
      ++found;
    }
    if (found == before) return ABBE_FILE_CONTENT;
  }
  if (found != s.channels + s.lags) return ABBE_FILE_CONTENT;
  const double age = unix_s - then;
  if (!(age >= 0 && age <= largest_age_s)) return ABBE_STALE;
  const int restored = abbe_runtime_states_restore(states, channels, lags, age);
  return restored == ABBE_NOT_FINITE ? ABBE_FILE_CONTENT : restored;
}

}  // extern "C"

}  // namespace abbe
