#pragma once

// For formats and the program abbe-step: letters and digits of ASCII, whatever the locale.

namespace abbe {

inline char upper_case(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
inline char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
inline bool is_letter(char c) { return lower_case(c) >= 'a' && lower_case(c) <= 'z'; }
inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

}  // namespace abbe
