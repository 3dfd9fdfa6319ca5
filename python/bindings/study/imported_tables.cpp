#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/study/imports/imported_file.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/evaluate/readings.h"
#include "bindings/tables.h"

namespace abbe::python {
namespace {

/// A column with what it is called in the table.
struct PythonColumn {
  ProposedColumn column;
  std::string source_name;
  bool is_text = false;
};

using TableArgument = std::variant<nb::bytes, std::filesystem::path>;
using MappingArgument = std::variant<std::shared_ptr<ImportedTable>, nb::bytes, std::filesystem::path>;
using ImportMachine = std::variant<Machine, std::filesystem::path>;

struct HintArguments {
  std::optional<std::string> encoding, separator, decimal, length_unit, angle_unit, azimuth, vertical, mirrored;
  bool accept_uncertain = false;
};

/// The value of a word that is an index into all words. @throws InputError that names them
template <class Value, class Words>
std::optional<Value> indexed_word(const char* name, const std::optional<std::string>& word, const Words& words) {
  if (!word) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), *word);
  if (found == words.end()) refuse_word(name, *word, {words.begin(), words.end()});
  return static_cast<Value>(found - words.begin());
}

/// A unit of the library, or an empty text.
std::string unit_word(const char* name, const std::optional<std::string>& word, Quantity quantity) {
  indexed_word<int>(name, word, import_unit_names(quantity));
  return word.value_or("");
}

std::optional<TextEncoding> encoding_word(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  const std::optional<TextEncoding> encoding = encoding_named(*word);
  if (!encoding) refuse_word("encoding", *word, encoding_names());
  return encoding;
}

ImportHints hints_of(const HintArguments& given) {
  ImportHints hints;
  hints.layout.separator = indexed_word<FieldSeparator>("separator", given.separator, separator_names());
  hints.layout.decimal = indexed_word<DecimalMark>("decimal", given.decimal, decimal_names());
  hints.length_unit = unit_word("length_unit", given.length_unit, Quantity::length);
  hints.angle_unit = unit_word("angle_unit", given.angle_unit, Quantity::angle);
  if (given.azimuth) {
    hints.clockwise = word_value<bool>("azimuth", *given.azimuth, {{"clockwise", true}, {"anticlockwise", false}});
  }
  if (given.vertical) {
    hints.zenith = word_value<bool>("vertical", *given.vertical, {{"zenith", true}, {"horizontal", false}});
  }
  if (given.mirrored) {
    hints.mirrored = word_value<std::string>("mirrored", *given.mirrored, {{"x", "x"}, {"y", "y"}, {"z", "z"}});
  }
  return hints;
}

/// A mapping says all that hints say.
void refuse_hints(const HintArguments& given) {
  const auto refuse = [](const char* name, bool is_given) {
    if (is_given) throw InputError({.field = name}, "is given together with mapping", "one of them");
  };
  refuse("separator", given.separator.has_value());
  refuse("decimal", given.decimal.has_value());
  refuse("length_unit", given.length_unit.has_value());
  refuse("angle_unit", given.angle_unit.has_value());
  refuse("azimuth", given.azimuth.has_value());
  refuse("vertical", given.vertical.has_value());
  refuse("mirrored", given.mirrored.has_value());
  refuse("accept_uncertain", given.accept_uncertain);
}

constexpr const char* kHowToConfirm = "arguments that say it, accept_uncertain=True, or a mapping";

void require_certain(const ImportedTable& table, const char* consequence) {
  if (table.is_certain()) return;
  throw InputError({.file = table.file},
                   fmt::format("{}, because it is uncertain: {}", consequence, argument_words(table.doubts().front())),
                   kHowToConfirm);
}

ImportMapping mapping_of(const MappingArgument& argument) {
  if (const auto* const path = std::get_if<std::filesystem::path>(&argument)) {
    return computed([&] { return read_import_mapping(*path); });
  }
  if (const auto* const text = std::get_if<nb::bytes>(&argument)) {
    return parse_import_mapping(std::string(text->c_str(), text->size()), "mapping");
  }
  const ImportedTable& table = *std::get<std::shared_ptr<ImportedTable>>(argument);
  require_certain(table, "it cannot be the mapping of another table");
  return table.mapping;
}

