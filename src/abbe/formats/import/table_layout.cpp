#include "abbe/formats/import/table_layout.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/table_marks.h"
#include "abbe/formats/import/table_sample.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

constexpr const char* kExpectedTable =
    "a table of at least two columns, separated by commas, semicolons, tabs or blanks; --separator names them";

/// Texts of a line that may be the header, `columns` of them; empty if it cannot be.
/// @param is_short  becomes true if it has one field less than the rows
std::vector<std::string> texts_of(std::string_view line, const TableLayout& layout, std::size_t columns,
                                  bool& is_short) {
  ForeignRow row;
  if (!row.split(without_comment_mark(line, layout.comment), layout.separator)) return {};
  row.drop_empty_behind(columns);
  const std::size_t count = row.fields().size();
  // Rows of some programs end in a separator that their header lacks.
  is_short = count + 1 == columns && layout.separator != FieldSeparator::blanks && count >= 2;
  if (count != columns && !is_short) return {};
  std::vector<std::string> texts;
  for (const ForeignField& field : row.fields()) texts.emplace_back(field.text);
  texts.resize(columns);
  return texts;
}

/// Whether all texts are units or empty.
bool are_units(const std::vector<std::string>& texts) {
  bool any = false;
  for (const std::string& text : texts) {
    if (text.empty() || text == "-") continue;
    if (!is_foreign_unit(without_brackets(text))) return false;
    any = true;
  }
  return any;
}

/// Header and row of units above the first row of a sample.
class HeaderFinder {
 public:
  HeaderFinder(const std::vector<SampleLine>& lines, const SplitLines& split, FoundLayout& found)
      : lines_(lines), split_(split), found_(found) {}

  void find(std::size_t first) {
    found_.names.assign(split_.columns, "");
    found_.units.assign(split_.columns, "");
    std::size_t at = next_above(first, false);
    bool is_short = false;
    if (at < first && are_units(texts(at, is_short))) {
      found_.layout.unit_line = lines_[at].number;
      found_.units = texts(at, is_short);
      at = next_above(at, false);
    }
    if (take_header(at)) return;
    take_header(next_above(first, true));
  }

 private:
  std::vector<std::string> texts(std::size_t line, bool& is_short) const {
    return texts_of(lines_[line].text, found_.layout, split_.columns, is_short);
  }
  bool is_comment(std::size_t line) const {
    const std::string& mark = found_.layout.comment;
    return !mark.empty() && csv_trimmed(lines_[line].text).starts_with(mark);
  }
  /// The nearest line above one that is a comment or is none; npos if there is no such line.
  std::size_t next_above(std::size_t line, bool comment) const {
    while (line-- > 0 && line < lines_.size()) {
      if (is_comment(line) == comment) return line;
    }
    return lines_.size();
  }
  bool take_header(std::size_t line) {
    if (line >= lines_.size() || split_.has_number(line)) return false;
    bool is_short = false;
    std::vector<std::string> names = texts(line, is_short);
    if (names.empty()) return false;
    found_.short_header = is_short;
    found_.names = std::move(names);
    found_.layout.header_line = lines_[line].number;
    return true;
  }

  const std::vector<SampleLine>& lines_;
  const SplitLines& split_;
  FoundLayout& found_;
};

std::size_t index_of_first_row(const std::vector<SampleLine>& lines, const SplitLines& split) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (split.is_row(i)) return i;
  }
  return lines.size();
}

/// Comments between the rows that would be rows without their mark.
void doubt_comments(const std::vector<SampleLine>& lines, std::size_t first, const SplitLines& split,
                    FoundLayout& found) {
  const std::string& mark = found.layout.comment;
  if (mark.empty()) return;
  ForeignRow row;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (!csv_trimmed(lines[i].text).starts_with(mark)) continue;
    if (!row.split(without_comment_mark(lines[i].text, mark), split.separator)) continue;
    if (row.fields().size() != split.columns) continue;
    found.doubts.push_back(
        fmt::format("line {} begins with {} and looks like a row; it is skipped", lines[i].number, mark));
    return;
  }
}

