#include "abbe/formats/nc/siemens_assignments.h"

#include <fmt/format.h>

#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

std::string in_capitals(std::string_view text) {
  std::string capitals;
  for (const char c : text) capitals += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return capitals;
}

bool is_frame(std::string_view line) {
  const std::string text = in_capitals(line);
  return text[0] == '%' || text.starts_with("CHANDATA") || text == "M17" || text == "M30" || text == "M02" ||
         text == "M2" || text == "M0";
}

}  // namespace

bool next_siemens_assignment(TableLines& lines, SiemensAssignment& assignment) {
  while (lines.next()) {
    const std::string_view line = without_blanks(lines.line().substr(0, lines.line().find(';')));
    if (line.empty() || is_frame(line)) continue;
    const std::size_t open = line.find('['), close = line.find(']'), equals = line.find('=');
    if (line[0] != '$' || open == std::string_view::npos || close == std::string_view::npos ||
        equals == std::string_view::npos || !(open < close && close < equals) ||
        !without_blanks(line.substr(close + 1, equals - close - 1)).empty()) {
      lines.fail("", fmt::format("'{}' is not an assignment", shown_word(line)), "$NAME[index] = value");
    }
    assignment.name = in_capitals(without_blanks(line.substr(0, open)));
    assignment.indices.clear();
    std::string_view indices = line.substr(open + 1, close - open - 1);
    while (true) {
      const std::size_t comma = indices.find(',');
      assignment.indices.push_back(without_blanks(indices.substr(0, comma)));
      if (comma == std::string_view::npos) break;
      indices.remove_prefix(comma + 1);
    }
    assignment.value = without_blanks(line.substr(equals + 1));
    if (assignment.value.size() >= 2) {
      const char first = assignment.value.front(), last = assignment.value.back();
      if ((first == '(' && last == ')') || (first == '"' && last == '"')) {
        assignment.value = without_blanks(assignment.value.substr(1, assignment.value.size() - 2));
      }
    }
    return true;
  }
  return false;
}

}  // namespace abbe
