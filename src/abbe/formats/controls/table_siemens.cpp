#include "abbe/formats/controls/table_siemens.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "abbe/formats/nc/siemens_assignments.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr std::size_t kMostPoints = 100000;  // of one table; controls have far fewer
constexpr std::size_t kMostTables = 1000;

std::string compensation_text(double value, bool rotary) {
  return trimmed_decimals(shown_position(value, rotary), rotary ? 7 : 6);
}

/// A table as a file of either kind says it, in the file's units.
struct Read {
  std::map<std::size_t, double> values;
  std::optional<double> step, from, to;
  const TableAxisName* input = nullptr;
  const TableAxisName* output = nullptr;
  int direction = 0;
  bool modulo = false;
  std::size_t line = 0;
};

void set_once(const TableLines& lines, const std::string& field, std::string_view text, std::optional<double>& value) {
  if (value) lines.fail(field, "is given twice", "one value");
  value = lines.value(text, field, "a number in mm, of rotary axes in degrees");
}

void set_point(const TableLines& lines, const std::string& field, std::string_view index, std::string_view text,
               Read& table) {
  const std::size_t point = lines.whole(index, field, 0, kMostPoints - 1);
  const double value = lines.value(text, field, "a number in mm, of rotary axes in degrees");
  if (!table.values.emplace(point, value).second) lines.fail(field, "is given twice", "one value per point");
}

bool flag(const TableLines& lines, const std::string& field, std::string_view text) {
  return lines.whole(text, field, 0, 1) == 1;
}

/// @param factor  correction = factor * value
AxisTable table_of(const Read& read, const std::string& file, const std::string& name, double factor) {
  const auto fail = [&](const std::string& problem, const std::string& expected) {
    throw InputError({.file = file, .line = read.line, .field = name}, problem, expected);
  };
  if (read.input == nullptr || read.output == nullptr) fail("an axis is missing", "input and output axis");
  if (!read.step || !read.from || !read.to) fail("step or ends are missing", "_STEP, _MIN and _MAX");
  if (read.values.empty()) fail("no values", "a value per point");
  if (read.values.rbegin()->first + 1 != read.values.size()) {
    fail(fmt::format("{} values for points 0 to {}", read.values.size(), read.values.rbegin()->first),
         "a value for every point");
  }
  const double length = *read.to - *read.from;
  const double intervals = static_cast<double>(read.values.size() - 1);
  // The step is written in digits: their rounding adds up.
  const double slack = 1e-6 * (1 + intervals);
  if (read.values.size() < 2 || !(*read.step > 0) || !(std::abs(*read.step * intervals - length) <= slack)) {
    fail(fmt::format("{} points from {} to {} in steps of {}", read.values.size(), *read.from, *read.to, *read.step),
         "a last point at _MAX");
  }
  AxisTable table;
  table.input = read.input->axis;
  table.output = read.output->axis;
  table.modulo = read.modulo;
  for (const auto& [point, value] : read.values) {
    const double position = *read.from + length * (static_cast<double>(point) / intervals);
    table.positions.push_back(inside_position(position, read.input->rotary));
    if (table.positions.size() > 1 && !(table.positions.back() > table.positions[table.positions.size() - 2])) {
      fail("points too close together", "increasing positions");
    }
    const double correction = factor * inside_position(value, read.output->rotary);
    table.forward.push_back(read.direction >= 0 ? correction : 0.0);
    table.reverse.push_back(read.direction <= 0 ? correction : 0.0);
  }
  return table;
}

const TableAxisName* axis_named(const TableLines& lines, const std::string& field, std::string_view name,
                                const std::vector<TableAxisName>& axes) {
  const TableAxisName* const axis = find_table_axis(axes, name);
  if (axis == nullptr) lines.fail(field, fmt::format("unknown axis '{}'", shown_word(name)), table_axis_words(axes));
  return axis;
}

}  // namespace

std::string siemens_cec_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                             std::size_t first_table) {
  std::string text = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  std::size_t number = first_table;
  const auto add = [&](const AxisTable& table, const std::vector<double>& values, int direction) {
    const TableAxisName& input = table_axis(axes, table.input);
    const TableAxisName& output = table_axis(axes, table.output);
    for (std::size_t k = 0; k < values.size(); ++k) {
      text += fmt::format("$AN_CEC[{},{}]={}\n", number, k, compensation_text(values[k], output.rotary));
    }
    const double last = static_cast<double>(table.positions.size() - 1);
    const double step = (table.positions.back() - table.positions.front()) / last;
    text += fmt::format("$AN_CEC_INPUT_AXIS[{}]=({})\n$AN_CEC_OUTPUT_AXIS[{}]=({})\n", number, input.name, number,
                        output.name);
    text += fmt::format("$AN_CEC_STEP[{}]={}\n$AN_CEC_MIN[{}]={}\n$AN_CEC_MAX[{}]={}\n", number,
                        shown_position_text(step, input.rotary), number,
                        shown_position_text(table.positions.front(), input.rotary), number,
                        shown_position_text(table.positions.back(), input.rotary));
    text += fmt::format("$AN_CEC_DIRECTION[{}]={}\n$AN_CEC_MULT_BY_TABLE[{}]=0\n$AN_CEC_IS_MODULO[{}]={}\n", number,
                        direction, number, number, table.modulo ? 1 : 0);
    ++number;
  };
  for (const AxisTable& table : tables) {
    if (table.forward == table.reverse) {
      add(table, table.forward, 0);
    } else {
      add(table, table.forward, 1);
      add(table, table.reverse, -1);
    }
  }
  return text + "M17\n";
}

