#pragma once

// Internal to formats: points in lines of plain numbers.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/surface/point_cloud.h"

namespace abbe {

/// Reads lines of three numbers, or of six, in the unit of the file; blank lines and those that begin with # or // are
/// passed over. In parallel; the result does not depend on the number of threads. @throws InputError
PointCloud parse_xyz(std::string_view contents, const std::string& file, double largest, int threads);

/// Numbers in the first line: 3 or 6. @param contents  without a byte order mark @throws InputError
std::size_t xyz_columns(std::string_view contents, const std::string& file, double largest);

/// Reads the lines from `begin` to `end`, of so many numbers, on the calling thread. @param cloud  overwritten
/// @returns what was refused first
std::optional<TextRefusal> read_xyz_lines(std::string_view contents, std::size_t begin, std::size_t end,
                                          std::size_t columns, double largest, PointCloud& cloud);

/// Lines of points from `begin` to `end`, which are not looked into.
std::size_t count_xyz_lines(std::string_view contents, std::size_t begin, std::size_t end);

}  // namespace abbe