ForeignText text_of(const TableArgument& table, const std::string& file, std::optional<TextEncoding> encoding) {
  if (const auto* const path = std::get_if<std::filesystem::path>(&table)) {
    return computed([&] { return read_foreign_text(*path, {.encoding = encoding}); });
  }
  const auto& given = std::get<nb::bytes>(table);
  const std::string_view bytes(given.c_str(), given.size());
  return computed([&] { return decode_foreign_text(bytes, file, {.encoding = encoding}); });
}

ImportedTable imported(const TableArgument& table, const std::optional<std::string>& format,
                       const std::optional<std::string>& kind, const std::optional<ImportMachine>& machine,
                       const std::optional<MappingArgument>& mapping, const HintArguments& given,
                       const std::string& file) {
  ImportRequest request;
  indexed_word<int>("format", format, import_format_names());
  request.format = format.value_or("");
  request.kind = indexed_word<ImportKind>("kind", kind, import_kind_names());
  request.hints = hints_of(given);
  request.accept_doubts = given.accept_uncertain;
  std::optional<TextEncoding> encoding = encoding_word(given.encoding);
  if (mapping) {
    refuse_hints(given);
    request.mapping = mapping_of(*mapping);
    if (!encoding) encoding = request.mapping->encoding;
  }
  if (machine) {
    const auto* const path = std::get_if<std::filesystem::path>(&*machine);
    request.machine = path ? computed([&] { return read_machine(*path); }) : std::get<Machine>(*machine);
  }
  const auto* const path = std::get_if<std::filesystem::path>(&table);
  request.file = !file.empty() ? file : path ? path->string() : "table";
  request.text = text_of(table, request.file, encoding);
  return computed([&] { return import_table(request); });
}

std::vector<PythonColumn> columns_of_table(const ImportedTable& table) {
  const std::vector<ImportColumn> known = import_columns(table.mapping.kind, Machine());
  std::vector<PythonColumn> columns;
  for (const ProposedColumn& column : table.columns) {
    // The axes of a machine are missing here; they hold numbers.
    const bool is_text = std::any_of(known.begin(), known.end(), [&](const ImportColumn& one) {
      return one.holds != ImportColumn::Holds::number && one.base == column.column.name;
    });
    const std::vector<std::string>& names = table.found.names;
    columns.push_back({column, column.source < names.size() ? names[column.source] : std::string(), is_text});
  }
  return columns;
}

std::vector<std::string> in_argument_words(std::vector<std::string> texts) {
  for (std::string& text : texts) text = argument_words(text);
  return texts;
}

void bind_columns(nb::module_& module) {
  using Column = PythonColumn;
  nb::class_<Column>(module, "ImportedColumn", "Where a column of an imported table comes from.")
      .def_prop_ro(
          "name", [](const Column& c) { return c.column.column.name; }, "As Abbe reads it, with its unit: 'range_m'.")
      .def_prop_ro(
          "source", [](const Column& c) { return c.column.source; }, "Index of the column in the table, from 0.")
      .def_ro("source_name", &Column::source_name, "Its name in the header of the table; '' where there is none.")
      .def_prop_ro(
          "unit", [](const Column& c) { return c.column.column.unit; },
          "Of the table, such as 'inch'; '' for texts and numbers without one.")
      .def_prop_ro(
          "convention", [](const Column& c) { return std::string(convention_name(c.column.column.convention)); },
          "'as-written', 'reversed', 'zenith' or 'clockwise': docs/import.md.")
      .def_ro("is_text", &Column::is_text, "Whether it holds names or directions, not numbers.")
      .def_prop_ro(
          "reason", [](const Column& c) { return c.column.reason; }, "Why it is read so.")
      .def_prop_ro(
          "doubts", [](const Column& c) { return in_argument_words(c.column.doubts); },
          "What nothing in the table decides, a sentence each.")
      .def("__repr__", [](const Column& c) {
        return fmt::format("<abbe.ImportedColumn {}: column {}{}>", c.column.column.name, c.column.source,
                           c.column.doubts.empty() ? "" : ", uncertain");
      });
}

