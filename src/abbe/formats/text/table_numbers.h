#pragma once

// Internal to formats: numbers in tables of controls, and lines with their place for messages.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// fixed_number() without the zeros at its end: "760", "20.5".
std::string trimmed_decimals(double value, int decimals);

/// mm as they are, rad as degrees.
double shown_position(double value, bool rotary);
double inside_position(double value, bool rotary);
/// shown_position() with nine decimals: a step that is no round number adds up over hundreds of points.
std::string shown_position_text(double value, bool rotary);

/// Line by line, with numbers from 1; line ends LF, CRLF or CR.
class TableLines {
 public:
  TableLines(std::string_view text, const std::string& file) : text_(text), file_(file) {}
  /// @returns false at the end
  bool next();
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }
  /// At the line read last. @throws InputError
  [[noreturn]] void fail(const std::string& field, const std::string& problem, const std::string& expected) const;
  /// A number of at most kLargestInput. @throws InputError
  double value(std::string_view word, const std::string& field, const std::string& expected) const;
  /// A whole number from `least` to `most`. @throws InputError
  std::size_t whole(std::string_view word, const std::string& field, std::size_t least, std::size_t most) const;

 private:
  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  std::string_view line_;
};

/// Without blanks at both ends.
std::string_view without_blanks(std::string_view text);

/// Words between blanks.
std::vector<std::string_view> words_of(std::string_view line);

}  // namespace abbe
