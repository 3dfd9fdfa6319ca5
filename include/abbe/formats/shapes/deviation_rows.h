#pragma once

#include <span>
#include <string>
#include <string_view>

namespace abbe {

/// First line of point_cloud_csv() with deviations, without normals and names.
inline constexpr std::string_view kDeviationCsvHeader = "x_mm,y_mm,z_mm,deviation_mm\n";

/// The other lines of it, behind a text: of some of the points, so that a file can be made in pieces.
/// @param points  [3 n] mm @param deviation_mm  [n]
void append_deviation_rows(std::span<const double> points, std::span<const double> deviation_mm, std::string& text);

}  // namespace abbe
