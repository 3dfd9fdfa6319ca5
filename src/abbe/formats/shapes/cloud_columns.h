#pragma once

// Internal to formats: the columns of a point cloud in a CSV file.
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

/// x, y, z, then those that may be missing: nx, ny, nz, deviation, point. @param in_plane  z may be missing too
std::vector<CsvColumn> cloud_columns(bool in_plane);

}  // namespace abbe
