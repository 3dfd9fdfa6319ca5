#pragma once

// Internal to formats: what readers of text forms of instruments share.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// The lines of a text, with their numbers.
class InstrumentLines {
 public:
  explicit InstrumentLines(std::string_view text) : text_(text) {}

  /// Goes to the next line that is not blank. @returns false at the end
  bool next();
  /// Without blanks around it and without its end.
  std::string_view text() const { return line_; }
  /// With the blanks around it.
  std::string_view whole() const { return whole_; }
  std::size_t number() const { return number_; }  ///< from 1

 private:
  std::string_view text_, line_, whole_;
  std::size_t at_ = 0, number_ = 0;
};

/// Words between blanks and tabs.
std::vector<std::string_view> instrument_words(std::string_view line);

/// Text before and behind the first colon, without blanks around them; nothing if there is no colon.
struct InstrumentKey {
  std::string_view key, value;
};
std::optional<InstrumentKey> instrument_key(std::string_view line);

/// The number that a word is, of at most kLargestInput. @throws InputError with the place and what was expected
double instrument_number(std::string_view word, const std::string& file, std::size_t line, const std::string& field,
                         const std::string& expected);
/// A whole number from `least` to `most`. @throws InputError
std::size_t instrument_count(std::string_view word, std::size_t least, std::size_t most, const std::string& file,
                             std::size_t line, const std::string& field);

/// Name or value for messages and the terminal: at most 60 bytes.
std::string shown_text(std::string_view text);

}  // namespace abbe
