#include "abbe/formats/import/import_mapping.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/instrument_format.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

constexpr std::int64_t kMostLines = 1'000'000'000, kMostColumns = 100'000;
constexpr std::size_t kLongestCommentMark = 10;

TableLayout read_table_layout(TomlTable table) {
  TableLayout layout;
  layout.separator = static_cast<FieldSeparator>(table.word("separator", separator_names()));
  layout.decimal = static_cast<DecimalMark>(table.word("decimal", decimal_names()));
  if (table.has("thousands")) layout.thousands = static_cast<ThousandsMark>(table.word("thousands", thousands_names()));
  layout.comment = table.text_or("comment", "");
  if (layout.comment.size() > kLongestCommentMark || layout.comment.find(' ') != std::string::npos) {
    table.fail("comment", "is not the mark of a comment", "up to 10 characters without blanks, such as \"#\"");
  }
  layout.header_line = static_cast<std::size_t>(table.integer_or("header_line", 0, 1, kMostLines));
  layout.unit_line = static_cast<std::size_t>(table.integer_or("unit_line", 0, 1, kMostLines));
  layout.first_line = static_cast<std::size_t>(table.integer("first_line", 1, kMostLines));
  if (layout.header_line >= layout.first_line || layout.unit_line >= layout.first_line) {
    table.fail("first_line", "is not below the header and the units", "the line of the first row");
  }
  if (layout.unit_line > 0 && layout.unit_line == layout.header_line) {
    table.fail("unit_line", "is also the header_line", "a line of its own");
  }
  const bool decimal_is_point = layout.decimal == DecimalMark::point;
  if (layout.thousands == (decimal_is_point ? ThousandsMark::point : ThousandsMark::comma)) {
    table.fail("thousands", "is also the decimal mark", "another mark, or none");
  }
  if (layout.thousands == ThousandsMark::blank && layout.separator == FieldSeparator::blanks) {
    table.fail("thousands", "is also the separator", "another mark, or none");
  }
  table.finish();
  return layout;
}

MappedColumn read_mapped_column(TomlTable& table) {
  MappedColumn column;
  column.name = table.text("name");
  column.from = table.text_or("from", "");
  column.from_column = static_cast<std::size_t>(table.integer_or("from_column", 0, 1, kMostColumns));
  if (column.from.empty() == (column.from_column == 0)) {
    table.fail("", "has to say where it comes from", "from = \"name in the header\" or from_column = 1, one of them");
  }
  column.unit = table.text_or("unit", "");
  if (!column.unit.empty() && foreign_unit_named(column.unit) == nullptr) {
    std::vector<std::string_view> known;
    for (const Quantity quantity : {Quantity::length, Quantity::angle, Quantity::time}) {
      const std::vector<std::string_view> names = foreign_unit_names(quantity);
      known.insert(known.end(), names.begin(), names.end());
    }
    table.fail("unit", fmt::format("'{}' is not a unit", column.unit.substr(0, 40)),
               fmt::format("one of {}", fmt::join(known, ", ")));
  }
  if (table.has("convention")) {
    column.convention = static_cast<ImportConvention>(table.word("convention", convention_names()));
  }
  column.positive = table.texts_or_none("positive");
  column.negative = table.texts_or_none("negative");
  table.finish();
  return column;
}

std::string layout_text(const TableLayout& layout) {
  std::string text = fmt::format("\n[layout]\nseparator = \"{}\"\ndecimal = \"{}\"\n", separator_name(layout.separator),
                                 decimal_name(layout.decimal));
  if (layout.thousands != ThousandsMark::none) {
    text += fmt::format("thousands = \"{}\"\n", thousands_name(layout.thousands));
  }
  if (!layout.comment.empty()) text += fmt::format("comment = {}\n", toml_string(layout.comment));
  if (layout.header_line > 0) text += fmt::format("header_line = {}\n", layout.header_line);
  if (layout.unit_line > 0) text += fmt::format("unit_line = {}\n", layout.unit_line);
  text += fmt::format("first_line = {}\n", layout.first_line);
  return text;
}

std::string words_line(std::string_view key, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + toml_string(word);
  return fmt::format("{} = [{}]\n", key, list);
}

}  // namespace

std::vector<std::string> import_unit_names(Quantity quantity) {
  const std::vector<std::string_view> names = foreign_unit_names(quantity);
  return {names.begin(), names.end()};
}

ImportMapping parse_import_mapping(const std::string& text, const std::string& file) {
  TomlTable root = TomlTable::parse(text, file);
  ImportMapping mapping;
  mapping.file = file;
  const std::vector<std::string> kinds = import_kind_names();
  mapping.kind = static_cast<ImportKind>(root.word("kind", std::vector<std::string_view>(kinds.begin(), kinds.end())));
  if (root.has("encoding")) {
    const std::vector<std::string> known = encoding_names();
    mapping.encoding =
        encoding_named(known[root.word("encoding", std::vector<std::string_view>(known.begin(), known.end()))]);
  }
  if (root.has("format")) {
    std::vector<std::string_view> known;
    for (const InstrumentFormat& format : instrument_formats()) known.push_back(format.name);
    mapping.format = known[root.word("format", known)];
  } else {
    mapping.layout = read_table_layout(root.table("layout"));
  }
  std::vector<std::string> names;
  for (TomlTable& table : root.tables("column")) {
    MappedColumn column = read_mapped_column(table);
    if (std::find(names.begin(), names.end(), column.name) != names.end()) {
      table.fail("name", "this column is written twice", "each column once");
    }
    if (!column.from.empty() && mapping.format.empty() && mapping.layout.header_line == 0) {
      table.fail("from", "the layout has no header_line", "from_column, or the header_line of the layout");
    }
    names.push_back(column.name);
    mapping.columns.push_back(std::move(column));
  }
  if (mapping.columns.empty()) root.fail("", "no columns are written", "tables [[column]]");
  root.finish();
  return mapping;
}

ImportMapping read_import_mapping(const std::filesystem::path& path) {
  return parse_import_mapping(read_file_of_kind(path, ".import.toml"), path.string());
}

std::string import_mapping_text(const ImportMapping& mapping, const std::vector<std::vector<std::string>>& remarks) {
  std::string text = fmt::format("kind = \"{}\"\n", import_kind_name(mapping.kind));
  if (mapping.encoding) text += fmt::format("encoding = \"{}\"\n", encoding_name(*mapping.encoding));
  if (!mapping.format.empty()) {
    text += fmt::format("format = \"{}\"\n", mapping.format);
  } else {
    text += layout_text(mapping.layout);
  }
  for (std::size_t i = 0; i < mapping.columns.size(); ++i) {
    const MappedColumn& column = mapping.columns[i];
    text += '\n';
    if (i < remarks.size()) {
      for (const std::string& remark : remarks[i]) {
        text += fmt::format("# {}\n", printable(remark, 300, LineFeeds::escaped));
      }
    }
    text += fmt::format("[[column]]\nname = {}\n", toml_string(column.name));
    text += column.from.empty() ? fmt::format("from_column = {}\n", column.from_column)
                                : fmt::format("from = {}\n", toml_string(column.from));
    if (!column.unit.empty()) text += fmt::format("unit = \"{}\"\n", column.unit);
    if (column.convention != ImportConvention::as_written) {
      text += fmt::format("convention = \"{}\"\n", convention_name(column.convention));
    }
    text += words_line("positive", column.positive) + words_line("negative", column.negative);
  }
  return text;
}

}  // namespace abbe
