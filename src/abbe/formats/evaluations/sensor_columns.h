#pragma once

// Internal to formats: columns of sensors whose names a file chooses.
#include <cstddef>
#include <string>
#include <vector>

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

/// The readings of a column in some rows, without the empty fields.
/// @param time  column of the times
/// @throws InputError for times that do not increase, temperatures below absolute zero, and fewer than two readings
TimeSeries sensor_series(const PlacedTable& table, std::size_t time, std::size_t column, const CsvColumn& wanted,
                         const std::vector<std::size_t>& rows);

}  // namespace abbe
