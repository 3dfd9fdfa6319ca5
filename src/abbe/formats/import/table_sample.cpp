#include "abbe/formats/import/table_sample.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "abbe/formats/import/foreign_number.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/text/csv_header.h"

namespace abbe {
namespace {

constexpr std::size_t kSampleLines = 2000;
constexpr std::array<std::string_view, 4> kCommentMarks = {"#", "%", "//", "!"};

bool is_number_of_any_kind(std::string_view field) {
  return marks_of_number(field).evidence != MarkEvidence::not_a_number || is_sexagesimal(field);
}

/// Share of the lines with numbers that have the columns of the others, and of their fields that are numbers.
double quality(const SplitLines& split, std::size_t lines_with_digits) {
  if (split.columns < 2 || lines_with_digits == 0) return 0;
  const double kept = static_cast<double>(split.lines) / static_cast<double>(lines_with_digits);
  return kept * static_cast<double>(split.numbers) / static_cast<double>(split.lines * split.columns);
}

}  // namespace

std::vector<SampleLine> sample_lines(std::string_view text) {
  std::vector<SampleLine> lines;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size() && lines.size() < kSampleLines;) {
    const std::string_view line = csv_next_line(text, at);
    ++number;
    if (line.find_first_not_of(" \t;,") != std::string_view::npos) lines.push_back({line, number});
  }
  return lines;
}

std::string comment_mark_of(const std::vector<SampleLine>& lines) {
  for (const SampleLine& line : lines) {
    for (const std::string_view mark : kCommentMarks) {
      if (!csv_trimmed(line.text).starts_with(mark)) continue;
      std::size_t with = 0;
      for (const SampleLine& other : lines) with += csv_trimmed(other.text).starts_with(mark) ? 1U : 0U;
      // Comments stand above the rows; points called "#1" stand below a header and a row of units.
      const std::size_t others = lines.size() - with;
      const bool first = csv_trimmed(lines.front().text).starts_with(mark);
      if (others == 0 || (!first && with > others && others <= 3)) return "";
      return std::string(mark);
    }
  }
  return "";
}

bool SplitLines::has_number(std::size_t line) const {
  return std::find(is_number[line].begin(), is_number[line].end(), true) != is_number[line].end();
}

bool SplitLines::is_row(std::size_t line) const {
  const std::vector<bool>& fields = is_number[line];
  if (fields.size() != columns) return false;
  std::size_t expected = 0, found = 0;
  for (std::size_t i = 0; i < columns; ++i) {
    expected += number_column[i] ? 1U : 0U;
    found += number_column[i] && fields[i] ? 1U : 0U;
  }
  return found > 0 && 2 * found >= expected;
}

SplitLines split_sample(const std::vector<SampleLine>& lines, FieldSeparator separator, const std::string& comment) {
  SplitLines result;
  result.separator = separator;
  ForeignRow row;
  for (const SampleLine& line : lines) {
    std::vector<bool>& numbers = result.is_number.emplace_back();
    std::vector<bool>& empty = result.is_empty.emplace_back();
    if (!comment.empty() && csv_trimmed(line.text).starts_with(comment)) continue;
    if (!row.split(line.text, separator)) continue;
    for (const ForeignField& field : row.fields()) {
      numbers.push_back(is_number_of_any_kind(field.text));
      empty.push_back(field.text.empty());
    }
  }
  std::map<std::size_t, std::size_t> lines_of_count;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (result.has_number(i)) ++lines_of_count[result.is_number[i].size()];
  }
  for (const auto& [columns, count] : lines_of_count) {
    if (columns >= 2 && count >= result.lines) {
      result.columns = columns;
      result.lines = count;
    }
  }
  std::vector<std::size_t> numbers_in(result.columns);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!result.has_number(i) || result.is_number[i].size() != result.columns) continue;
    for (std::size_t k = 0; k < result.columns; ++k) numbers_in[k] += result.is_number[i][k] ? 1U : 0U;
  }
  for (const std::size_t count : numbers_in) {
    result.numbers += count;
    result.number_column.push_back(2 * count >= result.lines && count > 0);
  }
  return result;
}

std::optional<SplitLines> best_split(const std::vector<SampleLine>& lines, const std::string& comment) {
  std::size_t with_digits = 0;
  for (const SampleLine& line : lines) {
    const bool is_comment = !comment.empty() && csv_trimmed(line.text).starts_with(comment);
    with_digits += !is_comment && line.text.find_first_of("0123456789") != std::string_view::npos ? 1U : 0U;
  }
  std::optional<SplitLines> best;
  double best_quality = 0;
  // A tab or a semicolon is rarely in a field; a comma may be in a number, and a blank in a name.
  for (const auto& [separator, preferred] :
       {std::pair(FieldSeparator::tab, true), std::pair(FieldSeparator::semicolon, true),
        std::pair(FieldSeparator::comma, false), std::pair(FieldSeparator::blanks, false)}) {
    SplitLines split = split_sample(lines, separator, comment);
    const double how_good = quality(split, with_digits);
    if (!(how_good > best_quality)) continue;
    best_quality = how_good;
    best = std::move(split);
    if (preferred && 3 * best->lines >= 2 * with_digits) break;
  }
  return best;
}

}  // namespace abbe
