#include "abbe/formats/text/wrapped_text.h"

#include <algorithm>

#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

/// Of a line of two columns the width of the first one with its blanks; else two more than its indentation.
std::size_t hanging_indent(std::string_view line, std::size_t width) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  std::size_t indent = begin + 2;
  const std::size_t gap = line.find("  ", begin);
  if (gap == std::string_view::npos) return indent;
  const std::size_t second = line.find_first_not_of(' ', gap);
  // Without room for a few words, columns help nobody.
  if (second != std::string_view::npos && second < width / 2) indent = characters_in(line.substr(0, second));
  return indent;
}

void add_wrapped(std::string_view line, std::size_t width, std::string_view command, std::string& result) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const bool is_command = line.substr(begin).starts_with(command);
  const std::size_t indent = is_command ? begin + 4 : hanging_indent(line, width);
  const std::string_view end = is_command ? " \\" : "";
  std::string shown;
  bool has_word = false;
  std::size_t at = 0;
  while (at < line.size()) {
    // A word with the blanks before it.
    const std::size_t word = std::min(line.find_first_not_of(' ', at), line.size());
    std::size_t next = std::min(line.find(' ', word), line.size());
    if (!is_command && characters_in(line.substr(word, next - word)) + indent > width) {
      // A list without blanks may be broken behind its commas.
      next = std::min(line.find(',', word), next - 1) + 1;
    }
    const std::string_view part = line.substr(at, next - at);
    const bool is_last = next == line.size();
    if (has_word && characters_in(shown) + characters_in(part) + (is_last ? 0 : end.size()) > width) {
      result += shown + std::string(end) + "\n";
      shown = std::string(indent, ' ') + std::string(line.substr(word, next - word));
    } else {
      shown += part;
    }
    has_word = true;
    at = next;
  }
  result += shown;
}

}  // namespace

std::string wrapped_help(std::string_view text, std::size_t width, std::string_view command) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (characters_in(line) <= width) {
      result += line;
    } else {
      add_wrapped(line, width, command, result);
    }
    if (end < text.size()) result += '\n';
    at = end + 1;
  }
  return result;
}

std::string prefixed_lines(std::string_view prefix, std::string_view text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    result += std::string(prefix) + std::string(text.substr(at, end + 1 - at));
    at = end + 1;
  }
  return result;
}

}  // namespace abbe
