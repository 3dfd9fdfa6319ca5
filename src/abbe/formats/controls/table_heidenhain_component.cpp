#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "abbe/formats/controls/table_heidenhain.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

std::string number_of_component(double value, bool rotary) {
  return fixed_number(shown_position(value, rotary), rotary ? 7 : 6);
}

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
    text += fmt::format("{} {}", k, number_of_component(positions[k], axis.rotary));
    for (const Column& column : columns) {
      text += " " + number_of_component(column.sign * column.table->forward[k], column.rotary);
    }
    text += "\n";
  }
  return text + "[END]\n";
}

ComponentTable parse_heidenhain_component(std::string_view text, const std::string& file, std::size_t axis,
                                          const std::vector<TableAxisName>& axes, double own_sign, double sign) {
  const TableAxisName& name = table_axis(axes, axis);
  TableLines lines(text, file);
  if (!lines.next() || !lines.line().starts_with("BEGIN ") || words_of(lines.line()).back() != "MM") {
    throw InputError({.file = file, .line = 1}, "no table of a control", "BEGIN name.COM MM");
  }
  if (!lines.next()) throw InputError({.file = file}, "no columns", "NR AXISPOS and columns");
  ComponentTable table;
  table.axis = axis;
  const std::vector<ReadColumn> columns = read_columns(lines, name, own_sign, sign, table);
  const AxisTable& first = *columns.front().table;
  bool ended = false;
  while (lines.next()) {
    const std::vector<std::string_view> words = words_of(lines.line());
    if (words.empty()) continue;
    if (ended) lines.fail("", "text behind [END]", "the end of the file");
    if (words[0] == "[END]") {
      ended = true;
      continue;
    }
    if (words.size() != columns.size() + 2) {
      lines.fail("row", fmt::format("{} fields", words.size()), fmt::format("{} fields", columns.size() + 2));
    }
    if (lines.whole(words[0], "NR", 0, kHeidenhainPoints - 1) != first.positions.size()) {
      lines.fail("NR", "is not the next number", "0, 1, 2 ...");
    }
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
  if (!ended || first.positions.empty()) {
    throw InputError({.file = file}, ended ? "no rows" : "no [END]", "rows, and [END]");
  }
  return table;
}

}  // namespace abbe
