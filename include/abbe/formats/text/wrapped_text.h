#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

/// Help of a command with lines of at most `width` characters, broken at blanks.
///
/// The rest of a line stands below its last column, which begins behind two blanks or more, or is indented by two more
/// blanks where there are no columns. A line that begins with a command to be typed is continued as shells do it, by a
/// backslash. A list without blanks that is longer than a line is broken behind its commas; a longer word stays whole.
/// @param command  what such a line begins with behind its indentation: "abbe "
std::string wrapped_help(std::string_view text, std::size_t width, std::string_view command);

/// Text with the prefix in front of each of its lines; empty for an empty text.
std::string prefixed_lines(std::string_view prefix, std::string_view text);

}  // namespace abbe
