#include <fmt/format.h>

#include "abbe/formats/text/toml_table.h"

namespace abbe {

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (code < 0x20 || code == 0x7F) {
      quoted += fmt::format("\\u{:04X}", code);
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string toml_texts(std::string_view key, const std::vector<std::string>& texts) {
  if (texts.empty()) return "";
  std::string lines = fmt::format("{} = [\n", key);
  for (const std::string& text : texts) lines += fmt::format("  {},\n", toml_string(text));
  return lines + "]\n";
}

std::string toml_angles(std::string_view base, const std::vector<double>& values, bool scalar) {
  std::string line;
  for (const char* suffix : {"deg", "rad"}) {
    const Unit& unit = unit_named(Quantity::angle, suffix);
    std::string list;
    bool same = true;
    for (const double value : values) {
      const std::string text = quantity_text(value, unit);
      double back = 0;
      same = parse_quantity(text, unit, back) == NumberProblem::none && back == value && same;
      list += (list.empty() ? "" : ", ") + text;
    }
    line = scalar ? fmt::format("{}_{} = {}\n", base, suffix, list) : fmt::format("{}_{} = [{}]\n", base, suffix, list);
    if (same) break;
  }
  return line;
}

}  // namespace abbe
