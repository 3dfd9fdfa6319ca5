#include "abbe/formats/import/readable_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/formats/import/column_source.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_text.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/import/gzip.h"
#include "abbe/formats/import/table_layout.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

/// A column of the file and the name that it gets.
struct ReadableColumn {
  ColumnSource source;
  std::string name;
};

/// @returns nothing if no table is found. A table that only lacks its decimal mark is an error.
std::optional<FoundLayout> readable_layout(std::string_view text, const std::string& file) {
  try {
    return find_layout(text, file);
  } catch (const InputError& error) {
    try {
      const FoundLayout found = find_layout(text, file, {.separator = {}, .decimal = DecimalMark::comma});
      // Between commas it is a wrong field, of which the reader of the file says more.
      if (found.layout.separator == FieldSeparator::comma) return std::nullopt;
    } catch (const InputError&) {
      return std::nullopt;
    }
    throw InputError(error.place(), error.problem(),
                     "decimals that can be told from thousands; abbe import FILE --decimal says which they are");
  }
}

/// Line of the header that read_csv() takes, from 1.
std::size_t header_line_of_csv(std::string_view text) {
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    if (!csv_is_passed_over(csv_next_line(text, at))) break;
  }
  return line;
}

class ColumnNamer {
 public:
  ColumnNamer(const std::string& file, const FoundLayout& found, const std::vector<CsvColumn>& wanted,
              const ColumnMapping& mapping)
      : file_(file), found_(found), wanted_(wanted), mapping_(mapping) {}

  ReadableColumn column(std::size_t index) const {
    const std::string& header = found_.names[index];
    ReadableColumn result;
    result.source.source = index;
    result.source.name = result.name = header;
    if (std::find(mapping_.ignore.begin(), mapping_.ignore.end(), header) != mapping_.ignore.end()) {
      result.source.holds = ImportColumn::Holds::label;
      return result;
    }
    const std::string row(without_brackets(found_.units[index]));
    auto [name, unit] = split_header(header);
    if (!row.empty() && row != "-") {
      // A unit in the header and another one below it: the row is that of the units.
      name = unit.empty() ? header : name;
      unit = row;
    }
    const auto mapped = std::find_if(mapping_.columns.begin(), mapping_.columns.end(),
                                     [&, &own = header](const auto& entry) { return entry.second == own; });
    if (mapped != mapping_.columns.end()) {
      result.source.holds = is_text(mapped->first) ? ImportColumn::Holds::label : ImportColumn::Holds::number;
      check_mapped(index, mapped->first, unit);
      return result;
    }
    if (is_text(header)) {
      result.source.holds = ImportColumn::Holds::label;
      return result;
    }
    if (unit.empty()) return result;
    const ForeignUnit* const found = unit_of(index, name, unit);
    if (found == nullptr) return result;
    result.source.unit = found;
    result.name = fmt::format("{}_{}", name, found->suffix);
    return result;
  }

 private:
  bool is_text(const std::string& ours) const {
    return std::any_of(wanted_.begin(), wanted_.end(),
                       [&](const CsvColumn& column) { return column.is_text && column.base == ours; });
  }

  [[noreturn]] void fail(std::size_t index, const std::string& problem, const std::string& expected) const {
    const bool in_row = !found_.units[index].empty();
    throw InputError({.file = file_,
                      .line = in_row ? found_.layout.unit_line : found_.layout.header_line,
                      .field = found_.names[index]},
                     problem, expected);
  }

  /// Null if the reader wants no such column, or in no such unit: then it says so itself.
  const ForeignUnit* unit_of(std::size_t index, const std::string& name, const std::string& written) const {
    const ForeignUnit* result = nullptr;
    for (const CsvColumn& column : wanted_) {
      if (column.is_text || column.base != name) continue;
      const ForeignUnit* const unit = foreign_unit(written, column.quantity);
      if (unit == nullptr || unit == result) continue;
      if (result != nullptr) {
        fail(index, fmt::format("'{}' may be {} or {}", printable(written, 20), result->name, unit->name),
             fmt::format("{}_{} or {}_{} as the name of the column", name, result->suffix, name, unit->suffix));
      }
      result = unit;
    }
    if (result != nullptr && small_letters(written) == "grad") {
      fail(index, "'grad' is a degree in German and 0.9 degrees elsewhere", "deg or gon");
    }
    return result;
  }

  void check_mapped(std::size_t index, const std::string& ours, const std::string& stated) const {
    if (stated.empty()) return;
    for (const CsvColumn& column : wanted_) {
      const Unit* const said = column.is_text ? nullptr : unit_of_name(ours, column.base, column.quantity);
      const ForeignUnit* const unit = said == nullptr ? nullptr : foreign_unit(stated, column.quantity);
      if (unit == nullptr || (unit->suffix == said->suffix && unit->name == said->suffix)) continue;
      fail(index, fmt::format("the file says {}, and the column is to be read as {}", printable(stated, 20), ours),
           "the unit of the file");
    }
  }