void bind_table(nb::module_& module) {
  using Table = ImportedTable;
  nb::class_<Table> bound(
      module, "ImportedTable",
      "A table of another program, or a file of an instrument, as Abbe reads it. Made by import_table().\n\n"
      "Look at certain first. What is uncertain and was not accepted is neither written nor given\n"
      "as values: readings in the wrong unit look like readings.");
  add_json(bound, &imported_table_json);
  add_tables(bound, "imported_frame", nullptr);
  bound.def_prop_ro("certain", &Table::is_certain, "Whether nothing is in doubt that was not accepted.")
      .def_prop_ro(
          "doubts", [](const Table& t) { return in_argument_words(t.doubts()); },
          "What nothing in the table decides, accepted or not, with the column that it is about.")
      .def_ro("file", &Table::file, "Its name for texts and messages.")
      .def_prop_ro(
          "kind", [](const Table& t) { return std::string(import_kind_name(t.mapping.kind)); },
          "'points', 'tracker', 'positioning' or 'circular'.")
      .def_ro("kind_reason", &Table::kind_reason, "Why.")
      .def_ro("format", &Table::format, "'table', or the form of a file of an instrument: docs/import.md.")
      .def_ro("format_reason", &Table::format_reason, "How such a form is known; '' for a table.")
      .def_prop_ro(
          "facts",
          [](const Table& t) {
            std::vector<std::pair<std::string, std::string>> facts;
            for (const InstrumentFact& fact : t.facts) facts.emplace_back(fact.name, fact.value);
            return facts;
          },
          "What a file of an instrument says beside its readings: names and values, as it has them.")
      .def_prop_ro(
          "encoding", [](const Table& t) { return std::string(encoding_name(t.encoding)); },
          "'utf-8', 'utf-16le', 'utf-16be' or 'windows-1252'.")
      .def_ro("encoding_reason", &Table::encoding_reason, "How it is known.")
      .def_ro("gzip", &Table::packed, "Whether the table was compressed.")
      .def_prop_ro(
          "layout_reasons", [](const Table& t) { return t.found.reasons; },
          "What was found of separator, header and decimal mark, a sentence each.")
      .def_prop_ro("columns", &columns_of_table, "Each an ImportedColumn, in the order of the CSV.")
      .def_ro("not_read", &Table::not_read, "Other columns of the table, in words.")
      .def_prop_ro(
          "rows", [](const Table& t) { return t.rows.rows; }, "Number of rows.")
      .def_prop_ro(
          "blank_lines", [](const Table& t) { return t.rows.blank_lines; },
          "That were passed over below the first row.")
      .def_prop_ro(
          "comment_lines", [](const Table& t) { return t.rows.comment_lines; }, "Likewise.")
      .def(
          "values",
          [](nb::handle_t<Table> self) {
            require_certain(initialised(self), "there are no values");
            return nb::module_::import_("abbe._tables").attr("imported_values")(self);
          },
          nb::sig("def values(self) -> dict[str, numpy.ndarray | list[str]]"),
          "The columns by name, as evaluate_positioning() and others take them: [n] numbers in the unit of the name, "
          "or\n"
          "texts. Raises InputError if something is uncertain.")
      .def(
          "csv", [](const Table& t) { return t.rows.csv; }, "Text of the file that `abbe import -o` writes.")
      .def("mapping_text", &imported_mapping_text,
           "Mapping file (*.import.toml) by which tables of the same program are read, with reasons and doubts as\n"
           "comments. Its bytes, mapping_text().encode(), are a mapping for import_table().")
      .def("text", &imported_table_text, "What `abbe import` prints.")
      .def(
          "write",
          [](const Table& t, const std::filesystem::path& path, bool overwrite) {
            require_certain(t, "nothing is written");
            write_text(path, t.rows.csv, overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes csv(), whole or not at all. Raises InputError if something is uncertain.")
      .def(
          "write_mapping",
          [](const Table& t, const std::filesystem::path& path, bool overwrite) {
            write_text(path, imported_mapping_text(t), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes mapping_text(), whole or not at all, also if something is uncertain, to be looked at.")
      .def("__len__", [](const Table& t) { return t.rows.rows; })
      .def("__repr__", [](const Table& t) {
        return fmt::format("<abbe.ImportedTable {}: {} rows{}>", import_kind_name(t.mapping.kind), t.rows.rows,
                           t.is_certain() ? "" : ", uncertain");
      });
}

}  // namespace

void bind_imported_tables(nb::module_& module) {
  bind_columns(module);
  bind_table(module);
  module.def(
      "import_table",
      [](const TableArgument& table, const std::optional<std::string>& format, const std::optional<std::string>& kind,
         const std::optional<ImportMachine>& machine, const std::optional<MappingArgument>& mapping,
         std::optional<std::string> encoding, std::optional<std::string> separator, std::optional<std::string> decimal,
         std::optional<std::string> length_unit, std::optional<std::string> angle_unit,
         std::optional<std::string> azimuth, std::optional<std::string> vertical, std::optional<std::string> mirrored,
         bool accept_uncertain, const std::string& file) {
        return imported(
            table, format, kind, machine, mapping,
            {std::move(encoding), std::move(separator), std::move(decimal), std::move(length_unit),
             std::move(angle_unit), std::move(azimuth), std::move(vertical), std::move(mirrored), accept_uncertain},
            file);
      },
      nb::arg("table"), nb::kw_only(), nb::arg("format") = nb::none(), nb::arg("kind") = nb::none(),
      nb::arg("machine") = nb::none(), nb::arg("mapping") = nb::none(), nb::arg("encoding") = nb::none(),
      nb::arg("separator") = nb::none(), nb::arg("decimal") = nb::none(), nb::arg("length_unit") = nb::none(),
      nb::arg("angle_unit") = nb::none(), nb::arg("azimuth") = nb::none(), nb::arg("vertical") = nb::none(),
      nb::arg("mirrored") = nb::none(), nb::arg("accept_uncertain") = false, nb::arg("file") = "",
      "A table of readings that another program wrote, or a file of an instrument, as Abbe reads it: `abbe import`.\n\n"
      "table: a file, or its contents as bytes. format: 'table', 'renishaw-laser', 'linuxcnc-probe', 'qif',\n"
      "'mtconnect', 'mtconnect-temperatures', 'mtconnect-devices', 'dmis', 'heidenhain-table', 'ecmc-positioning',\n"
      "'renishaw-ballbar'; default: by the contents. kind: 'points', 'tracker', 'positioning', 'circular',\n"
      "'temperatures'; default: by the columns.\n"
      "machine: a Machine or its file, for a tracker table with axis commands. mapping: a mapping file, its "
      "contents\n"
      "as bytes, or an ImportedTable; then nothing is proposed, and nothing is in doubt. encoding: 'utf-8', "
      "'utf-16le',\n"
      "'utf-16be', 'windows-1252'; default: from the bytes. What the table does not say, and not together with a\n"
      "mapping: separator ('comma', 'semicolon', 'tab', 'blanks'), decimal ('point', 'comma'), length_unit ('mm',\n"
      "'inch', ...), angle_unit ('deg', 'gon', ...), azimuth ('clockwise', 'anticlockwise'), vertical ('zenith',\n"
      "'horizontal'), mirrored ('x', 'y', 'z'). accept_uncertain: accept proposals that are uncertain.\n"
      "file: name for texts and messages. Raises InputError. Method: docs/import.md.\n\n"
      ">>> import abbe\n"
      ">>> table = abbe.import_table(b'Name;X;Y;Z\\nP1;1,5;2;0\\nP2;2,5;2;0\\n')\n"
      ">>> table.certain, table.doubts[0]\n"
      "(False, 'x_mm: states no unit; millimetres are assumed (range 1.5 to 2.5; length_unit)')\n"
      ">>> inches = abbe.import_table(b'Name;X;Y;Z\\nP1;1,5;2;0\\nP2;2,5;2;0\\n', length_unit='inch')\n"
      ">>> inches.values()['x_mm'].tolist()\n"
      "[38.1, 63.5]\n");
}

}  // namespace abbe::python
