#include "abbe/formats/import/instrument_lines.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/line_numbers.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {

bool InstrumentLines::next() {
  while (at_ < text_.size()) {
    whole_ = csv_next_line(text_, at_);
    line_ = csv_trimmed(whole_);
    ++number_;
    if (!line_.empty()) return true;
  }
  return false;
}

std::vector<std::string_view> instrument_words(std::string_view line) {
  std::vector<std::string_view> words;
  const char* at = line.data();
  const char* const end = at + line.size();
  while ((at = skip_spaces(at, end)) != end) {
    const char* const behind = word_end(at, end);
    words.emplace_back(at, static_cast<std::size_t>(behind - at));
    at = behind;
  }
  return words;
}

std::optional<InstrumentKey> instrument_key(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  return InstrumentKey{csv_trimmed(line.substr(0, colon)), csv_trimmed(line.substr(colon + 1))};
}

double instrument_number(std::string_view word, const std::string& file, std::size_t line, const std::string& field,
                         const std::string& expected) {
  double value = 0;
  NumberProblem problem = parse_number(word, 0, value);
  if (problem == NumberProblem::none && std::abs(value) > kLargestInput) problem = NumberProblem::too_large;
  if (problem == NumberProblem::none) return value;
  throw InputError({.file = file, .line = line, .field = field},
                   fmt::format("'{}' {}", shown_text(word), number_problem_words(problem)), expected);
}

std::size_t instrument_count(std::string_view word, std::size_t least, std::size_t most, const std::string& file,
                             std::size_t line, const std::string& field) {
  std::size_t value = 0;
  const auto [behind, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && behind == word.data() + word.size() && value >= least && value <= most) return value;
  throw InputError({.file = file, .line = line, .field = field},
                   fmt::format("'{}' is no such number", shown_text(word)),
                   fmt::format("a whole number from {} to {}", least, most));
}

std::string shown_text(std::string_view text) { return printable(text, 60, LineFeeds::escaped); }

}  // namespace abbe
