#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/named_columns.h"

namespace abbe {

/// Deviations read at positions along a line.
struct LineReadings {
  std::string name;                ///< of the line; empty in a file of straightness
  std::vector<double> positions;   ///< [n] mm, in the order of the file
  std::vector<double> deviations;  ///< [n] mm
};

/// Positions of one line are either the same or at least this far apart, mm: nearer ones are a mistake of whoever wrote
/// the file, and a line through them means nothing.
inline constexpr double kNearlySamePosition = 1e-6;

/// @param mapping  of a file whose columns have other names
/// Reads a CSV of straightness: `position` and `deviation`, at three different positions at least. @throws InputError
LineReadings read_straightness(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
LineReadings parse_straightness(std::string_view text, const std::string& file, const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
LineReadings parse_straightness(const NamedColumns& columns);

/// Reads a CSV of squareness: the same with a column `line` that names two lines; the first named one is the reference.
/// @param mapping  of a file whose columns have other names
/// @throws InputError
std::array<LineReadings, 2> read_squareness(const std::filesystem::path& path, const ColumnMapping& mapping = {});
std::array<LineReadings, 2> parse_squareness(std::string_view text, const std::string& file,
                                             const ColumnMapping& mapping = {});
std::array<LineReadings, 2> parse_squareness(const NamedColumns& columns);

}  // namespace abbe
