#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// "X12.5" or "C2=30".
struct Word {
  char letter = 0;
  std::string name;     ///< of an axis: "C2"; empty for a plain letter
  std::string written;  ///< for messages
  double value = 0;
};

class ProgramReader {
 public:
  ProgramReader(const std::string& file, const Machine& machine) : file_(file), machine_(machine) {}

  Curve read(std::string_view text) {
    std::size_t at = 0;
    while (at < text.size() && !ended_) {
      ++line_;
      block(words_of(csv_next_line(text, at)));
    }
    if (curve_.points.empty()) fail_file("no moves", "blocks G0 or G1 with X Y Z and a direction I J K");
    return std::move(curve_);
  }

 private:
  [[noreturn]] void fail(const std::string& word, const std::string& problem, const std::string& expected) const {
    throw InputError({file_, line_, 0, word}, problem, expected);
  }
  [[noreturn]] void fail_file(const std::string& problem, const std::string& expected) const {
    throw InputError({.file = file_}, problem, expected);
  }

  std::vector<Word> words_of(std::string_view line) const {
    std::vector<Word> words;
    std::size_t i = 0;
    while (i < line.size()) {
      const char c = line[i];
      if (is_blank(c) || c == '%') {
        ++i;
      } else if (c == ';') {
        break;
      } else if (c == '(') {
        const std::size_t end = line.find(')', i);
        if (end == std::string_view::npos) fail("(", "a comment that does not end", "')' on the same line");
        i = end + 1;
      } else if (is_letter(c)) {
        words.push_back(word_at(line, i));
      } else {
        fail(shown_word(line.substr(i)), "not a word of a program that is read here",
             "a letter with a number; parameters, expressions and subroutines have to be expanded before");
      }
    }
    return words;
  }

  Word word_at(std::string_view line, std::size_t& i) const {
    Word word;
    const std::size_t begin = i;
    word.letter = upper_case(line[i++]);
    std::size_t digits = i;
    while (digits < line.size() && is_digit(line[digits])) ++digits;
    if (digits < line.size() && line[digits] == '=') {
      word.name = word.letter + std::string(line.substr(i, digits - i));
      i = digits + 1;
    }
    while (i < line.size() && (line[i] == ' ' || line[i] == '\t')) ++i;
    const std::size_t number = i;
    while (i < line.size() && (is_digit(line[i]) || line[i] == '.' || line[i] == '-' || line[i] == '+')) ++i;
    word.written = shown_word(line.substr(begin, i - begin));
    if (parse_number(line.substr(number, i - number), 0, word.value) != NumberProblem::none) {
      fail(word.written, "no number behind the letter", "a plain number of at most 1e9");
    }
    if (!(std::abs(word.value) <= kLargestInput)) fail(word.written, "is too large", "a magnitude of at most 1e9");
    return word;
  }

  void block(const std::vector<Word>& words) {
    bool moves = false, dwells = false, has_p = false;
    double p = 0;
    for (const Word& word : words) {
      const std::size_t axis = indexed_axis(word);
      if (axis != Machine::npos) {
        set_index(axis, word);
        continue;
      }
      switch (word.letter) {
        case 'N':
        case 'S':
          break;
        case 'G':
          g_code(word, dwells);
          break;
        case 'M':
          m_code(word);
          break;
        case 'F':
          if (!(word.value > 0)) fail(word.written, "not above zero", "a feed in mm/min");
          feed_ = word.value * scale_ / 60;
          break;
        case 'P':
          has_p = true;
          p = word.value;
          break;
        case 'X':
        case 'Y':
        case 'Z':
          set(static_cast<std::size_t>(word.letter - 'X'), word.value * scale_);
          moves = true;
          break;
        case 'I':
        case 'J':
        case 'K':
          set(3 + static_cast<std::size_t>(word.letter - 'I'), word.value);
          moves = true;
          break;
        default:
          fail(word.written, "a word that is not read here", "N G0 G1 G4 G20 G21 G90 G94 X Y Z I J K F P S M3 M5 M30");
      }
    }
    if (dwells) {
      if (!has_p || p < 0 || moves) fail("G4", "no dwell", "G4 P with seconds, on its own");
      if (curve_.points.empty()) fail("G4", "a dwell before the first move", "moves first");
      curve_.points.back().dwell += p;
    } else if (has_p) {
      fail("P", "a word without G4", "G4 P with seconds");
    }
    if (moves) add_point();
  }

