#include "abbe/formats/controls/table_volumetric.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

std::string error_text(double value, bool is_angle) { return fixed_number(value, is_angle ? 12 : 9); }

/// An error by its name in these files: "EXY" of a motion, "C0B" of a location.
struct NamedError {
  std::size_t axis = 0;
  Component component = Component::X;
  bool is_location = false;
};

bool component_of(char letter, Component& component) {
  const std::size_t index = std::string_view("XYZABC").find(letter);
  if (index == std::string_view::npos) return false;
  component = static_cast<Component>(index);
  return true;
}

bool parse_name(std::string_view name, const std::vector<TableAxisName>& axes, NamedError& error) {
  if (name.size() < 3) return false;
  error.is_location = name[1] == '0';
  if (!error.is_location && name[0] != 'E') return false;
  if (!component_of(name[error.is_location ? 0 : 1], error.component)) return false;
  const TableAxisName* const axis = find_table_axis(axes, name.substr(2));
  if (axis == nullptr) return false;
  error.axis = axis->axis;
  return true;
}

std::string motion_name(Component component, const TableAxisName& axis) {
  return fmt::format("E{}{}", component_letter(component), axis.name);
}
std::string location_name(const LocationError& location, const std::vector<TableAxisName>& axes) {
  return fmt::format("{}0{}", component_letter(location.component), table_axis(axes, location.axis).name);
}

std::string_view without_comment(std::string_view line) { return without_blanks(line.substr(0, line.find("//"))); }

/// Names of errors that were given already.
class GivenOnce {
 public:
  void add(const TableLines& lines, std::string_view name) {
    if (!given_.insert(std::string(name)).second) {
      lines.fail(std::string(name), "is given twice", "every error once");
    }
  }

 private:
  std::set<std::string> given_;
};

/// A block of ISG_CSV as it is being read.
struct ErrorBlock {
  const TableAxisName* axis = nullptr;  ///< null: position errors
  std::vector<NamedError> errors;
  std::vector<std::string> names;
  std::vector<double> positions;
  std::vector<std::vector<double>> values;
  std::size_t line = 0;
};

ErrorBlock block_of(const TableLines& lines, const std::vector<std::string_view>& header,
                    const std::vector<TableAxisName>& axes, GivenOnce& given) {
  ErrorBlock block;
  block.line = lines.number();
  for (const std::string_view name : header) {
    if (const TableAxisName* const axis = find_table_axis(axes, name)) {
      if (block.axis != nullptr) {
        lines.fail(std::string(shown_word(name)), "a second argument", "errors of one axis's position");
      }
      if (!block.errors.empty()) lines.fail(axis->name, "stands behind an error", "the axis in the first column");
      block.axis = axis;
      continue;
    }
    NamedError error;
    if (!parse_name(name, axes, error)) {
      lines.fail(shown_word(name), "unknown column",
                 "an axis, an error motion such as EXX or a position error such as C0Y of " + table_axis_words(axes));
    }
    given.add(lines, name);
    block.errors.push_back(error);
    block.names.emplace_back(name);
  }
  if (block.errors.empty()) lines.fail("header", "no errors", "names such as X EXX EYX");
  for (std::size_t c = 0; c < block.errors.size(); ++c) {
    const NamedError& error = block.errors[c];
    const bool here = block.axis == nullptr ? error.is_location : !error.is_location && error.axis == block.axis->axis;
    if (!here) lines.fail(block.names[c], "does not belong into this block", "errors of the axis in the first column");
  }
  block.values.resize(block.errors.size());
  return block;
}

void add_row(const TableLines& lines, const std::vector<std::string_view>& words, ErrorBlock& block) {
  const std::size_t columns = block.errors.size() + (block.axis != nullptr ? 1 : 0);
  if (words.size() != columns) {
    lines.fail("row", fmt::format("{} fields", words.size()), fmt::format("{} fields as in the header", columns));
  }
  std::size_t at = 0;
  if (block.axis != nullptr) {
    const double shown = lines.value(words[at++], block.axis->name, block.axis->rotary ? "degrees" : "mm");
    const double position = inside_position(shown, block.axis->rotary);
    if (!block.positions.empty() && !(position > block.positions.back())) {
      lines.fail(block.axis->name, "is not above the one before", "increasing positions");
    }
    block.positions.push_back(position);
  } else if (!block.values.front().empty()) {
    lines.fail("row", "a second row of position errors", "one row");
  }
  for (std::size_t c = 0; c < block.errors.size(); ++c) {
    block.values[c].push_back(lines.value(words[at + c], block.names[c], "mm or rad"));
  }
}

void finish(const ErrorBlock& block, const std::string& file, ErrorTables& tables) {
  if (block.errors.empty()) return;
  if (block.values.front().empty()) {
    throw InputError({.file = file, .line = block.line}, "a header without rows", "a row per position");
  }
  if (block.axis == nullptr) {
    for (std::size_t c = 0; c < block.errors.size(); ++c) {
      tables.locations.push_back({block.errors[c].axis, block.errors[c].component, block.values[c].front(), 0});
    }
    return;
  }
  ErrorTable table;
  table.axis = block.axis->axis;
  table.positions = block.positions;
  for (const NamedError& error : block.errors) table.components.push_back(error.component);
  table.values = block.values;
  tables.tables.push_back(std::move(table));
}

}  // namespace