[[noreturn]] void refuse_line(const std::string& file, std::size_t line, const char* what) {
  throw InputError({.file = file, .line = line}, fmt::format("is not {}", what), "the layout of the mapping");
}

}  // namespace

std::vector<std::string_view> separator_names() { return {"comma", "semicolon", "tab", "blanks"}; }
std::vector<std::string_view> decimal_names() { return {"point", "comma"}; }
std::vector<std::string_view> thousands_names() { return {"none", "comma", "point", "blank", "apostrophe"}; }
std::string_view separator_name(FieldSeparator separator) {
  return separator_names()[static_cast<std::size_t>(separator)];
}
std::string_view decimal_name(DecimalMark decimal) { return decimal_names()[static_cast<std::size_t>(decimal)]; }
std::string_view thousands_name(ThousandsMark thousands) {
  return thousands_names()[static_cast<std::size_t>(thousands)];
}

std::string column_words(std::size_t column, std::string_view name) {
  const std::string words = fmt::format("column {}", column + 1);
  return name.empty() ? words : fmt::format("{} '{}'", words, printable(name, 60, LineFeeds::escaped));
}

FoundLayout find_layout(std::string_view text, const std::string& file, const LayoutHints& hints) {
  const std::vector<SampleLine> lines = sample_lines(text);
  FoundLayout found;
  TableLayout& layout = found.layout;
  layout.comment = comment_mark_of(lines);
  const std::optional<SplitLines> best = hints.separator
                                             ? std::optional(split_sample(lines, *hints.separator, layout.comment))
                                             : best_split(lines, layout.comment);
  if (!best || best->columns < 2) {
    throw InputError({.file = file, .line = lines.empty() ? 0 : lines.front().number}, "no table was found",
                     kExpectedTable);
  }
  layout.separator = best->separator;
  const std::size_t first = index_of_first_row(lines, *best);
  if (first == lines.size()) throw InputError({.file = file}, "no rows of numbers were found", kExpectedTable);
  layout.first_line = lines[first].number;
  found.reasons.push_back(hints.separator ? fmt::format("separated by {}: as given", separator_name(layout.separator))
                                          : fmt::format("separated by {}: gives {} columns",
                                                        separator_name(layout.separator), best->columns));
  HeaderFinder(lines, *best, found).find(first);
  if (layout.header_line > 0)
    found.reasons.push_back(fmt::format("names of the columns in line {}", layout.header_line));
  if (layout.unit_line > 0) found.reasons.push_back(fmt::format("units in line {}", layout.unit_line));
  found.reasons.push_back(fmt::format("rows from line {} on", layout.first_line));
  find_number_marks(text, file, best->columns, hints, found);
  doubt_comments(lines, first, *best, found);
  return found;
}

FoundLayout layout_as_given(std::string_view text, const std::string& file, const TableLayout& layout) {
  FoundLayout found;
  found.layout = layout;
  std::size_t columns = 0;
  ForeignRow row;
  for (std::size_t at = line_start(text, layout.first_line); at < text.size() && columns == 0;) {
    const std::string_view line = csv_next_line(text, at);
    if (kind_of_line(line, layout) != ForeignLine::row) continue;
    if (!row.split(line, layout.separator)) refuse_line(file, layout.first_line, "a row: a quote is not closed");
    columns = row.fields().size();
  }
  if (columns == 0) {
    throw InputError({.file = file}, fmt::format("there are no rows from line {} on", layout.first_line),
                     "at least one row");
  }
  const auto texts = [&](std::size_t number, bool& is_short) {
    std::size_t at = line_start(text, number);
    return at < text.size() ? texts_of(csv_next_line(text, at), layout, columns, is_short) : std::vector<std::string>();
  };
  found.names.assign(columns, "");
  found.units.assign(columns, "");
  if (layout.header_line > 0) {
    found.names = texts(layout.header_line, found.short_header);
    if (found.names.empty()) {
      refuse_line(file, layout.header_line, fmt::format("a header of the {} columns of the rows", columns).c_str());
    }
  }
  if (layout.unit_line > 0) {
    bool ignored = false;
    found.units = texts(layout.unit_line, ignored);
    if (!are_units(found.units)) refuse_line(file, layout.unit_line, "a row of units");
  }
  return found;
}

}  // namespace abbe
