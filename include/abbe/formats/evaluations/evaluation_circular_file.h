#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/evaluations/circular.h"

namespace abbe {

/// Readings of a circular test.
struct CircularFile {
  std::array<CircularReadings, 2> paths;  ///< by CircularDirection, in the order of the file; one may be empty
  /// The two axes, angles run from the first to the second: "XY", "YZ" or "ZX"; empty where the file does not say.
  std::string plane;
};

/// Reads a CSV of a circular test: `direction` (cw or ccw) with either `angle` and `deviation` or `radius` of a ball
/// bar or two of `X`, `Y`, `Z` of a grid encoder, from the centre of the nominal circle; see docs/evaluate-geometry.md.
/// Rows in no order along the path are put in the order of their angles.
/// @param nominal_radius  mm; a deviation is added to it
/// @param mapping  of a file whose columns have other names
/// @throws InputError
CircularFile read_circular(const std::filesystem::path& path, double nominal_radius, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
CircularFile parse_circular(std::string_view text, const std::string& file, double nominal_radius,
                            const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
CircularFile parse_circular(const NamedColumns& columns, double nominal_radius);

}  // namespace abbe
