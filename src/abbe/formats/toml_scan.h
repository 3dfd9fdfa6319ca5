#pragma once

// Internal to formats.
#include <string>
#include <string_view>

namespace abbe {

/// Refuses four kinds of text that are no TOML and on which toml++ 3.3 runs into its own assertions (in a release
/// build: undefined behaviour) instead of an error: characters beyond ASCII outside texts and comments, table headers
/// that do not begin with a name, quotes in the middle of a word, and brackets that do not match.
/// @throws InputError
void refuse_what_the_parser_cannot_take(std::string_view text, const std::string& file);

}  // namespace abbe
