#include "abbe/formats/controls/table_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

constexpr int kCorrectionDecimals = 4;
constexpr std::size_t kMostNodes = 20'000'000;

std::string input_title(const TableAxisName& axis) { return axis.name + (axis.rotary ? "_deg" : "_mm"); }
std::string output_title(const TableAxisName& axis) {
  return "correction_" + axis.name + (axis.rotary ? "_urad" : "_um");
}

std::string correction_text(double value, bool rotary) {
  return fixed_number(micro_per_unit(rotary) * value, kCorrectionDecimals);
}

/// Different values in increasing order.
std::vector<double> sorted_nodes(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

std::string lattice_csv_text(const CorrectionLattice& lattice, const std::vector<TableAxisName>& axes) {
  std::string text =
      "# Corrections (minus the error) to be added to axis commands, linear in every axis position between the nodes\n";
  for (const std::size_t input : lattice.inputs) text += input_title(table_axis(axes, input)) + ",";
  for (const std::size_t output : lattice.outputs) text += output_title(table_axis(axes, output)) + ",";
  text.back() = '\n';
  for (std::size_t k = 0; k < lattice.count(); ++k) {
    std::size_t rest = k;
    for (std::size_t a = 0; a < lattice.inputs.size(); ++a) {
      const std::vector<double>& nodes = lattice.positions[a];
      text += shown_position_text(nodes[rest % nodes.size()], table_axis(axes, lattice.inputs[a]).rotary) + ",";
      rest /= nodes.size();
    }
    for (std::size_t o = 0; o < lattice.outputs.size(); ++o) {
      text += correction_text(lattice.corrections[o][k], table_axis(axes, lattice.outputs[o]).rotary) + ",";
    }
    text.back() = '\n';
  }
  return text;
}

CorrectionLattice parse_lattice_csv(std::string_view text, const std::string& file,
                                    const std::vector<TableAxisName>& axes) {
  std::vector<CsvColumn> wanted;
  for (const TableAxisName& axis : axes) {
    const Quantity quantity = axis.rotary ? Quantity::angle : Quantity::length;
    wanted.push_back({.base = axis.name, .quantity = quantity, .required = false});
  }
  for (const TableAxisName& axis : axes) {
    const Quantity quantity = axis.rotary ? Quantity::angle : Quantity::length;
    wanted.push_back({.base = "correction_" + axis.name, .quantity = quantity, .required = false});
  }
  const CsvTable table = read_csv(text, file, wanted, {}, 1);
  CorrectionLattice lattice;
  std::vector<const std::vector<double>*> columns;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!table.columns[a].present) continue;
    lattice.inputs.push_back(axes[a].axis);
    lattice.modulo.push_back(false);
    lattice.positions.push_back(sorted_nodes(table.columns[a].numbers));
    columns.push_back(&table.columns[a].numbers);
  }
  std::vector<const std::vector<double>*> corrections;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const CsvValues& values = table.columns[axes.size() + a];
    if (!values.present) continue;
    lattice.outputs.push_back(axes[a].axis);
    corrections.push_back(&values.numbers);
  }
  if (lattice.inputs.empty() || lattice.outputs.empty() || table.rows == 0) {
    throw InputError({.file = file}, "no grid", "columns of axis positions and of corrections, and rows");
  }
  double product = 1;
  for (const std::vector<double>& nodes : lattice.positions) product *= static_cast<double>(nodes.size());
  if (product != static_cast<double>(table.rows)) {
    throw InputError({.file = file}, fmt::format("{} rows, but a grid of {:.0f} nodes", table.rows, product),
                     "one row for every combination of axis positions");
  }
  lattice.corrections.assign(corrections.size(), std::vector<double>(table.rows));
  std::vector<bool> filled(table.rows, false);
  for (std::size_t row = 0; row < table.rows; ++row) {
    std::size_t index = 0, stride = 1;
    for (std::size_t a = 0; a < columns.size(); ++a) {
      const std::vector<double>& nodes = lattice.positions[a];
      const auto place = std::lower_bound(nodes.begin(), nodes.end(), (*columns[a])[row]) - nodes.begin();
      index += stride * static_cast<std::size_t>(place);
      stride *= nodes.size();
    }
    if (filled[index]) {
      throw InputError({.file = file, .line = csv_line(text, row)}, "a node that was there before",
                       "one row for every combination of axis positions");
    }
    filled[index] = true;
    for (std::size_t o = 0; o < corrections.size(); ++o) lattice.corrections[o][index] = (*corrections[o])[row];
  }
  return lattice;
}

std::string lattice_vtk_text(const CorrectionLattice& lattice, const std::vector<TableAxisName>& axes) {
  assert(!lattice.inputs.empty() && lattice.inputs.size() <= 3);
  std::string text = "# vtk DataFile Version 3.0\ncorrections over";
  for (const std::size_t input : lattice.inputs) text += " " + input_title(table_axis(axes, input));
  text += "\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS";
  for (std::size_t a = 0; a < 3; ++a) {
    text += fmt::format(" {}", a < lattice.inputs.size() ? lattice.positions[a].size() : 1);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t count = a < lattice.inputs.size() ? lattice.positions[a].size() : 1;
    text += fmt::format("\n{}_COORDINATES {} double\n", "XYZ"[a], count);
    if (a >= lattice.inputs.size()) {
      text += "0";
      continue;
    }
    const bool rotary = table_axis(axes, lattice.inputs[a]).rotary;
    for (std::size_t k = 0; k < count; ++k) {
      text += (k == 0 ? "" : " ") + shown_position_text(lattice.positions[a][k], rotary);
    }
  }
  text += fmt::format("\nPOINT_DATA {}\n", lattice.count());
  for (std::size_t o = 0; o < lattice.outputs.size(); ++o) {
    const TableAxisName& axis = table_axis(axes, lattice.outputs[o]);
    text += "SCALARS " + output_title(axis) + " double 1\nLOOKUP_TABLE default\n";
    for (const double value : lattice.corrections[o]) text += correction_text(value, axis.rotary) + "\n";
  }
  return text;
}

