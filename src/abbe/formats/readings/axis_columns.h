#pragma once

// Internal to formats: the columns of axis commands in a CSV file.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/machine/machine.h"

namespace abbe {

inline constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

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

/// Optional column "point": what the input calls the point of a reading.
CsvColumn point_column();

/// Optional columns "X_approach": from which side the axis came, +1, -1 or 0 (not known).
/// @returns index of the first of them; one per axis, chain order
std::size_t add_approach_columns(const Machine& machine, std::vector<CsvColumn>& columns);

/// Sides of approach for poses that were taken from the table; empty if there is no such column.
/// @throws InputError for any other number
std::vector<std::vector<std::int8_t>> take_approach(std::string_view text, const std::string& file,
                                                    const Machine& machine, const CsvTable& table, std::size_t first);

/// Optional columns of measured and lag states: "ambient_degC", "feed" where the unit is "1".
/// @returns index of the first of them; in the order of Machine::states
std::size_t add_state_columns(const Machine& machine, std::vector<CsvColumn>& columns);

/// States of poses that were taken from the table, as PoseList::state. A lag without a column of its own is computed
/// from the column of its channel where there are times; it starts in equilibrium. Channels of files give the others.
/// @param poses   from take_poses()
/// @param first   of the columns of states
/// @param time    of the times, in s; kNoColumn: the table has none
/// @throws InputError for times that go back, where a lag is computed from them, and as StateChannels::give()
void take_states(std::string_view text, const std::string& file, const Machine& machine, CsvTable& table,
                 std::size_t first, std::size_t time, const ChannelUse& channels, PoseList& poses);

/// Whether the values of a state are given at all poses, so that they can be written.
bool has_state_column(const PoseList& poses, std::size_t state);

/// The sides of one axis as numbers for a column.
std::vector<double> approach_numbers(const std::vector<std::int8_t>& sides);
/// "X_approach"
std::string approach_header(const Axis& axis);

}  // namespace abbe
