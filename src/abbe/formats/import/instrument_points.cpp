#include "abbe/formats/import/instrument_points.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {

void InstrumentPoints::add(std::string_view name, const std::array<std::string_view, 3>& coordinates, std::size_t line,
                           const std::array<std::string_view, 3>* normal) {
  Point& point = points_.emplace_back();
  // A name stays on the line of its row.
  point.name = printable(name, 200, LineFeeds::escaped);
  point.line = line;
  for (std::size_t k = 0; k < 3; ++k) {
    point.coordinates[k] = coordinates[k];
    if (normal != nullptr) point.normal[k] = (*normal)[k];
  }
}

void InstrumentPoints::write(const PointUnit& unit, const std::vector<std::string>& names,
                             InstrumentTable& table) const {
  table.kind = ImportKind::points;
  table.columns.push_back({names[0], "point", "", true, "its name"});
  for (std::size_t k = 0; k < 3; ++k) {
    InstrumentColumn column{names[k + 1], std::string(1, static_cast<char>('x' + k)), unit.name, unit.is_stated,
                            unit.reason};
    if (!unit.doubt.empty()) column.doubts.push_back(unit.doubt);
    table.columns.push_back(std::move(column));
  }
  const bool normals = names.size() == 7 && std::all_of(points_.begin(), points_.end(),
                                                        [](const Point& point) { return !point.normal[0].empty(); });
  for (std::size_t k = 0; normals && k < 3; ++k) {
    table.columns.push_back(
        {names[k + 4], fmt::format("n{}", static_cast<char>('x' + k)), "", true, "the direction of the surface"});
  }
  for (const Point& point : points_) {
    table.rows += fmt::format("{},{}", csv_field(point.name), fmt::join(point.coordinates, ","));
    if (normals) table.rows += fmt::format(",{}", fmt::join(point.normal, ","));
    table.rows += '\n';
    table.lines.push_back(point.line);
  }
}

}  // namespace abbe
