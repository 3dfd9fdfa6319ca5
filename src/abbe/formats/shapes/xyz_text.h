#pragma once

// Internal to formats: points in lines of plain numbers.
#include <string>
#include <string_view>

#include "abbe/geometry/surface/point_cloud.h"

namespace abbe {

/// Reads lines of three numbers, or of six, in the unit of the file; blank lines and those that begin with # or // are
/// passed over. In parallel; the result does not depend on the number of threads. @throws InputError
PointCloud parse_xyz(std::string_view contents, const std::string& file, double largest, int threads);

}  // namespace abbe
