#include "abbe/formats/evaluations/temperature_record.h"

#include <fmt/format.h>

#include <numeric>
#include <vector>

#include "abbe/formats/evaluations/sensor_columns.h"
#include "abbe/formats/import/readable_table.h"

namespace abbe {
namespace {

std::vector<CsvColumn> record_columns() {
  CsvColumn machine{"machine", Quantity::temperature, false, false, CsvColumn::Range::any};
  machine.may_be_empty = true;
  CsvColumn instrument = machine;
  instrument.base = "instrument";
  return {{"time", Quantity::time, false, true, CsvColumn::Range::any}, machine, instrument};
}

TemperatureRecord record_of(const PlacedTable& csv, const std::string& file) {
  const std::vector<CsvColumn> wanted = record_columns();
  std::vector<std::size_t> rows(csv.rows);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto series_of = [&](std::size_t column) -> std::optional<TimeSeries> {
    if (!csv.columns[column].present) return std::nullopt;
    TimeSeries series = sensor_series(csv, 0, column, wanted[column], rows);
    if (series.time.size() < 2) {
      throw InputError(csv.place(csv.columns[column].header), fmt::format("{} readings", series.time.size()),
                       "two at least");
    }
    return series;
  };
  TemperatureRecord record{file, series_of(1), series_of(2)};
  if (record.machine || record.instrument) return record;
  throw InputError(csv.place("machine_degC"), "missing column", "machine_degC, instrument_degC or both");
}

}  // namespace

TemperatureRecord parse_temperature_record(std::string_view text, const std::string& file,
                                           const ColumnMapping& mapping) {
  return record_of({text, file, record_columns(), mapping}, file);
}

TemperatureRecord parse_temperature_record(const NamedColumns& columns) {
  return record_of({columns, record_columns()}, "temperatures");
}

TemperatureRecord read_temperature_record(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, record_columns(), mapping, [&](std::string_view text) {
    return parse_temperature_record(text, path.string(), mapping);
  });
}

}  // namespace abbe
