#include "abbe/formats/import/imported_rows.h"

#include <fmt/format.h>

#include "abbe/formats/import/column_source.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

struct ImportBlock : TextBlock {
  std::string csv;
  std::size_t rows = 0, blank_lines = 0, comment_lines = 0;
};

class BlockImporter {
 public:
  BlockImporter(std::string_view text, const FoundLayout& found, const std::vector<ColumnSource>& columns,
                ImportBlock& block)
      : text_(text),
        found_(found),
        notation_{found.layout.decimal, found.layout.thousands},
        columns_(columns),
        block_(block) {}

  void read() {
    block_.csv.reserve(block_.end - block_.begin);
    for (std::size_t at = block_.begin; at < block_.end;) {
      const std::size_t start = at;
      const std::string_view line = csv_next_line(text_, at);
      switch (kind_of_line(line, found_.layout)) {
        case ForeignLine::blank:
          ++block_.blank_lines;
          continue;
        case ForeignLine::comment:
          ++block_.comment_lines;
          continue;
        case ForeignLine::row:
          break;
      }
      if (!read_row(line, start)) return;
      ++block_.rows;
    }
  }

 private:
  bool refuse(std::size_t at, const std::string& field, std::string problem, std::string expected) {
    block_.refusal = TextRefusal{at, field, std::move(problem), std::move(expected)};
    return false;
  }

  bool read_row(std::string_view line, std::size_t start) {
    if (!row_.split(line, found_.layout.separator)) {
      return refuse(start, "", "a quote is not closed before the separator or the end of the line", "");
    }
    const std::size_t wanted = found_.names.size();
    row_.drop_empty_behind(wanted);
    const bool is_long = found_.short_header && row_.fields().size() == wanted && !row_.fields().back().text.empty();
    if (row_.fields().size() != wanted || is_long) {
      return refuse(start, "", "the row has " + counted(row_.fields().size(), "field", "fields"),
                    fmt::format("{} as in the {}", found_.short_header ? wanted - 1 : wanted,
                                found_.layout.header_line > 0 ? "header" : "first row"));
    }
    for (const ColumnSource& column : columns_) {
      if (&column != columns_.data()) block_.csv += ',';
      const ForeignField& field = row_.fields()[column.source];
      std::string problem = append_imported(field.text, column, notation_, buffer_, block_.csv, expected_);
      if (!problem.empty()) return refuse(start + field.at, column.name, std::move(problem), expected_);
    }
    block_.csv += '\n';
    return true;
  }

  std::string_view text_;
  const FoundLayout& found_;
  NumberNotation notation_;
  const std::vector<ColumnSource>& columns_;
  ImportBlock& block_;
  ForeignRow row_;
  std::string buffer_, expected_;
};

}  // namespace

ImportedRows imported_rows(std::string_view text, const std::string& file, const FoundLayout& found,
                           const ImportMapping& mapping, const Machine& machine, int threads) {
  const std::vector<ColumnSource> columns = column_sources(file, found, mapping, import_columns(mapping.kind, machine));
  auto blocks = split_into_blocks<ImportBlock>(text, line_start(text, found.layout.first_line));
  for_each_block(blocks.size(), threads, [&](std::size_t i) { BlockImporter(text, found, columns, blocks[i]).read(); });
  ImportedRows result;
  std::size_t size = 0;
  for (const ImportBlock& block : blocks) {
    if (block.refusal) throw_refusal(text, file, *block.refusal);
    result.rows += block.rows;
    result.blank_lines += block.blank_lines;
    result.comment_lines += block.comment_lines;
    size += block.csv.size();
  }
  if (result.rows == 0) throw InputError({.file = file}, "there are no rows below the header", "at least one row");
  for (const MappedColumn& column : mapping.columns) {
    result.csv += (result.csv.empty() ? "" : ",") + csv_field(column.name);
  }
  result.csv += '\n';
  result.csv.reserve(result.csv.size() + size);
  for (ImportBlock& block : blocks) {
    result.csv += block.csv;
    std::string().swap(block.csv);
  }
  return result;
}

std::size_t imported_line(std::string_view text, const TableLayout& layout, std::size_t row) {
  std::size_t line = layout.first_line - 1;
  for (std::size_t at = line_start(text, layout.first_line); at < text.size();) {
    ++line;
    if (kind_of_line(csv_next_line(text, at), layout) == ForeignLine::row && row-- == 0) break;
  }
  return line;
}

}  // namespace abbe