namespace {

/// Name of an axis behind which the unit of its kind stands, or null: "X_mm", "correction_C_urad".
const TableAxisName* titled_axis(std::string_view title, bool output, const std::vector<TableAxisName>& axes) {
  for (const TableAxisName& axis : axes) {
    if (title == (output ? output_title(axis) : input_title(axis))) return &axis;
  }
  return nullptr;
}

std::size_t whole_number(TextCursor& cursor, const char* field, std::size_t most) {
  const long long value = cursor.integer(field);
  if (value < 1 || static_cast<unsigned long long>(value) > most) {
    cursor.fail(field, "out of range", fmt::format("a whole number from 1 to {}", most));
  }
  return static_cast<std::size_t>(value);
}

void take(TextCursor& cursor, const char* word) {
  if (cursor.take(word)) return;
  cursor.word();
  cursor.fail(word, "is missing", word);
}

}  // namespace

CorrectionLattice parse_lattice_vtk(std::string_view text, const std::string& file,
                                    const std::vector<TableAxisName>& axes) {
  TextCursor cursor(text, file);
  if (cursor.line() != "# vtk DataFile Version 3.0") {
    throw InputError({.file = file, .line = 1}, "no legacy VTK file", "# vtk DataFile Version 3.0");
  }
  CorrectionLattice lattice;
  const std::vector<std::string_view> title = words_of(cursor.line());
  if (title.size() < 3 || title.size() > 5 || title[0] != "corrections" || title[1] != "over") {
    throw InputError({.file = file, .line = 2}, "the title names no axes",
                     "corrections over X_mm ... with one to three axes");
  }
  for (std::size_t a = 2; a < title.size(); ++a) {
    const TableAxisName* const axis = titled_axis(title[a], false, axes);
    if (axis == nullptr) {
      throw InputError({.file = file, .line = 2}, fmt::format("unknown axis '{}'", shown_word(title[a])),
                       "an axis with _mm or _deg: " + table_axis_words(axes));
    }
    if (std::find(lattice.inputs.begin(), lattice.inputs.end(), axis->axis) != lattice.inputs.end()) {
      throw InputError({.file = file, .line = 2}, "an axis is named twice", "different axes");
    }
    lattice.inputs.push_back(axis->axis);
    lattice.modulo.push_back(false);
  }
  for (const char* word : {"ASCII", "DATASET", "RECTILINEAR_GRID", "DIMENSIONS"}) take(cursor, word);
  std::size_t sizes[3];
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    sizes[a] = whole_number(cursor, "DIMENSIONS", a < lattice.inputs.size() ? kMostNodes / count : 1);
    count *= sizes[a];
  }
  const char* const coordinates[3] = {"X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"};
  for (std::size_t a = 0; a < 3; ++a) {
    take(cursor, coordinates[a]);
    if (whole_number(cursor, coordinates[a], kMostNodes) != sizes[a]) {
      cursor.fail(coordinates[a], "another count than in DIMENSIONS", fmt::format("{}", sizes[a]));
    }
    take(cursor, "double");
    std::vector<double> nodes;
    for (std::size_t k = 0; k < sizes[a]; ++k) {
      const double shown = cursor.number(coordinates[a]);
      const bool rotary = a < lattice.inputs.size() && table_axis(axes, lattice.inputs[a]).rotary;
      nodes.push_back(rotary ? shown * kDegree : shown);
      if (k > 0 && !(nodes[k] > nodes[k - 1])) cursor.fail(coordinates[a], "not increasing", "increasing positions");
    }
    if (a < lattice.inputs.size()) lattice.positions.push_back(std::move(nodes));
  }
  take(cursor, "POINT_DATA");
  if (whole_number(cursor, "POINT_DATA", kMostNodes) != count) {
    cursor.fail("POINT_DATA", "another count than the grid's", fmt::format("{}", count));
  }
  while (cursor.take("SCALARS")) {
    const std::string_view name = cursor.word();
    const TableAxisName* const axis = titled_axis(name, true, axes);
    if (axis == nullptr) {
      cursor.fail("SCALARS", fmt::format("unknown field '{}'", shown_word(name)), "correction_AXIS_um or _urad");
    }
    if (std::find(lattice.outputs.begin(), lattice.outputs.end(), axis->axis) != lattice.outputs.end()) {
      cursor.fail("SCALARS", "a field that was there before", "one field per axis");
    }
    for (const char* word : {"double", "1", "LOOKUP_TABLE", "default"}) take(cursor, word);
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) values.push_back(cursor.number("SCALARS") / micro_per_unit(axis->rotary));
    lattice.outputs.push_back(axis->axis);
    lattice.corrections.push_back(std::move(values));
  }
  if (!cursor.word().empty()) cursor.fail("", "unknown word", "SCALARS or the end of the file");
  if (lattice.outputs.empty()) throw InputError({.file = file}, "no corrections", "SCALARS correction_AXIS_um");
  return lattice;
}

}  // namespace abbe