  const std::string& file_;
  const FoundLayout& found_;
  const std::vector<CsvColumn>& wanted_;
  const ColumnMapping& mapping_;
};

/// Rewrites the lines of a table.
class PlainWriter {
 public:
  PlainWriter(std::string_view text, const std::string& file, const FoundLayout& found,
              std::vector<ReadableColumn> columns, char separator)
      : text_(text),
        file_(file),
        found_(found),
        notation_{found.layout.decimal, found.layout.thousands},
        columns_(std::move(columns)),
        separator_(separator) {}

  std::string written() {
    plain_.reserve(text_.size());
    std::size_t number = 0;
    for (std::size_t at = 0; at < text_.size();) {
      const std::size_t start = at;
      const std::string_view line = csv_next_line(text_, at);
      ++number;
      if (number == found_.layout.header_line) {
        for (const ReadableColumn& column : columns_) put(csv_field(column.name), column);
      } else if (number >= found_.layout.first_line && kind_of_line(line, found_.layout) == ForeignLine::row) {
        put_row(line, start);
      }
      plain_ += '\n';
    }
    return std::move(plain_);
  }

 private:
  void put(const std::string& field, const ReadableColumn& column) {
    if (&column != columns_.data()) plain_ += separator_;
    plain_ += field;
  }

  void put_row(std::string_view line, std::size_t start) {
    if (!row_.split(line, found_.layout.separator)) {
      throw_refusal(text_, file_, {start, "", "a quote is not closed before the separator or the end of the line", ""});
    }
    row_.drop_empty_behind(columns_.size());
    if (row_.fields().size() != columns_.size()) {
      throw_refusal(
          text_, file_,
          {start, "", "the row has " + counted(row_.fields().size(), "field", "fields"),
           fmt::format("{} as in the {}", columns_.size(), found_.layout.header_line > 0 ? "header" : "first row")});
    }
    for (const ReadableColumn& column : columns_) {
      const std::string_view field = row_.fields()[column.source.source].text;
      // What is no number is left to the reader of the table, which knows what the column may hold.
      field_.clear();
      const bool is_read = append_imported(field, column.source, notation_, buffer_, field_, expected_).empty();
      put(is_read ? field_ : csv_field(field), column);
    }
  }

  std::string_view text_;
  const std::string& file_;
  const FoundLayout& found_;
  NumberNotation notation_;
  std::vector<ReadableColumn> columns_;
  char separator_;
  ForeignRow row_;
  std::string plain_, field_, buffer_, expected_;
};

/// Whether read_csv() reads the rows and numbers of such a table.
bool has_own_layout(const TableLayout& layout) {
  return layout.separator == FieldSeparator::comma && layout.decimal == DecimalMark::point &&
         layout.thousands == ThousandsMark::none && layout.unit_line == 0 &&
         (layout.comment.empty() || layout.comment == "#");
}

}  // namespace

UnpackedFile::UnpackedFile(const std::filesystem::path& path) : mapped_(path) {
  if (!is_gzip(mapped_.text())) return;
  unpacked_ = unpacked_gzip(mapped_.text(), path.string(), ForeignTextOptions().largest_unpacked);
  if (unpacked_->empty()) throw InputError({.file = path.string()}, "the file is empty", "readings");
}

std::optional<std::string> text_in_utf8(std::string_view bytes, const std::string& file) {
  if (is_in_utf8(bytes)) return std::nullopt;
  try {
    return decode_foreign_text(bytes, file).text;
  } catch (const InputError&) {
    if (bytes.find('\0') != std::string_view::npos) throw;
    return std::nullopt;
  }
}

std::optional<std::string> plain_table(std::string_view text, const std::string& file,
                                       const std::vector<CsvColumn>& wanted, const ColumnMapping& mapping) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::optional<FoundLayout> found = readable_layout(text, file);
  if (!found || found->layout.header_line == 0) return std::nullopt;
  bool changes = !has_own_layout(found->layout) || found->layout.header_line != header_line_of_csv(text);
  const ColumnNamer namer(file, *found, wanted, mapping);
  std::vector<ReadableColumn> columns;
  // Behind a separator that ends the lines there is no column.
  std::size_t count = found->names.size();
  while (count > 1 && found->names[count - 1].empty()) --count;
  for (std::size_t i = 0; i < count; ++i) {
    columns.push_back(namer.column(i));
    changes = changes || columns.back().name != found->names[i];
  }
  if (!changes) return std::nullopt;
  return PlainWriter(text, file, *found, std::move(columns), ',').written();
}

std::optional<std::string> plain_points(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::optional<FoundLayout> found = readable_layout(text, file);
  if (!found || found->layout.header_line != 0 || found->layout.unit_line != 0) return std::nullopt;
  const TableLayout& layout = found->layout;
  if (layout.separator == FieldSeparator::blanks && layout.decimal == DecimalMark::point) return std::nullopt;
  std::vector<ReadableColumn> columns(found->names.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].source.source = i;
  return PlainWriter(text, file, *found, std::move(columns), ' ').written();
}

}  // namespace abbe