  std::size_t indexed_axis(const Word& word) const {
    if (!word.name.empty()) {
      const std::size_t axis = machine_.find_axis(word.name);
      if (axis == Machine::npos)
        fail(word.written, "the machine has no axis " + word.name, "one of " + machine_.chain());
      return axis;
    }
    if (std::string_view("ABCDEUVWQR").find(word.letter) == std::string_view::npos) return Machine::npos;
    return machine_.find_axis(std::string(1, word.letter));
  }

  void set_index(std::size_t axis, const Word& word) {
    const double value = word.value * (machine_.axes[axis].kind == AxisKind::rotary ? kDegree : scale_);
    const auto known = std::find(curve_.indexed.begin(), curve_.indexed.end(), axis);
    if (known != curve_.indexed.end()) {
      index_[static_cast<std::size_t>(known - curve_.indexed.begin())] = value;
      return;
    }
    if (!curve_.points.empty()) {
      fail(word.written, "moves before it have no command for " + machine_.axes[axis].name,
           "an axis that is set beforehand has its command before the first move");
    }
    curve_.indexed.push_back(axis);
    index_.push_back(value);
  }

  void g_code(const Word& word, bool& dwells) {
    const double g = word.value;
    if (g == 0 || g == 1) {
      motion_ = g == 0 ? 0 : 1;
    } else if (g == 4) {
      dwells = true;
    } else if (g == 20 || g == 21) {
      scale_ = g == 20 ? 25.4 : 1;
    } else if (g != 90 && g != 94 && g != 17 && g != 40 && g != 49) {
      fail(word.written, "a function that is not read here",
           "straight moves G0 and G1, absolute (G90), feed per minute (G94)");
    }
  }

  void m_code(const Word& word) {
    const double m = word.value;
    if (m == 3 || m == 4) {
      beam_ = true;
    } else if (m == 5) {
      beam_ = false;
    } else if (m == 2 || m == 30) {
      ended_ = true;
    } else {
      fail(word.written, "a function that is not read here", "M3, M4, M5, M2 or M30");
    }
  }

  void set(std::size_t i, double value) {
    value_[i] = value;
    known_[i] = true;
  }

  void add_point() {
    if (motion_ < 0) fail("", "a move without G0 or G1 before it", "G0 or G1");
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (!known_[i]) {
        fail(std::string(1, "XYZIJK"[i]), "not known at this move", "X Y Z and the direction I J K, at the first move");
      }
    }
    CurvePoint point;
    point.point = {value_[0], value_[1], value_[2]};
    point.direction = {value_[3], value_[4], value_[5]};
    if (!(point.direction.norm() > 1e-6)) fail("I, J, K", "a direction of length zero", "towards the source");
    point.direction.normalize();
    point.working = motion_ == 1 && beam_;
    point.feed = feed_;
    point.indexed = index_;
    curve_.points.push_back(std::move(point));
  }

  const std::string& file_;
  const Machine& machine_;
  Curve curve_;
  std::size_t line_ = 0;
  std::vector<double> index_;
  std::array<double, 6> value_{};
  std::array<bool, 6> known_{};
  int motion_ = -1;
  double scale_ = 1, feed_ = 0;
  bool beam_ = false, ended_ = false;
};

}  // namespace

Curve parse_curve_program(std::string_view text, const std::string& file, const Machine& machine) {
  return ProgramReader(file, machine).read(text);
}

}  // namespace abbe
