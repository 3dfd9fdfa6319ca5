#include "abbe/formats/controls/table_heidenhain.h"

#include <fmt/format.h>

#include <cassert>

#include "abbe/formats/controls/heidenhain_lines.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
std::string heidenhain_com_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                                double sign) {
  assert(!tables.empty());
  const TableAxisName& input = table_axis(axes, tables.front().input);
  std::string text = fmt::format("BEGIN {}.COM MM\nNR AXISPOS", input.name);
  for (const AxisTable& table : tables) text += " " + table_axis(axes, table.output).name;
  text += "\n";
  for (std::size_t k = 0; k < tables.front().positions.size(); ++k) {
    text += fmt::format("{} {}", k, heidenhain_number(tables.front().positions[k], input.rotary));
    for (const AxisTable& table : tables) {
      text += " " + heidenhain_number(sign * table.forward[k], table_axis(axes, table.output).rotary);
    }
    text += "\n";
  }
  return text + "[END]\n";
}

std::vector<AxisTable> parse_heidenhain_com(std::string_view text, const std::string& file, std::size_t input,
                                            const std::vector<TableAxisName>& axes, double sign) {
  const bool turns = table_axis(axes, input).rotary;
  std::vector<AxisTable> tables;
  std::vector<bool> rotary;
  HeidenhainLines rows(text, file, "BEGIN name.COM MM", "NR AXISPOS and axes");
  const TableLines& lines = rows.lines();
  const std::vector<std::string_view> columns = words_of(lines.line());
  if (columns.size() < 3 || columns[0] != "NR" || columns[1] != "AXISPOS") {
    lines.fail("columns", "not understood", "NR AXISPOS and at least one axis");
  }
  for (std::size_t c = 2; c < columns.size(); ++c) {
    const TableAxisName* const axis = find_table_axis(axes, columns[c]);
    if (axis == nullptr) {
      lines.fail("columns", fmt::format("unknown column '{}'", shown_word(columns[c])), table_axis_words(axes));
    }
    for (const AxisTable& table : tables) {
      if (table.output == axis->axis) lines.fail("columns", "an axis is named twice", "every axis once");
    }
    AxisTable table;
    table.input = input;
    table.output = axis->axis;
    tables.push_back(std::move(table));
    rotary.push_back(axis->rotary);
  }
  while (rows.next()) {
    const std::vector<std::string_view> words = words_of(rows.line());
    if (words.size() != columns.size()) {
      lines.fail("row", fmt::format("{} fields", words.size()), fmt::format("{} fields", columns.size()));
    }
    rows.check_number(words[0], tables.front().positions.size(), kHeidenhainPoints);
    const double position = inside_position(lines.value(words[1], "AXISPOS", turns ? "degrees" : "mm"), turns);
    for (std::size_t t = 0; t < tables.size(); ++t) {
      AxisTable& table = tables[t];
      if (!table.positions.empty() && !(position > table.positions.back())) {
        lines.fail("AXISPOS", "is not above the one before", "increasing positions");
      }
      table.positions.push_back(position);
      const double value = lines.value(words[t + 2], std::string(columns[t + 2]), rotary[t] ? "degrees" : "mm");
      table.forward.push_back(sign * inside_position(value, rotary[t]));
      table.reverse.push_back(table.forward.back());
    }
  }
  rows.check_end(tables.front().positions.size());
  return tables;
}

std::string heidenhain_assignment_text(const std::vector<HeidenhainAssignment>& tables) {
  std::string columns = "NR ACTIVE", files = "0 *";
  for (const HeidenhainAssignment& table : tables) {
    columns += " " + table.column;
    files += " " + table.file;
  }
  return "BEGIN CONFIG.CMA MM\n" + columns + "\n" + files + "\n[END]\n";
}

}  // namespace abbe
