#pragma once

// Internal to formats: words and numbers of a text, one after the other.
#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

/// First ten or so characters of a word from a file, for messages: control characters as dots.
std::string shown_word(std::string_view word);

/// True for what separates words: spaces, tabs, line ends.
inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

class TextCursor {
 public:
  /// @param file  name for messages
  TextCursor(std::string_view text, const std::string& file, std::size_t begin = 0)
      : text_(text), file_(file), at_(begin), word_at_(begin) {}

  /// Next word over blanks and line ends, or empty at the end.
  std::string_view word();
  /// Goes behind the next word if it is this one. @return false: the cursor stays where it was
  bool take(std::string_view word);
  /// Next word as a number of at most kLargestInput. @throws InputError naming the field
  double number(const char* field);
  /// Next word as a whole number. @throws InputError
  long long integer(const char* field);
  /// The rest of the line, without its end (LF, CRLF or CR); the cursor goes behind it.
  std::string_view line();

  std::size_t position() const { return at_; }
  bool at_end() const { return at_ >= text_.size(); }
  /// At the word that was read last, with its line. @throws InputError
  [[noreturn]] void fail(const std::string& field, const std::string& problem, const std::string& expected) const;

 private:
  void skip_blanks();

  std::string_view text_;
  const std::string& file_;
  std::size_t at_;
  std::size_t word_at_;
};

}  // namespace abbe
