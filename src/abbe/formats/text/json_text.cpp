#include "abbe/formats/text/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/not_finite.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

bool is_flat(const Json& array) {
  return std::all_of(array.begin(), array.end(), [](const Json& element) { return element.is_primitive(); });
}

/// In quotes. Bytes that are no UTF-8 (file names may be any) become the replacement character, and what a terminal
/// would obey becomes "\u202e".
std::string quoted(const Json& string) {
  const std::string dumped = string.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (std::size_t at = 0; at < dumped.size();) {
    const std::size_t length = std::max<std::size_t>(utf8_length(dumped, at), 1);
    if (is_obeyed(dumped, at)) {
      // All of them are of at most three bytes.
      unsigned code = static_cast<unsigned char>(dumped[at]) & (length == 1 ? 0x7FU : length == 2 ? 0x1FU : 0x0FU);
      for (std::size_t i = 1; i < length; ++i) code = code << 6U | (static_cast<unsigned char>(dumped[at + i]) & 0x3FU);
      text += fmt::format("\\u{:04x}", code);
    } else {
      text += dumped.substr(at, length);
    }
    at += length;
  }
  return text;
}

void append(const Json& value, const std::string& path, std::size_t depth, std::string& text) {
  const std::string inner(2 * depth + 2, ' '), outer(2 * depth, ' ');
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!std::isfinite(number)) throw NotFinite("the result " + path);
    text += shortest_text(number);
  } else if (value.is_object() && !value.empty()) {
    text += "{\n";
    bool first = true;
    for (const auto& [key, element] : value.items()) {
      text += (first ? "" : ",\n") + inner + quoted(Json(key)) + ": ";
      append(element, path + "/" + key, depth + 1, text);
      first = false;
    }
    text += "\n" + outer + "}";
  } else if (value.is_array() && !value.empty()) {
    const bool flat = is_flat(value);
    text += flat ? "[" : "[\n";
    for (std::size_t i = 0; i < value.size(); ++i) {
      text += i == 0 ? "" : flat ? ", " : ",\n";
      if (!flat) text += inner;
      append(value[i], path + "/" + std::to_string(i), depth + 1, text);
    }
    text += flat ? "]" : "\n" + outer + "]";
  } else {
    text += value.is_string() ? quoted(value) : value.dump();
  }
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& value) {
  std::string text;
  append(value, "", 0, text);
  text += '\n';
  return text;
}

}  // namespace abbe
