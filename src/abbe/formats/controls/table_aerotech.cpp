#include "abbe/formats/controls/table_aerotech.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <optional>

#include "abbe/formats/controls/aerotech_lines.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kValuesPerLine = 6;
constexpr std::size_t kMostAerotechValues = 20'000'000;
constexpr const char* kNumberInUnit = "a number in the unit of the axis (mm, degrees)";

std::string correction_word(double value, bool rotary) {
  return trimmed_decimals(shown_position(value, rotary), rotary ? 9 : 7);
}

double even_step(const std::vector<double>& positions) {
  assert(positions.size() > 1);
  return (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
}

/// "SAMPLEDIST=20 OFFSET=400"
std::string placed(const char* step_name, const char* offset_name, const std::vector<double>& positions, bool rotary) {
  return fmt::format("{}={} {}={}", step_name, shown_position_text(even_step(positions), rotary), offset_name,
                     shown_position_text(0.0 - positions.front(), rotary));
}

/// What both kinds of tables have.
struct AerotechTable {
  std::size_t line = 0;  ///< 0: no table is begun
  AerotechUnit position, correction;
  bool negated = false;
  std::vector<double> values;
};

void refuse_repeated_key(const TableLines& lines, const std::string& key, bool given) {
  if (given) lines.fail(key, "is given twice", "one value");
}

/// Keys that both kinds of tables have. @returns whether it was one
bool read_common_key(const TableLines& lines, const std::string& key, const std::string* value, AerotechTable& table) {
  if (key == "POSUNIT" || key == "CORUNIT") {
    AerotechUnit& unit = key == "POSUNIT" ? table.position : table.correction;
    refuse_repeated_key(lines, key, unit.given);
    unit = aerotech_unit(lines, key, value);
  } else if (key == "NEGCOR" && value == nullptr) {
    table.negated = true;
  } else {
    return false;
  }
  return true;
}

void read_values(const TableLines& lines, const AerotechLine& line, AerotechTable& table) {
  if (table.line == 0) lines.fail("correction", "stands outside a table", ":START before it");
  if (table.values.size() + line.words.size() > kMostAerotechValues) {
    lines.fail("correction", "too many values", fmt::format("at most {}", kMostAerotechValues));
  }
  for (const std::string& word : line.words) table.values.push_back(lines.value(word, "correction", kNumberInUnit));
}

[[noreturn]] void fail_in_table(const std::string& file, const AerotechTable& table, const std::string& field,
                                const std::string& problem, const std::string& expected) {
  throw InputError({.file = file, .line = table.line, .field = field}, problem, expected);
}

void check_units(const std::string& file, const AerotechTable& table, bool rotary_positions, bool rotary_corrections) {
  if ((table.position.millimetres && rotary_positions) || (table.correction.millimetres && rotary_corrections)) {
    fail_in_table(file, table, "POSUNIT, CORUNIT", "METRIC for a rotary axis", "PRIMARY: degrees");
  }
}

/// Increasing positions of one axis of a table, that a double keeps apart. @throws InputError
std::vector<double> checked_positions(const std::string& file, const AerotechTable& table, const std::string& field,
                                      double step, double offset, std::size_t count, bool rotary) {
  if (count < 2) fail_in_table(file, table, field, fmt::format("{} places", count), "two places or more");
  std::vector<double> positions = aerotech_positions(step, offset, count, table.position.per_unit, rotary);
  if (std::adjacent_find(positions.begin(), positions.end(), std::greater_equal<>()) != positions.end()) {
    fail_in_table(file, table, field, "places too close together", "a step that increases the position");
  }
  return positions;
}

/// Tables one after the other; `start` reads a line with :START, `end` makes a table.
void read_tables(std::string_view text, const std::string& file, std::string_view keyword,
                 const std::function<AerotechTable&()>& table,
                 const std::function<void(const TableLines&, const AerotechLine&)>& start,
                 const std::function<void()>& end) {
  TableLines lines(text, file);
  AerotechLine line;
  bool any = false;
  while (next_aerotech_line(lines, keyword, line)) {
    switch (line.kind) {
      case AerotechLine::Kind::start:
        if (!table().values.empty()) lines.fail(std::string(keyword), "stands between corrections", ":END before it");
        start(lines, line);
        any = true;
        break;
      case AerotechLine::Kind::end:
        if (table().line == 0) lines.fail(":END", "ends no table", std::string(keyword) + " before it");
        end();
        break;
      case AerotechLine::Kind::numbers:
        read_values(lines, line, table());
        break;
    }
  }
  if (table().line != 0) fail_in_table(file, table(), std::string(keyword), "the table has no end", ":END");
  if (!any) throw InputError({.file = file}, "no tables", std::string(keyword));
}

void set_aerotech_number(const TableLines& lines, const std::string& key, const std::string* value,
                         std::optional<double>& number) {
  refuse_repeated_key(lines, key, number.has_value());
  number = lines.value(aerotech_value(lines, key, value), key, kNumberInUnit);
}

struct LineRead : AerotechTable {
  const TableAxisName* output = nullptr;
  const TableAxisName* input = nullptr;
  std::optional<double> step, offset;
};

void start_line(const TableLines& lines, const AerotechLine& line, const std::vector<TableAxisName>& axes,
                LineRead& table) {
  std::size_t first = 0;
  if (table.line == 0) {
    table.line = lines.number();
    if (line.words.empty()) lines.fail(":START", "names no axis", "the number of the corrected axis");
    table.output = aerotech_axis(lines, ":START", line.words[0], axes);
    first = 1;
  }
  read_aerotech_keys(line, first, [&](const std::string& key, const std::string* value) {
    if (read_common_key(lines, key, value, table)) return;
    if (key == "MASTER") {
      refuse_repeated_key(lines, key, table.input != nullptr);
      table.input = aerotech_axis(lines, key, aerotech_value(lines, key, value), axes);
    } else if (key == "SAMPLEDIST") {
      set_aerotech_number(lines, key, value, table.step);
    } else if (key == "OFFSET") {
      set_aerotech_number(lines, key, value, table.offset);
    } else {
      lines.fail(key, "is not read", "MASTER, POSUNIT, CORUNIT, SAMPLEDIST, OFFSET or NEGCOR");
    }
  });
}

AxisTable line_table(const std::string& file, const LineRead& read) {
  if (!read.step) fail_in_table(file, read, "SAMPLEDIST", "is missing", "the distance of the corrections");
  AxisTable table;
  const TableAxisName& input = read.input == nullptr ? *read.output : *read.input;
  check_units(file, read, input.rotary, read.output->rotary);
  table.input = input.axis;
  table.output = read.output->axis;
  table.positions = checked_positions(file, read, "SAMPLEDIST", *read.step, read.offset.value_or(0), read.values.size(),
                                      input.rotary);
  for (const double value : read.values) {
    const double correction = inside_position(value / read.correction.per_unit, read.output->rotary);
    table.forward.push_back(read.negated ? -correction : correction);
  }
  if (*read.step < 0) std::reverse(table.forward.begin(), table.forward.end());
  table.reverse = table.forward;
  return table;
}

struct PlaneRead : AerotechTable {
  const TableAxisName* row = nullptr;
  const TableAxisName* column = nullptr;
  std::vector<const TableAxisName*> outputs;
  double row_step = 0, column_step = 0;
  std::size_t columns = 0;
  std::optional<double> row_offset, column_offset;
};

void add_output(const TableLines& lines, const std::string& field, std::string_view name,
                const std::vector<TableAxisName>& axes, PlaneRead& table) {
  const TableAxisName* const axis = aerotech_axis(lines, field, name, axes);
  if (std::find(table.outputs.begin(), table.outputs.end(), axis) != table.outputs.end()) {
    lines.fail(field, "an axis is corrected twice", "every axis once");
  }
  table.outputs.push_back(axis);
}

void start_plane(const TableLines& lines, const AerotechLine& line, const std::vector<TableAxisName>& axes,
                 PlaneRead& table) {
  constexpr std::size_t kNumbers = 7;
  std::size_t first = 0;
  if (table.line == 0) {
    table.line = lines.number();
    if (line.words.size() < kNumbers) {
      lines.fail(":START2D", fmt::format("{} of {} numbers", line.words.size(), kNumbers),
                 "RowAxis ColumnAxis OutputAxis1 OutputAxis2 SampDistRow SampDistCol NumCols");
    }
    table.row = aerotech_axis(lines, "RowAxis", line.words[0], axes);
    table.column = aerotech_axis(lines, "ColumnAxis", line.words[1], axes);
    if (table.row == table.column) lines.fail("ColumnAxis", "is the row axis", "another axis");
    add_output(lines, "OutputAxis1", line.words[2], axes, table);
    add_output(lines, "OutputAxis2", line.words[3], axes, table);
    table.row_step = lines.value(line.words[4], "SampDistRow", kNumberInUnit);
    table.column_step = lines.value(line.words[5], "SampDistCol", kNumberInUnit);
    table.columns = lines.whole(line.words[6], "NumCols", 2, kMostAerotechValues);
    first = kNumbers;
  }
  read_aerotech_keys(line, first, [&](const std::string& key, const std::string* value) {
    if (read_common_key(lines, key, value, table)) return;
    if (key == "OUTAXIS3") {
      refuse_repeated_key(lines, key, table.outputs.size() > 2);
      add_output(lines, key, aerotech_value(lines, key, value), axes, table);
    } else if (key == "OFFSETROW") {
      set_aerotech_number(lines, key, value, table.row_offset);
    } else if (key == "OFFSETCOL") {
      set_aerotech_number(lines, key, value, table.column_offset);
    } else if (key == "SERIALNUMBER") {
      aerotech_value(lines, key, value);
    } else {
      lines.fail(key, "is not read", "OUTAXIS3, POSUNIT, CORUNIT, OFFSETROW, OFFSETCOL, NEGCOR or SERIALNUMBER");
    }
  });
}

CorrectionLattice plane_table(const std::string& file, const PlaneRead& read) {
  const std::size_t outputs = read.outputs.size(), row_length = outputs * read.columns;
  if (read.values.size() % row_length != 0) {
    fail_in_table(file, read, "NumCols", fmt::format("{} corrections for {} columns", read.values.size(), read.columns),
                  fmt::format("a multiple of {}: {} per column", row_length, outputs));
  }
  const std::size_t rows = read.values.size() / row_length;
  CorrectionLattice lattice;
  lattice.inputs = {read.column->axis, read.row->axis};
  lattice.modulo = {false, false};
  lattice.positions = {
      checked_positions(file, read, "SampDistCol", read.column_step, read.column_offset.value_or(0), read.columns,
                        read.column->rotary),
      checked_positions(file, read, "SampDistRow", read.row_step, read.row_offset.value_or(0), rows, read.row->rotary)};
  for (std::size_t o = 0; o < outputs; ++o) {
    const TableAxisName& output = *read.outputs[o];
    check_units(file, read, read.row->rotary || read.column->rotary, output.rotary);
    lattice.outputs.push_back(output.axis);
    std::vector<double>& corrections = lattice.corrections.emplace_back();
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < read.columns; ++c) {
        // Positions increase, whatever way the file counts them.
        const std::size_t row = read.row_step < 0 ? rows - 1 - r : r;
        const std::size_t column = read.column_step < 0 ? read.columns - 1 - c : c;
        const double value = read.values[row * row_length + column * outputs + o] / read.correction.per_unit;
        corrections.push_back(inside_position(read.negated ? -value : value, output.rotary));
      }
    }
  }
  return lattice;
}

}  // namespace

