#include "abbe/formats/import/deviation_sign.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "abbe/formats/import/foreign_number.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

constexpr std::size_t kMostRowsOfSign = 10000;

std::optional<double> value_in(const ForeignRow& row, std::size_t column, const ForeignUnit& unit,
                               const NumberNotation& notation, std::string& buffer) {
  if (column >= row.fields().size()) return std::nullopt;
  const std::string_view plain = plain_number(row.fields()[column].text, notation, buffer);
  double value = 0;
  if (plain.empty() || parse_number(plain, 0, value) != NumberProblem::none) return std::nullopt;
  return inside_number(unit, value);
}

}  // namespace

int deviation_sign(std::string_view text, const FoundLayout& found, const PositionColumns& columns) {
  const TableLayout& layout = found.layout;
  const NumberNotation notation{layout.decimal, layout.thousands};
  double as_written = 0, reversed = 0, size = 0;  // sums of what is left
  ForeignRow row;
  std::string buffer;
  std::size_t rows = 0;
  for (std::size_t at = line_start(text, layout.first_line); at < text.size() && rows < kMostRowsOfSign;) {
    const std::string_view line = csv_next_line(text, at);
    if (kind_of_line(line, layout) != ForeignLine::row || !row.split(line, layout.separator)) continue;
    ++rows;
    const auto target = value_in(row, columns.target, *columns.target_unit, notation, buffer);
    const auto deviation = value_in(row, columns.deviation, *columns.deviation_unit, notation, buffer);
    const auto actual = value_in(row, columns.actual, *columns.actual_unit, notation, buffer);
    if (!target || !deviation || !actual) continue;
    const double difference = *actual - *target;
    as_written += std::abs(difference - *deviation);
    reversed += std::abs(difference + *deviation);
    size += std::abs(*deviation);
  }
  // The better one has to explain most of the deviations.
  if (3 * std::min(as_written, reversed) > size || size == 0) return 0;
  return as_written < reversed ? 1 : -1;
}

}  // namespace abbe
