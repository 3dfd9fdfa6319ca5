#pragma once

#include <filesystem>

#include "reproduce/liu_results.h"

namespace abbe {

/// Folder of results: summary.json; of every part, with the shifts of Table 3 in micrometres, its mesh, path (CSV and
/// program), coverage, data for pages, and the measured points with their deviations before and after compensation.
/// @throws InputError if it cannot be written
void write_liu_folder(const LiuResults& results, const std::filesystem::path& folder);

}  // namespace abbe
