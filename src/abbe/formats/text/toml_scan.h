#pragma once

// Internal to formats.
#include <string>
#include <string_view>

namespace abbe {

/// Refuses five kinds of text on which toml++ 3.3 runs into its own assertions (in a release build: undefined
/// behaviour) instead of an error: characters beyond ASCII outside texts and comments, table headers that do not begin
/// with a name, quotes in the middle of a word, brackets that do not match, and dates, which are TOML but have no place
/// in any file here ([2026-01-01 8] ends the parser).
/// @throws InputError
void refuse_what_the_parser_cannot_take(std::string_view text, const std::string& file);

}  // namespace abbe
