#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/evaluations/diagonals.h"
#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// Positioning readings of one axis as they stand in a file.
struct PositioningFile {
  bool rotary = false;                       ///< targets and deviations are rad, else mm
  std::vector<PositioningReading> readings;  ///< in the order of the file
  /// Of the axis and of the instrument, degC, and when each reading was taken, s; [readings], or empty: not in the
  /// file.
  std::vector<double> machine_temperature{}, instrument_temperature{}, time{};
};

/// Reads positioning readings from a CSV: columns `target_mm` (or `_deg` for a rotary axis), `direction` (+ or -),
/// `deviation_um` (or `_arcsec`) or `actual_mm` (or `_deg`), and optionally `run`, which may hold any name, and, of a
/// linear axis, `machine_degC`, `instrument_degC` and `time_min`; see docs/evaluate.md. Every row counts or is an
/// error.
/// @param mapping  of a file whose columns have other names
/// @throws InputError also for a target that one run approaches twice from the same side, and for an actual angle more
///         than half a turn from its target
PositioningFile read_positioning(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
PositioningFile parse_positioning(std::string_view text, const std::string& file, const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
PositioningFile parse_positioning(const NamedColumns& columns);

/// Reads displacements along diagonals: the same columns in lengths, and `diagonal` with the name of the diagonal.
/// @param mapping  of a file whose columns have other names
/// @return in order of appearance
std::vector<DiagonalReadings> read_diagonals(const std::filesystem::path& path, const ColumnMapping& mapping = {});
std::vector<DiagonalReadings> parse_diagonals(std::string_view text, const std::string& file,
                                              const ColumnMapping& mapping = {});
std::vector<DiagonalReadings> parse_diagonals(const NamedColumns& columns);

}  // namespace abbe
