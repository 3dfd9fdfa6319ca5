#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

/// Length of the UTF-8 sequence that begins there (RFC 3629: shortest forms, no surrogates, at most U+10FFFF), or 0 if
/// there is none.
std::size_t utf8_length(std::string_view text, std::size_t at);

/// Columns on a screen: characters, not bytes.
std::size_t characters_in(std::string_view text);

/// Whether the character that begins there is one that terminals and pages obey instead of showing it: control
/// characters, also U+0080 to U+009F, separators of lines, and what changes the direction of writing.
bool is_obeyed(std::string_view text, std::size_t at);

/// Whether a control character is in it that a name on one line has no use for: all but the tab.
bool has_control_character(std::string_view text);

enum class LineFeeds { kept, escaped };

/// What a terminal can be shown of text from a file: characters that it would obey and bytes that are no UTF-8 as
/// "\x1b", and of longer text the first `most` bytes and "...". Tabs stay.
std::string printable(std::string_view text, std::size_t most, LineFeeds line_feeds = LineFeeds::kept);

/// printable() of text that comes in pieces, which may end within a character. Line feeds stay.
class PrintableText {
 public:
  /// What can be shown now.
  std::string next(std::string_view piece);
  /// What is left at the end of the text: a character cut short.
  std::string rest();

 private:
  std::string begun_;
};

}  // namespace abbe
