#include "abbe/formats/evaluations/sensor_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/table_layout.h"
#include "abbe/formats/text/csv_header.h"

namespace abbe {
namespace {

constexpr double kAbsoluteZero = -273.15;

/// What a name without a base of its own holds; nothing if it does not end in a unit of a sensor.
std::optional<CsvColumn> sensor_column(const std::string& name) {
  for (const Quantity quantity : {Quantity::length, Quantity::angle, Quantity::temperature}) {
    for (const Unit& unit : units_of(quantity)) {
      const std::string end = "_" + std::string(unit.suffix);
      if (name.size() <= end.size() || !name.ends_with(end)) continue;
      CsvColumn column{name.substr(0, name.size() - end.size()), quantity, false, false, CsvColumn::Range::any};
      column.may_be_empty = true;
      return column;
    }
  }
  return std::nullopt;
}

bool is_read_by(const std::string& name, const CsvColumn& known) {
  return name == known.base || (!known.is_text && name.starts_with(known.base + "_"));
}

/// @param name  ours
void add_sensor(const std::string& name, const InputError::Place& place, const std::string& ignored_by,
                std::size_t known, std::vector<CsvColumn>& columns) {
  const auto end = columns.begin() + static_cast<std::ptrdiff_t>(known);
  if (std::any_of(columns.begin(), end, [&](const CsvColumn& column) { return is_read_by(name, column); })) return;
  // Empty names and other separators than commas are refused when the header is read.
  if (name.empty() || name.find_first_of(";\t") != std::string::npos) return;
  const std::optional<CsvColumn> sensor = sensor_column(name);
  if (!sensor) {
    throw InputError(place, "the name of this column does not end in a unit of a length, an angle or a temperature",
                     "a name such as X1_um, A_urad or air_degC" +
                         (ignored_by.empty() ? std::string() : "; or this one under " + ignored_by));
  }
  for (auto other = end; other != columns.end(); ++other) {
    if (other->base != sensor->base || other->quantity == Quantity::temperature ||
        sensor->quantity == Quantity::temperature) {
      continue;
    }
    if (other->quantity == sensor->quantity) return;  // the same in two units is refused when the header is read
    throw InputError(place, fmt::format("'{}' is a displacement and an angle", sensor->base), "sensors of other names");
  }
  columns.push_back(*sensor);
}

}  // namespace

std::vector<CsvColumn> with_sensor_columns(std::string_view text, const std::string& file, const ColumnMapping& mapping,
                                           std::vector<CsvColumn> known) {
  const std::size_t count = known.size();
  const CsvNames header = csv_names(text);
  for (const std::string& name : header.names) {
    if (std::find(mapping.ignore.begin(), mapping.ignore.end(), name) != mapping.ignore.end()) continue;
    const auto mapped = std::find_if(mapping.columns.begin(), mapping.columns.end(),
                                     [&](const auto& entry) { return entry.second == name; });
    add_sensor(mapped == mapping.columns.end() ? name : mapped->first, {file, header.line, 0, name}, mapping.ignored_by,
               count, known);
  }
  return known;
}

std::vector<CsvColumn> with_sensor_columns(const NamedColumns& columns, std::vector<CsvColumn> known) {
  const std::size_t count = known.size();
  for (const NamedColumn& column : columns) add_sensor(column.name, {.field = column.name}, "", count, known);
  return known;
}

std::vector<CsvColumn> with_foreign_sensors(std::string_view text, const std::string& file,
                                            std::vector<CsvColumn> known) {
  const std::size_t count = known.size();
  FoundLayout found;
  try {
    found = find_layout(text, file);
  } catch (const InputError&) {
    return known;  // what is wrong with it, the reader of the table says
  }
  for (std::size_t i = 0; i < found.names.size(); ++i) {
    auto [name, unit] = split_header(found.names[i]);
    const std::string row(without_brackets(found.units[i]));
    if (!row.empty() && row != "-") {
      name = unit.empty() ? found.names[i] : name;
      unit = row;
    }
    const auto end = known.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::any_of(known.begin(), end, [&, &base = name](const CsvColumn& column) { return column.base == base; }))
      continue;
    for (const Quantity quantity : {Quantity::length, Quantity::angle}) {
      if (foreign_unit(unit, quantity) == nullptr) continue;
      known.push_back({name, quantity, false, false, CsvColumn::Range::any});
      known.back().may_be_empty = true;
    }
  }
  return known;
}

TimeSeries sensor_series(const PlacedTable& table, std::size_t time, std::size_t column, const CsvColumn& wanted,
                         const std::vector<std::size_t>& rows) {
  const CsvValues& times = table.columns[time];
  const CsvValues& values = table.columns[column];
  TimeSeries series{wanted.base, {}, {}};
  for (const std::size_t row : rows) {
    const double value = values.numbers[row], at = times.numbers[row];
    if (std::isnan(value)) continue;
    if (wanted.quantity == Quantity::temperature && value < kAbsoluteZero) {
      throw InputError(table.place(row, values.header),
                       fmt::format("{:.9g} \xC2\xB0\x43 is below absolute zero", value),
                       "a temperature in \xC2\xB0\x43");
    }
    if (!series.time.empty() && at <= series.to()) {
      throw InputError(table.place(row, times.header), fmt::format("{:.9g} s follows {:.9g} s", at, series.to()),
                       "rows in chronological order; times must not restart at midnight");
    }
    series.time.push_back(at);
    series.values.push_back(value);
  }
  return series;
}

}  // namespace abbe
