#include "abbe/formats/import/table_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "abbe/formats/import/foreign_number.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/utf8.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kEvidences = 6, kThousands = 5;

/// Where the fields of one column show something first; bytes in the text.
struct ColumnMarks {
  std::array<std::size_t, kEvidences> evidence{};
  std::array<std::size_t, kThousands> thousands{};
  ColumnMarks() {
    evidence.fill(kNowhere);
    thousands.fill(kNowhere);
  }
  void note(const NumberMarks& marks, std::size_t at) {
    std::size_t& first = evidence[static_cast<std::size_t>(marks.evidence)];
    first = std::min(first, at);
    if (marks.thousands == ThousandsMark::none) return;
    std::size_t& first_thousands = thousands[static_cast<std::size_t>(marks.thousands)];
    first_thousands = std::min(first_thousands, at);
  }
  void join(const ColumnMarks& other) {
    for (std::size_t i = 0; i < kEvidences; ++i) evidence[i] = std::min(evidence[i], other.evidence[i]);
    for (std::size_t i = 0; i < kThousands; ++i) thousands[i] = std::min(thousands[i], other.thousands[i]);
  }
  std::size_t at(MarkEvidence which) const { return evidence[static_cast<std::size_t>(which)]; }
  std::size_t at(ThousandsMark which) const { return thousands[static_cast<std::size_t>(which)]; }
};

struct MarkBlock : TextBlock {
  std::vector<ColumnMarks> columns;
};

void look_at_block(std::string_view text, const TableLayout& layout, std::size_t columns, MarkBlock& block) {
  block.columns.resize(columns);
  ForeignRow row;
  for (std::size_t at = block.begin; at < block.end;) {
    const std::size_t start = at;
    const std::string_view line = csv_next_line(text, at);
    if (kind_of_line(line, layout) != ForeignLine::row || !row.split(line, layout.separator)) continue;
    const std::size_t count = std::min(columns, row.fields().size());
    for (std::size_t i = 0; i < count; ++i) {
      const ForeignField& field = row.fields()[i];
      if (!field.text.empty()) block.columns[i].note(marks_of_number(field.text), start + field.at);
    }
  }
}

/// What all columns of numbers show together.
ColumnMarks marks_of_table(std::string_view text, const TableLayout& layout, std::size_t columns) {
  auto blocks = split_into_blocks<MarkBlock>(text, line_start(text, layout.first_line));
  for_each_block(blocks.size(), 0, [&](std::size_t i) { look_at_block(text, layout, columns, blocks[i]); });
  ColumnMarks all;
  for (std::size_t column = 0; column < columns; ++column) {
    ColumnMarks one;
    for (const MarkBlock& block : blocks) one.join(block.columns[column]);
    if (one.at(MarkEvidence::not_a_number) == kNowhere) all.join(one);
  }
  return all;
}

/// The field that begins at a byte, for messages.
std::string field_at(std::string_view text, std::size_t at, FieldSeparator separator) {
  const std::size_t end = std::min(text.find('\n', at), text.size());
  ForeignRow row;
  if (!row.split(text.substr(at, end - at), separator) || row.fields().empty()) return "";
  return printable(row.fields()[0].text, 40, LineFeeds::escaped);
}

std::string words_of(std::string_view text, std::size_t at, FieldSeparator separator) {
  return fmt::format("'{}' in line {}", field_at(text, at, separator), text_line(text, at));
}

}  // namespace

void find_number_marks(std::string_view text, const std::string& file, std::size_t columns, const LayoutHints& hints,
                       FoundLayout& found) {
  TableLayout& layout = found.layout;
  const ColumnMarks marks = marks_of_table(text, layout, columns);
  const std::size_t point = marks.at(MarkEvidence::point), comma = marks.at(MarkEvidence::comma);
  const std::size_t perhaps_point = marks.at(MarkEvidence::point_or_thousands);
  const std::size_t perhaps_comma = marks.at(MarkEvidence::comma_or_thousands);
  const auto shown = [&](std::size_t at) { return words_of(text, at, layout.separator); };
  if (hints.decimal) {
    layout.decimal = *hints.decimal;
    found.reasons.push_back(fmt::format("decimal {}: as given", decimal_name(layout.decimal)));
  } else if (point != kNowhere && comma != kNowhere) {
    throw_refusal(
        text, file,
        {std::max(point, comma), "",
         fmt::format("has another decimal mark than an earlier number: {} and {}", shown(point), shown(comma)),
         "one decimal mark in all columns, or --decimal point or --decimal comma"});
  } else if (point != kNowhere || comma != kNowhere) {
    layout.decimal = point != kNowhere ? DecimalMark::point : DecimalMark::comma;
    found.reasons.push_back(fmt::format("decimal {}: {}", decimal_name(layout.decimal), shown(std::min(point, comma))));
  } else if (perhaps_point == kNowhere && perhaps_comma == kNowhere) {
    found.reasons.emplace_back("no decimals: all numbers are whole");
  } else if (layout.separator == FieldSeparator::comma && perhaps_comma == kNowhere) {
    found.reasons.emplace_back("decimal point: commas separate the columns");
  } else if (perhaps_point != kNowhere && perhaps_comma != kNowhere) {
    throw_refusal(text, file,
                  {std::min(perhaps_point, perhaps_comma), "",
                   fmt::format("one of {} and {} has thousands, and the table does not show which",
                               shown(perhaps_point), shown(perhaps_comma)),
                   "--decimal point or --decimal comma"});
  } else {
    const std::size_t at = std::min(perhaps_point, perhaps_comma);
    throw_refusal(
        text, file,
        {at, "", fmt::format("{} may have decimals or thousands, and the table does not show which", shown(at)),
         "--decimal point or --decimal comma"});
  }
  const bool by_point = layout.decimal == DecimalMark::point;
  // What the decimal mark is not, between three digits.
  const ThousandsMark other = by_point ? ThousandsMark::comma : ThousandsMark::point;
  std::size_t first = std::min(by_point ? perhaps_comma : perhaps_point, marks.at(other));
  layout.thousands = first == kNowhere ? ThousandsMark::none : other;
  for (const ThousandsMark mark : {ThousandsMark::blank, ThousandsMark::apostrophe}) {
    const std::size_t at = marks.at(mark);
    if (at == kNowhere) continue;
    if (layout.thousands != ThousandsMark::none) {
      throw_refusal(
          text, file,
          {std::max(at, first), "",
           fmt::format("has another mark of thousands than an earlier number: {} and {}", shown(first), shown(at)),
           "one mark in all columns"});
    }
    layout.thousands = mark;
    first = at;
  }
  if (layout.thousands != ThousandsMark::none) {
    found.reasons.push_back(fmt::format("thousands by {}: {}", thousands_name(layout.thousands), shown(first)));
  }
}

}  // namespace abbe
