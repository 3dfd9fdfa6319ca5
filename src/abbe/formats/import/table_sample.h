#pragma once

// Internal to formats: the first lines of a table, looked at before its layout is known.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/table_layout.h"

namespace abbe {

struct SampleLine {
  std::string_view text;
  std::size_t number = 0;  ///< from 1
};

/// The first lines that are not blank, at most 2000.
std::vector<SampleLine> sample_lines(std::string_view text);

/// What comment lines begin with: "#", "%", "//" or "!"; empty if no line does, or if so many do that it belongs to
/// the rows, such as points called "#1".
std::string comment_mark_of(const std::vector<SampleLine>& lines);

/// How one separator splits the lines.
struct SplitLines {
  FieldSeparator separator = FieldSeparator::comma;
  std::size_t columns = 0;                   ///< of most lines with numbers
  std::size_t lines = 0;                     ///< with so many fields, and a number among them
  std::size_t numbers = 0;                   ///< in these lines
  std::vector<std::vector<bool>> is_number;  ///< [all lines of the sample][fields]
  std::vector<std::vector<bool>> is_empty;   ///< likewise
  std::vector<bool> number_column;           ///< [columns] a number in half of these lines or more

  /// Whether a line of the sample has the columns of the others, and numbers in half of the columns of numbers.
  bool is_row(std::size_t line) const;
  bool has_number(std::size_t line) const;
};

SplitLines split_sample(const std::vector<SampleLine>& lines, FieldSeparator separator, const std::string& comment);

/// The separator that makes the most of the lines; none if no separator gives two columns.
std::optional<SplitLines> best_split(const std::vector<SampleLine>& lines, const std::string& comment);

}  // namespace abbe
