#pragma once

// Internal to formats: columns of sensors whose names a file chooses.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/named_columns.h"
#include "abbe/formats/text/placed_table.h"
#include "abbe/verify/thermal/time_series.h"

namespace abbe {

/// The wanted columns and, behind them, one for each other name that ends in a unit of a length, an angle or a
/// temperature; fields of those may be empty.
/// @param known  columns with names of their own; those of them that begin a name are read by that name
/// @throws InputError for a name without such a unit
std::vector<CsvColumn> with_sensor_columns(std::string_view text, const std::string& file, const ColumnMapping& mapping,
                                           std::vector<CsvColumn> known);
std::vector<CsvColumn> with_sensor_columns(const NamedColumns& columns, std::vector<CsvColumn> known);

/// The known columns and, behind them, one for each name with a unit of a length or an angle as other programs write
/// it: "Z1 [mm]", or a row of units. For plain_table(); where no table is found, the known ones alone.
std::vector<CsvColumn> with_foreign_sensors(std::string_view text, const std::string& file,
                                            std::vector<CsvColumn> known);

/// What `parse` makes of a file of sensors that may be packed, in another encoding, or a table that Abbe did not write.
template <class Parse>
auto read_sensor_table(const std::filesystem::path& path, const std::vector<CsvColumn>& known,
                       const ColumnMapping& mapping, const Parse& parse) {
  const UnpackedFile file(path);
  const std::optional<std::string> decoded = text_in_utf8(file.text(), path.string());
  const std::string_view text = decoded ? std::string_view(*decoded) : file.text();
  return parse_readable_table(text, path.string(), with_foreign_sensors(text, path.string(), known), mapping, parse);
}

/// The readings of a column in some rows, without the empty fields.
/// @param time  column of the times
/// @throws InputError for times that do not increase, temperatures below absolute zero, and fewer than two readings
TimeSeries sensor_series(const PlacedTable& table, std::size_t time, std::size_t column, const CsvColumn& wanted,
                         const std::vector<std::size_t>& rows);

}  // namespace abbe
