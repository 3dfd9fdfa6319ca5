#pragma once

// Internal to formats: the columns of axis commands in a CSV file.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/csv_reader.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// One required column per axis, chain order.
std::vector<CsvColumn> axis_columns(const Machine& machine);

/// The first of an axis's commands (mm or rad) that lies outside its travel, in words for an InputError.
struct OutsideTravel {
  std::size_t row;
  std::string problem, expected;
};
std::optional<OutsideTravel> first_outside_travel(const Axis& axis, std::span<const double> commands);

/// Takes the axis commands from the first columns of a table that was read with axis_columns().
/// @throws InputError for a command outside its axis's travel, if that is checked
PoseList take_poses(std::string_view text, const std::string& file, const Machine& machine, CsvTable& table,
                    bool check_travel);

}  // namespace abbe
