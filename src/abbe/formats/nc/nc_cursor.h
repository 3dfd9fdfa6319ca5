#pragma once

// Internal to formats: a place in the text of an NC program.
#include <cstddef>
#include <string>
#include <string_view>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

/// Where a line of a program is being read.
struct NcCursor {
  const char* at = nullptr;
  const char* begin = nullptr;  ///< of the line
  const char* end = nullptr;
  std::size_t line = 0;  ///< from 1
  const std::string* file = nullptr;

  void skip_blanks() {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  }
  /// Next character that is no blank, in lower case; 0 at the end. A zero byte is not the end: what comes behind it
  /// would be lost.
  char peek() {
    skip_blanks();
    if (at == end) return 0;
    if (*at == 0) return '\1';
    return lower_case(*at);
  }

  /// @param word  where the word begins that is wrong; it is named up to `at` or the next blank
  /// @throws InputError
  [[noreturn]] void fail(const char* word, const std::string& problem, const std::string& expected = "") const;
};

}  // namespace abbe
