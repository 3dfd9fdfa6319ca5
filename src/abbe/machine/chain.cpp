#include "abbe/machine/chain.h"

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::string_view kPrimes[] = {"'", "\xE2\x80\xB2", "\xE2\x80\x99"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Length of the UTF-8 character at a position, so that a message never cuts one in half.
std::size_t character_length(std::string_view text, std::size_t position) {
  std::size_t end = position + 1;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) ++end;
  return end - position;
}

class ChainReader {
 public:
  explicit ChainReader(std::string_view text) : text_(text) {}

  ParsedChain read() {
    skip_blanks();
    if (!take('w')) return fail("w for the workpiece, with which a chain begins");
    for (skip_blanks(); !at('b'); skip_blanks()) {
      if (at('t')) return fail("b for the bed, which must stand before t");
      if (!read_axis(ChainSide::workpiece, "an axis (X', C', C2', ...) or b for the bed")) return result_;
    }
    take('b');
    for (skip_blanks(); !at('t'); skip_blanks()) {
      if (at('b')) return fail("an axis or t: there is one bed only");
      if (!read_axis(ChainSide::tool, "an axis (Z, A, B1, ...) or t for the tool")) return result_;
    }
    take('t');
    skip_blanks();
    if (position_ < text_.size()) return fail("nothing after t, with which a chain ends");
    if (result_.machine.axes.empty()) return fail("at least one axis between w and t");
    result_.ok = true;
    return result_;
  }

 private:
  bool at(char c) const { return position_ < text_.size() && text_[position_] == c; }
  bool take(char c) {
    if (!at(c)) return false;
    ++position_;
    return true;
  }
  void skip_blanks() {
    while (position_ < text_.size() && is_blank(text_[position_])) ++position_;
  }

  ParsedChain fail(std::string expected) { return fail_at(position_, 0, std::move(expected)); }

  ParsedChain fail_at(std::size_t position, std::size_t length, std::string expected) {
    result_.ok = false;
    ChainError& error = result_.error;
    error.position = position;
    error.expected = std::move(expected);
    if (position >= text_.size()) {
      error.found = "the end";
    } else {
      error.length = length > 0 ? length : character_length(text_, position);
      error.found = "'" + std::string(text_.substr(position, error.length)) + "'";
    }
    return result_;
  }

  bool read_axis(ChainSide side, const std::string& expected) {
    const std::size_t start = position_;
    if (start >= text_.size()) return fail(expected).ok;
    const char letter = text_[start];
    Axis axis;
    if (!axis_kind_from_letter(letter, axis.kind)) return fail(hint(letter, expected)).ok;
    axis.side = side;
    axis.direction = direction_from_letter(letter);
    axis.name = letter;
    ++position_;
    if (!read_number(axis)) return false;
    for (std::string_view prime : kPrimes) {
      if (!axis.primed && text_.substr(position_, prime.size()) == prime) {
        axis.primed = true;
        position_ += prime.size();
      }
    }
    if (axis.primed && side == ChainSide::tool) {
      return fail_at(start, position_ - start,
                     axis.name + ": a prime marks an axis that carries the workpiece, but after b axes carry the tool")
          .ok;
    }
    if (result_.machine.find_axis(axis.name) != Machine::npos) {
      return fail_at(start, position_ - start, "another name: number axes of the same letter, such as C1 and C2").ok;
    }
    if (result_.machine.axes.size() == kMaxAxes) {
      return fail_at(start, position_ - start, "no more than " + std::to_string(kMaxAxes) + " axes").ok;
    }
    const bool about_z = direction_from_letter(letter).z() > 0;
    axis.endless = axis.kind == AxisKind::rotary && about_z;
    axis.travel_max = axis.kind == AxisKind::linear ? 250 : axis.endless ? 360 * kDegree : 120 * kDegree;
    axis.travel_min = axis.endless ? 0 : -axis.travel_max;
    result_.machine.axes.push_back(axis);
    return true;
  }

  bool read_number(Axis& axis) {
    const std::size_t start = position_;
    while (position_ < text_.size() && is_digit(text_[position_])) axis.name += text_[position_++];
    const std::size_t length = position_ - start;
    if (length > 0 && (text_[start] == '0' || length > 2)) {
      return fail_at(start, length, "an axis number from 1 to 99 without leading zero").ok;
    }
    return true;
  }

  static std::string hint(char letter, const std::string& expected) {
    AxisKind kind;
    const char upper = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    if (upper != letter && letter != 'w' && axis_kind_from_letter(upper, kind)) {
      return expected + "; axis letters are capitals: " + upper;
    }
    if (letter == 'T') return expected + "; the tool is a small t";
    if (letter == 'w') return expected + "; w stands once, at the beginning";
    if (is_digit(letter)) return expected + "; a number follows its letter without a blank: C2";
    for (std::string_view prime : kPrimes) {
      if (letter == prime[0]) return expected + "; a prime follows its axis without a blank: X'";
    }
    return expected;
  }

  std::string_view text_;
  std::size_t position_ = 0;
  ParsedChain result_;
};

}  // namespace

std::string ChainError::message() const {
  return "column " + std::to_string(position + 1) + ": found " + found + ", expected " + expected;
}

std::string ChainError::pointed(std::string_view text) const {
  std::size_t before = 0, under = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts_character = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
    if (starts_character && i < position) ++before;
    if (starts_character && i >= position && i < position + length) ++under;
  }
  return std::string(text) + "\n" + std::string(before, ' ') + std::string(under > 0 ? under : 1, '^');
}

ParsedChain parse_chain(std::string_view text) { return ChainReader(text).read(); }

}  // namespace abbe
