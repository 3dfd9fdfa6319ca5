#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

/// Length of the UTF-8 sequence that begins there (RFC 3629: shortest forms, no surrogates, at most U+10FFFF), or 0 if
/// there is none.
std::size_t utf8_length(std::string_view text, std::size_t at);

/// What a terminal can be shown of text from a file: control characters and bytes that are no UTF-8 as "\x1b", and of
/// longer text the first `most` bytes and "...".
std::string printable(std::string_view text, std::size_t most);

}  // namespace abbe