std::vector<AxisTable> parse_siemens_cec(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes) {
  std::map<std::size_t, Read> read;
  TableLines lines(text, file);
  SiemensAssignment found;
  while (next_siemens_assignment(lines, found)) {
    if (found.indices.size() != (found.name == "$AN_CEC" ? 2U : 1U)) {
      lines.fail(found.name, fmt::format("{} indices", found.indices.size()),
                 "$AN_CEC[table,point] or $AN_CEC_...[table]");
    }
    Read& table = read[lines.whole(found.indices[0], found.name, 0, kMostTables - 1)];
    if (table.line == 0) table.line = lines.number();
    if (found.name == "$AN_CEC") {
      set_point(lines, found.name, found.indices[1], found.value, table);
    } else if (found.name == "$AN_CEC_INPUT_AXIS") {
      table.input = axis_named(lines, found.name, found.value, axes);
    } else if (found.name == "$AN_CEC_OUTPUT_AXIS") {
      table.output = axis_named(lines, found.name, found.value, axes);
    } else if (found.name == "$AN_CEC_STEP") {
      set_once(lines, found.name, found.value, table.step);
    } else if (found.name == "$AN_CEC_MIN") {
      set_once(lines, found.name, found.value, table.from);
    } else if (found.name == "$AN_CEC_MAX") {
      set_once(lines, found.name, found.value, table.to);
    } else if (found.name == "$AN_CEC_DIRECTION") {
      const double direction = lines.value(found.value, found.name, "0, 1 or -1");
      if (direction != 0 && direction != 1 && direction != -1) lines.fail(found.name, "out of range", "0, 1 or -1");
      table.direction = static_cast<int>(direction);
    } else if (found.name == "$AN_CEC_MULT_BY_TABLE") {
      if (lines.whole(found.value, found.name, 0, kMostTables) != 0) {
        lines.fail(found.name, "products of tables are not read", "0");
      }
    } else if (found.name == "$AN_CEC_IS_MODULO") {
      table.modulo = flag(lines, found.name, found.value);
    } else {
      lines.fail(found.name, "unknown name", "$AN_CEC or $AN_CEC_...");
    }
  }
  if (read.empty()) throw InputError({.file = file}, "no tables", "$AN_CEC[table,point] = value");
  std::vector<AxisTable> tables;
  for (const auto& [index, table] : read) {
    tables.push_back(table_of(table, file, fmt::format("$AN_CEC[{}]", index), 1));
  }
  return tables;
}

std::string siemens_eec_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                             std::size_t encoder) {
  std::string text = "%_N_AX_EEC_INI\nCHANDATA(1)\n";
  for (const AxisTable& table : tables) {
    const TableAxisName& axis = table_axis(axes, table.input);
    const std::string place = fmt::format("{},{}", encoder, axis.name);
    for (std::size_t k = 0; k < table.forward.size(); ++k) {
      // One table serves both directions; BACKLASH is another parameter of the control.
      const double error = -0.5 * (table.forward[k] + table.reverse[k]);
      text += fmt::format("$AA_ENC_COMP[{},{},{}]={}\n", encoder, k, axis.name, compensation_text(error, axis.rotary));
    }
    const double last = static_cast<double>(table.positions.size() - 1);
    const double step = (table.positions.back() - table.positions.front()) / last;
    text += fmt::format("$AA_ENC_COMP_STEP[{}]={}\n$AA_ENC_COMP_MIN[{}]={}\n$AA_ENC_COMP_MAX[{}]={}\n", place,
                        shown_position_text(step, axis.rotary), place,
                        shown_position_text(table.positions.front(), axis.rotary), place,
                        shown_position_text(table.positions.back(), axis.rotary));
    text += fmt::format("$AA_ENC_COMP_IS_MODULO[{}]={}\n", place, table.modulo ? 1 : 0);
  }
  return text + "M17\n";
}

std::vector<AxisTable> parse_siemens_eec(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes) {
  std::map<std::pair<std::size_t, std::size_t>, Read> read;  // by axis and encoder
  TableLines lines(text, file);
  SiemensAssignment found;
  while (next_siemens_assignment(lines, found)) {
    const bool point = found.name == "$AA_ENC_COMP";
    if (found.indices.size() != (point ? 3U : 2U)) {
      lines.fail(found.name, fmt::format("{} indices", found.indices.size()),
                 "$AA_ENC_COMP[encoder,point,axis] or $AA_ENC_COMP_...[encoder,axis]");
    }
    const TableAxisName* const axis = axis_named(lines, found.name, found.indices.back(), axes);
    Read& table = read[{axis->axis, lines.whole(found.indices[0], found.name, 0, 1)}];
    if (table.line == 0) table.line = lines.number();
    table.input = table.output = axis;
    if (point) {
      set_point(lines, found.name, found.indices[1], found.value, table);
    } else if (found.name == "$AA_ENC_COMP_STEP") {
      set_once(lines, found.name, found.value, table.step);
    } else if (found.name == "$AA_ENC_COMP_MIN") {
      set_once(lines, found.name, found.value, table.from);
    } else if (found.name == "$AA_ENC_COMP_MAX") {
      set_once(lines, found.name, found.value, table.to);
    } else if (found.name == "$AA_ENC_COMP_IS_MODULO") {
      table.modulo = flag(lines, found.name, found.value);
    } else {
      lines.fail(found.name, "unknown name", "$AA_ENC_COMP or $AA_ENC_COMP_...");
    }
  }
  if (read.empty()) throw InputError({.file = file}, "no tables", "$AA_ENC_COMP[encoder,point,axis] = value");
  std::vector<AxisTable> tables;
  for (const auto& [key, table] : read) {
    tables.push_back(table_of(table, file, fmt::format("$AA_ENC_COMP of {}", table.input->name), -1));
  }
  return tables;
}

}  // namespace abbe
