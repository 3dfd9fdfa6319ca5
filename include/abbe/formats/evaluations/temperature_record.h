#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/thermal/time_series.h"

namespace abbe {

/// Temperatures of a machine's axis and of an instrument over time, besides the readings of a test.
struct TemperatureRecord {
  std::string file;                               ///< name for messages
  std::optional<TimeSeries> machine, instrument;  ///< degC; at least one of them
};

/// Reads a CSV with `time`, and `machine` or `instrument` or both as temperatures (machine_degC); other columns have to
/// be left out by `mapping`. A field may be empty. Two readings of each at least, in the order of time.
/// @throws InputError
TemperatureRecord read_temperature_record(const std::filesystem::path& path, const ColumnMapping& mapping = {});
TemperatureRecord parse_temperature_record(std::string_view text, const std::string& file,
                                           const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
TemperatureRecord parse_temperature_record(const NamedColumns& columns);

}  // namespace abbe
