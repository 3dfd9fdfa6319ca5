#include "abbe/formats/evaluations/evaluation_line_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/placed_table.h"

namespace abbe {
namespace {

const std::vector<CsvColumn>& line_columns(bool with_line) {
  static const std::vector<CsvColumn> plain = {{"position", Quantity::length}, {"deviation", Quantity::length}};
  static const std::vector<CsvColumn> named = {plain[0], plain[1], {"line", Quantity::dimensionless, true, true}};
  return with_line ? named : plain;
}

/// @param rows  of the file that belong to this line
LineReadings line_of(const PlacedTable& csv, const std::vector<std::size_t>& rows, const std::string& name) {
  LineReadings line;
  line.name = name;
  const std::vector<double>& positions = csv.columns[0].numbers;
  std::vector<std::size_t> order = rows;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  std::size_t different = order.empty() ? 0 : 1;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const double distance = positions[order[i]] - positions[order[i - 1]];
    if (distance > 0 && distance < kNearlySamePosition) {
      const auto [first, second] = std::minmax(order[i - 1], order[i]);
      throw InputError(csv.place(second, csv.columns[0].header),
                       fmt::format("this position is nearly the same as that of {}: {:.3g} mm from it",
                                   csv.row_words(first), distance),
                       "the same position, or at least 1e-6 mm between positions");
    }
    if (distance > 0) ++different;
  }
  if (different < 3) {
    throw InputError(csv.place(csv.columns[0].header),
                     fmt::format("{} different position{}{}", different, different == 1 ? "" : "s",
                                 name.empty() ? "" : " on line '" + name.substr(0, 40) + "'"),
                     "at least three: two points are always straight");
  }
  for (const std::size_t row : rows) {
    line.positions.push_back(positions[row]);
    line.deviations.push_back(csv.columns[1].numbers[row]);
  }
  return line;
}

LineReadings straightness_of(const PlacedTable& csv) {
  std::vector<std::size_t> rows(csv.rows);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return line_of(csv, rows, "");
}

std::array<LineReadings, 2> squareness_of(const PlacedTable& csv) {
  const CsvValues& names = csv.columns[2];
  if (names.names.size() != 2) {
    throw InputError(csv.place(names.header),
                     fmt::format("{} line{} named", names.names.size(), names.names.size() == 1 ? " is" : "s are"),
                     "two lines, such as X and Y");
  }
  std::array<std::vector<std::size_t>, 2> rows;
  for (std::size_t row = 0; row < csv.rows; ++row) rows[names.words[row]].push_back(row);
  return {line_of(csv, rows[0], names.names[0]), line_of(csv, rows[1], names.names[1])};
}

}  // namespace

LineReadings read_straightness(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, line_columns(false), mapping,
                             [&](std::string_view text) { return parse_straightness(text, path.string(), mapping); });
}

LineReadings parse_straightness(std::string_view text, const std::string& file, const ColumnMapping& mapping) {
  return straightness_of({text, file, line_columns(false), mapping});
}

LineReadings parse_straightness(const NamedColumns& columns) { return straightness_of({columns, line_columns(false)}); }

std::array<LineReadings, 2> read_squareness(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, line_columns(true), mapping,
                             [&](std::string_view text) { return parse_squareness(text, path.string(), mapping); });
}

std::array<LineReadings, 2> parse_squareness(std::string_view text, const std::string& file,
                                             const ColumnMapping& mapping) {
  return squareness_of({text, file, line_columns(true), mapping});
}

std::array<LineReadings, 2> parse_squareness(const NamedColumns& columns) {
  return squareness_of({columns, line_columns(true)});
}

}  // namespace abbe
