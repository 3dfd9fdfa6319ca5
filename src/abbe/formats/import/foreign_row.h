#pragma once

// Internal to formats: lines and fields of tables that other programs wrote.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/table_layout.h"

namespace abbe {

struct ForeignField {
  std::string_view text;  ///< without quotes and the blanks around it
  std::size_t at = 0;     ///< byte in the line
};

/// The fields of one line; made once and used for many.
class ForeignRow {
 public:
  /// The fields are valid until the next call, and as long as the line.
  /// @returns false if a quote is not closed before the separator or the end of the line
  bool split(std::string_view line, FieldSeparator separator);
  const std::vector<ForeignField>& fields() const { return fields_; }
  /// Takes empty fields behind the last one that `columns` has: rows of some programs end in separators.
  void drop_empty_behind(std::size_t columns);

 private:
  const char* take_quoted(const char* at, const char* end);

  std::vector<ForeignField> fields_;
  std::string unquoted_;
};

/// What a line at or below the first row is.
enum class ForeignLine { row, blank, comment };

/// Blank is also a line of nothing but separators, as spreadsheets write below their tables.
ForeignLine kind_of_line(std::string_view line, const TableLayout& layout);

/// Byte where a line begins, counted from 1; the end of the text if it has fewer.
std::size_t line_start(std::string_view text, std::size_t line);

/// A line without the mark of comments in front: headers of some programs are comments.
std::string_view without_comment_mark(std::string_view line, std::string_view comment);

}  // namespace abbe
