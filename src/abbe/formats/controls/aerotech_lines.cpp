#include "abbe/formats/controls/aerotech_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

std::string in_upper_case(std::string_view word) {
  std::string upper(word);
  std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) { return upper_case(c); });
  return upper;
}

}  // namespace

bool next_aerotech_line(TableLines& lines, std::string_view start, AerotechLine& found) {
  while (lines.next()) {
    const std::string_view line = lines.line().substr(0, lines.line().find_first_of(";'"));
    std::string spaced;
    for (const char c : line) spaced += c == '=' ? std::string(" = ") : std::string(1, c);
    const std::vector<std::string_view> words = words_of(spaced);
    if (words.empty()) continue;
    found.words.assign(words.begin(), words.end());
    found.kind = AerotechLine::Kind::numbers;
    if (words[0][0] != ':') return true;
    const std::string keyword = in_upper_case(words[0]);
    found.words.erase(found.words.begin());
    if (keyword == start) {
      found.kind = AerotechLine::Kind::start;
    } else if (keyword == ":END" && found.words.empty()) {
      found.kind = AerotechLine::Kind::end;
    } else {
      lines.fail(shown_word(words[0]), "not understood", std::string(start) + " or :END");
    }
    return true;
  }
  return false;
}

void read_aerotech_keys(const AerotechLine& line, std::size_t first, const AerotechKey& read) {
  for (std::size_t i = first; i < line.words.size(); ++i) {
    const std::string key = in_upper_case(line.words[i]);
    if (i + 1 >= line.words.size() || line.words[i + 1] != "=") {
      read(key, nullptr);
      continue;
    }
    const std::string value = i + 2 < line.words.size() ? line.words[i + 2] : "";
    read(key, &value);
    i += 2;
  }
}

AerotechUnit aerotech_unit(const TableLines& lines, const std::string& field, const std::string* word) {
  const std::string expected = "PRIMARY or METRIC, perhaps divided by a number: PRIMARY/1000";
  const std::string unit = in_upper_case(aerotech_value(lines, field, word));
  const std::size_t slash = std::min(unit.find('/'), unit.size());
  const std::string name = unit.substr(0, slash);
  AerotechUnit found;
  found.given = true;
  found.millimetres = name == "METRIC";
  if (!found.millimetres && name != "PRIMARY") {
    lines.fail(field, fmt::format("unknown unit '{}'", shown_word(name)), expected);
  }
  if (slash == unit.size()) return found;
  found.per_unit = lines.value(unit.substr(slash + 1), field, expected);
  if (!(found.per_unit >= 1e-6 && found.per_unit <= 1e9)) lines.fail(field, "out of range", "1e-6 to 1e9 behind /");
  return found;
}

const std::string& aerotech_value(const TableLines& lines, const std::string& field, const std::string* word) {
  if (word == nullptr || word->empty()) lines.fail(field, "has no value", field + "=value");
  return *word;
}

const TableAxisName* aerotech_axis(const TableLines& lines, const std::string& field, std::string_view name,
                                   const std::vector<TableAxisName>& axes) {
  const TableAxisName* const axis = find_table_axis(axes, name);
  if (axis == nullptr) lines.fail(field, fmt::format("unknown axis '{}'", shown_word(name)), table_axis_words(axes));
  return axis;
}

std::vector<double> aerotech_positions(double step, double offset, std::size_t count, double per_unit, bool rotary) {
  std::vector<double> positions;
  for (std::size_t k = 0; k < count; ++k) {
    positions.push_back(inside_position((static_cast<double>(k) * step - offset) / per_unit, rotary));
  }
  if (step < 0) std::reverse(positions.begin(), positions.end());
  return positions;
}

}  // namespace abbe
