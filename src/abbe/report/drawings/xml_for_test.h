#pragma once

// For tests: whether a text is well-formed enough for a browser to read it as XML.
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// What is wrong with the nesting of elements, quotes or entities, or nothing.
inline std::string xml_problem(std::string_view text) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '&') {
      const std::size_t end = text.find(';', at);
      if (end == std::string_view::npos || end - at > 6) return "a bare & at " + std::to_string(at);
      continue;
    }
    if (text[at] == '>') return "a bare > at " + std::to_string(at);
    if (text[at] != '<') continue;
    std::size_t end = at + 1;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (text[end] == '<') return "< inside a tag at " + std::to_string(end);
    }
    if (end >= text.size()) return "a tag that does not end at " + std::to_string(at);
    std::string_view tag = text.substr(at + 1, end - at - 1);
    at = end;
    if (tag.starts_with('/')) {
      tag.remove_prefix(1);
      if (open.empty() || open.back() != tag) return "</" + std::string(tag) + "> without its beginning";
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.emplace_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> without an end";
}

}  // namespace abbe
