#pragma once

// Internal to formats: the words and numbers of one line.
#include <cmath>
#include <string_view>

#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {

inline const char* skip_spaces(const char* at, const char* end) {
  while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  return at;
}

inline const char* word_end(const char* at, const char* end) {
  while (at != end && *at != ' ' && *at != '\t' && *at != '\r') ++at;
  return at;
}

/// Reads the number that begins at `at` and ends before a space or the end of the line; of at most `largest`.
/// @returns the place behind it, or null if it is none: `problem` then says why
inline const char* read_line_number(const char* at, const char* end, double largest, double& value,
                                    NumberProblem& problem) {
  const char* const behind = read_short_decimal(at, end, 0, value);
  if (behind != nullptr && (behind == end || *behind == ' ' || *behind == '\t' || *behind == '\r')) {
    if (std::abs(value) <= largest) return behind;
    problem = NumberProblem::too_large;
    return nullptr;
  }
  const char* const word = word_end(at, end);
  problem = parse_number({at, static_cast<std::size_t>(word - at)}, 0, value);
  if (problem == NumberProblem::none && !(std::abs(value) <= largest)) problem = NumberProblem::too_large;
  return problem == NumberProblem::none ? word : nullptr;
}

/// "is not a number", ...
inline std::string_view number_problem_words(NumberProblem problem) {
  switch (problem) {
    case NumberProblem::not_a_number:
      return "is not a number";
    case NumberProblem::not_finite:
      return "is not a finite number";
    case NumberProblem::too_large:
      return "is too large";
    case NumberProblem::none:
      break;
  }
  return "";
}

}  // namespace abbe