std::string aerotech_1d_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes) {
  std::string text;
  for (const AxisTable& table : tables) {
    const TableAxisName& input = table_axis(axes, table.input);
    const TableAxisName& output = table_axis(axes, table.output);
    text += ":START " + output.name;
    if (table.input != table.output) text += " MASTER=" + input.name;
    text += " POSUNIT=PRIMARY CORUNIT=PRIMARY " + placed("SAMPLEDIST", "OFFSET", table.positions, input.rotary) + "\n";
    for (std::size_t k = 0; k < table.forward.size(); ++k) {
      const bool ends = k % kValuesPerLine == kValuesPerLine - 1 || k + 1 == table.forward.size();
      text += correction_word(table.forward[k], output.rotary) + (ends ? "\n" : " ");
    }
    text += ":END\n";
  }
  return text;
}

std::vector<AxisTable> parse_aerotech_1d(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes) {
  std::vector<AxisTable> tables;
  LineRead read;
  read_tables(
      text, file, ":START", [&]() -> AerotechTable& { return read; },
      [&](const TableLines& lines, const AerotechLine& line) { start_line(lines, line, axes, read); },
      [&] {
        tables.push_back(line_table(file, read));
        read = LineRead();
      });
  return tables;
}

std::string aerotech_2d_text(const std::vector<CorrectionLattice>& tables, const std::vector<TableAxisName>& axes) {
  std::string text;
  for (const CorrectionLattice& table : tables) {
    assert(table.inputs.size() == 2 && (table.outputs.size() == 2 || table.outputs.size() == 3));
    const TableAxisName& column = table_axis(axes, table.inputs[0]);
    const TableAxisName& row = table_axis(axes, table.inputs[1]);
    const std::vector<double>& columns = table.positions[0];
    const std::vector<double>& rows = table.positions[1];
    text += fmt::format(":START2D {} {} {} {} {} {} {}\n:START2D ", row.name, column.name,
                        table_axis(axes, table.outputs[0]).name, table_axis(axes, table.outputs[1]).name,
                        shown_position_text(even_step(rows), row.rotary),
                        shown_position_text(even_step(columns), column.rotary), columns.size());
    if (table.outputs.size() > 2) text += "OUTAXIS3=" + table_axis(axes, table.outputs[2]).name + " ";
    text += fmt::format("POSUNIT=PRIMARY CORUNIT=PRIMARY OFFSETROW={} OFFSETCOL={}\n",
                        shown_position_text(0.0 - rows.front(), row.rotary),
                        shown_position_text(0.0 - columns.front(), column.rotary));
    for (std::size_t k = 0; k < table.count(); ++k) {
      for (std::size_t o = 0; o < table.outputs.size(); ++o) {
        const bool ends = k % columns.size() == columns.size() - 1 && o + 1 == table.outputs.size();
        text += correction_word(table.corrections[o][k], table_axis(axes, table.outputs[o]).rotary);
        text += ends ? "\n" : " ";
      }
    }
    text += ":END\n";
  }
  return text;
}

std::vector<CorrectionLattice> parse_aerotech_2d(std::string_view text, const std::string& file,
                                                 const std::vector<TableAxisName>& axes) {
  std::vector<CorrectionLattice> tables;
  PlaneRead read;
  read_tables(
      text, file, ":START2D", [&]() -> AerotechTable& { return read; },
      [&](const TableLines& lines, const AerotechLine& line) { start_plane(lines, line, axes, read); },
      [&] {
        tables.push_back(plane_table(file, read));
        read = PlaneRead();
      });
  return tables;
}

}  // namespace abbe
