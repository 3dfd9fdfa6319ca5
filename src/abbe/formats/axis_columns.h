#pragma once

// Internal to formats: the columns of axis commands in a CSV file.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/csv_reader.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// One required column per axis, chain order.
std::vector<CsvColumn> axis_columns(const Machine& machine);

/// Takes the axis commands from the first columns of a table that was read with axis_columns().
/// @throws InputError for a command outside its axis's travel, if that is checked
PoseList take_poses(std::string_view text, const std::string& file, const Machine& machine, CsvTable& table,
                    bool check_travel);

}  // namespace abbe
