#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "abbe/formats/controls/heidenhain_lines.h"
#include "abbe/formats/controls/table_heidenhain.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

/// A column of the text with the table that it is read into.
struct ReadColumn {
  AxisTable* table;
  std::string name;
  bool rotary;
  double sign;
};

/// The column of that name in `table`, made anew.
ReadColumn read_column(const TableLines& lines, std::string_view name, const TableAxisName& axis, double own_sign,
                       double sign, ComponentTable& table) {
  std::optional<AxisTable>* place = nullptr;
  ReadColumn column{nullptr, std::string(name), axis.rotary, own_sign};
  if (name == axis.name) {
    place = &table.own;
  } else if (name.size() == 2 && name[0] == 'C' && name[1] >= '1' && name[1] <= '6') {
    const auto index = static_cast<std::size_t>(name[1] - '1');
    place = &table.columns.at(index);
    column.rotary = index >= 3;
    column.sign = sign;
  } else {
    lines.fail("columns", fmt::format("unknown column '{}'", shown_word(name)),
               fmt::format("{} (the axis itself) or C1 to C6", axis.name));
  }
  if (*place) lines.fail("columns", fmt::format("{} is there twice", shown_word(name)), "every column once");
  column.table = &place->emplace();
  column.table->input = column.table->output = table.axis;
  return column;
}

std::vector<ReadColumn> read_columns(const TableLines& lines, const TableAxisName& axis, double own_sign, double sign,
                                     ComponentTable& table) {
  const std::vector<std::string_view> names = words_of(lines.line());
  if (names.size() < 3 || names[0] != "NR" || names[1] != "AXISPOS") {
    lines.fail("columns", "not understood", "NR AXISPOS and at least one column");
  }
  std::vector<ReadColumn> columns;
  for (std::size_t c = 2; c < names.size(); ++c) {
    columns.push_back(read_column(lines, names[c], axis, own_sign, sign, table));
  }
  return columns;
}

}  // namespace

std::string heidenhain_component_text(const ComponentTable& table, const std::string& file,
                                      const std::vector<TableAxisName>& axes, double own_sign, double sign) {
  const TableAxisName& axis = table_axis(axes, table.axis);
  struct Column {
    const AxisTable* table;
    bool rotary;
    double sign;
  };
  std::vector<Column> columns;
  std::string text = fmt::format("BEGIN {} MM\nNR AXISPOS", file);
  if (table.own) {
    columns.push_back({&*table.own, axis.rotary, own_sign});
    text += " " + axis.name;
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (!table.columns.at(c)) continue;
    columns.push_back({&*table.columns.at(c), c >= 3, sign});
    text += fmt::format(" C{}", c + 1);
  }
  assert(!columns.empty());
  text += "\n";
  const std::vector<double>& positions = columns.front().table->positions;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    text += fmt::format("{} {}", k, heidenhain_number(positions[k], axis.rotary));
    for (const Column& column : columns) {
      text += " " + heidenhain_number(column.sign * column.table->forward[k], column.rotary);
    }
    text += "\n";
  }
  return text + "[END]\n";
}

ComponentTable parse_heidenhain_component(std::string_view text, const std::string& file, std::size_t axis,
                                          const std::vector<TableAxisName>& axes, double own_sign, double sign) {
  const TableAxisName& name = table_axis(axes, axis);
  HeidenhainLines rows(text, file, "BEGIN name.COM MM", "NR AXISPOS and columns");
  const TableLines& lines = rows.lines();
  ComponentTable table;
  table.axis = axis;
  const std::vector<ReadColumn> columns = read_columns(lines, name, own_sign, sign, table);
  const AxisTable& first = *columns.front().table;
  while (rows.next()) {
    const std::vector<std::string_view> words = words_of(rows.line());
    if (words.size() != columns.size() + 2) {
      lines.fail("row", fmt::format("{} fields", words.size()), fmt::format("{} fields", columns.size() + 2));
    }
    rows.check_number(words[0], first.positions.size(), kHeidenhainPoints);
    const double position =
        inside_position(lines.value(words[1], "AXISPOS", name.rotary ? "degrees" : "mm"), name.rotary);
    if (!first.positions.empty() && !(position > first.positions.back())) {
      lines.fail("AXISPOS", "is not above the one before", "increasing positions");
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const ReadColumn& column = columns[c];
      const double value = lines.value(words[c + 2], column.name, column.rotary ? "degrees" : "mm");
      column.table->positions.push_back(position);
      column.table->forward.push_back(column.sign * inside_position(value, column.rotary));
      column.table->reverse.push_back(column.table->forward.back());
    }
  }
  rows.check_end(first.positions.size());
  return table;
}

}  // namespace abbe
