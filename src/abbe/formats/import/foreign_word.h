#pragma once

// Internal to formats: names of columns as other programs write them, made comparable.
#include <string>
#include <string_view>

namespace abbe {

/// In small letters, also Ä, Ö and Ü.
std::string small_letters(std::string_view text);

/// In small letters, with one blank in place of any other characters than letters, digits and signs: "Pos. X" and
/// "pos_x" are both "pos x". The case of letters stays where that is wanted.
std::string comparable_word(std::string_view text, bool keep_case = false);

}  // namespace abbe