std::string isg_csv_text(const ErrorTables& tables, const std::vector<TableAxisName>& axes) {
  std::string text = "// Errors, actual minus nominal; positions in mm and degrees, values in mm and rad\n";
  bool first = true;
  for (const ErrorTable& table : tables.tables) {
    const TableAxisName& axis = table_axis(axes, table.axis);
    text += (first ? "" : "#\n") + axis.name;
    first = false;
    for (const Component component : table.components) text += " " + motion_name(component, axis);
    text += "\n";
    for (std::size_t k = 0; k < table.positions.size(); ++k) {
      text += shown_position_text(table.positions[k], axis.rotary);
      for (std::size_t c = 0; c < table.components.size(); ++c) {
        text += " " + error_text(table.values[c][k], is_rotation(table.components[c]));
      }
      text += "\n";
    }
  }
  if (tables.locations.empty()) return text;
  if (!first) text += "#\n";
  std::string names, values;
  for (const LocationError& location : tables.locations) {
    names += (names.empty() ? "" : " ") + location_name(location, axes);
    values += (values.empty() ? "" : " ") + error_text(location.value, is_rotation(location.component));
  }
  return text + names + "\n" + values + "\n";
}

ErrorTables parse_isg_csv(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes) {
  ErrorTables tables;
  TableLines lines(text, file);
  GivenOnce given;
  ErrorBlock block;
  while (lines.next()) {
    const std::string_view line = without_comment(lines.line());
    if (line.empty()) continue;
    if (line[0] == '#') {
      finish(block, file, tables);
      block = ErrorBlock();
      continue;
    }
    const std::vector<std::string_view> words = words_of(line);
    if (block.errors.empty()) {
      block = block_of(lines, words, axes, given);
    } else {
      add_row(lines, words, block);
    }
  }
  finish(block, file, tables);
  if (tables.tables.empty() && tables.locations.empty()) {
    throw InputError({.file = file}, "no errors", "a header such as X EXX EYX, and rows");
  }
  return tables;
}

std::string etalon_text(const ErrorTables& tables, const std::vector<TableAxisName>& axes) {
  std::string text = "// Errors, actual minus nominal; positions in mm and degrees, values in mm and rad\n";
  for (const LocationError& location : tables.locations) {
    text += fmt::format("[{}]\nVALUE = {}\n", location_name(location, axes),
                        error_text(location.value, is_rotation(location.component)));
  }
  for (const ErrorTable& table : tables.tables) {
    const TableAxisName& axis = table_axis(axes, table.axis);
    for (std::size_t c = 0; c < table.components.size(); ++c) {
      const std::string name = motion_name(table.components[c], axis);
      text += fmt::format("[{}]\nGridpoints = {{\n", name);
      for (std::size_t k = 0; k < table.positions.size(); ++k) {
        text += fmt::format("{} {}\n", shown_position_text(table.positions[k], axis.rotary),
                            error_text(table.values[c][k], is_rotation(table.components[c])));
      }
      text += fmt::format("}}  // end of {}\n", name);
    }
  }
  return text;
}

ErrorTables parse_etalon(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes) {
  ErrorTables tables;
  TableLines lines(text, file);
  GivenOnce given;
  NamedError error;
  std::string name;  // of the open section without its value; empty: none
  bool in_points = false;
  while (lines.next()) {
    const std::string_view line = without_comment(lines.line());
    if (line.empty()) continue;
    if (in_points) {
      ErrorTable& table = tables.tables.back();
      if (line == "}") {
        if (table.positions.empty()) lines.fail(name, "no points", "rows of position and value");
        in_points = false;
        name.clear();
        continue;
      }
      const std::vector<std::string_view> words = words_of(line);
      if (words.size() != 2) lines.fail(name, "not two numbers", "position and value");
      const bool rotary = table_axis(axes, table.axis).rotary;
      const double position = inside_position(lines.value(words[0], name, rotary ? "degrees" : "mm"), rotary);
      if (!table.positions.empty() && !(position > table.positions.back())) {
        lines.fail(name, "a position that is not above the one before", "increasing positions");
      }
      table.positions.push_back(position);
      table.values[0].push_back(lines.value(words[1], name, "mm or rad"));
      continue;
    }
    if (line.front() == '[') {
      if (!name.empty()) lines.fail(name, "has no value", "VALUE = ... or Gridpoints = {");
      if (line.back() != ']') lines.fail(shown_word(line), "no ']'", "[EXY]");
      name = without_blanks(line.substr(1, line.size() - 2));
      if (!parse_name(name, axes, error)) {
        lines.fail(shown_word(name), "unknown error", "such as EXY or C0B of " + table_axis_words(axes));
      }
      given.add(lines, name);
      continue;
    }
    const std::size_t equals = line.find('=');
    const std::string_view key = without_blanks(line.substr(0, equals));
    const std::string_view value = equals == std::string_view::npos ? "" : without_blanks(line.substr(equals + 1));
    if (name.empty()) lines.fail(shown_word(key), "outside a section", "[EXY] before it");
    if (key == "VALUE" && error.is_location) {
      tables.locations.push_back({error.axis, error.component, lines.value(value, name, "mm or rad"), 0});
      name.clear();
    } else if (key == "Gridpoints" && value == "{" && !error.is_location) {
      tables.tables.push_back({error.axis, {}, {error.component}, {{}}});
      in_points = true;
    } else {
      lines.fail(name, fmt::format("'{}' is not understood", shown_word(line)),
                 error.is_location ? "VALUE = number" : "Gridpoints = {");
    }
  }
  if (in_points || !name.empty()) throw InputError({.file = file}, "the file ends within " + name, "its value");
  if (tables.tables.empty() && tables.locations.empty()) throw InputError({.file = file}, "no errors", "[EXY] ...");
  return tables;
}

}  // namespace abbe
