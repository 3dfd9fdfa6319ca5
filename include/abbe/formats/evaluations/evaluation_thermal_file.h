#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/thermal/axis_distortion.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

// Readings of thermal tests. Sensors have names of their own; the unit in the name of a column says what it holds:
// X1_um a displacement, A_urad an angle, air_degC a temperature. A field may be empty: the sensor was not read then.

/// Reads a CSV of sensors over time: `time` and one column per sensor, two readings of each at least, of which one
/// sensor at least is a displacement or an angle. Rows are in the order of time. See docs/evaluate-thermal.md.
/// @param mapping  of a file whose columns have other names
/// @throws InputError
ThermalReadings read_thermal(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
ThermalReadings parse_thermal(std::string_view text, const std::string& file, const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
ThermalReadings parse_thermal(const NamedColumns& columns);

/// Reads a CSV of deviations at targets of a linear axis over time: `time`, `target`, `deviation` or `actual`,
/// optionally `direction` of approach, and columns of other sensors. Two targets at least, each read twice at least.
/// @throws InputError
AxisDistortionReadings read_axis_distortion(const std::filesystem::path& path, const ColumnMapping& mapping = {});
AxisDistortionReadings parse_axis_distortion(std::string_view text, const std::string& file,
                                             const ColumnMapping& mapping = {});
AxisDistortionReadings parse_axis_distortion(const NamedColumns& columns);

}  // namespace abbe
