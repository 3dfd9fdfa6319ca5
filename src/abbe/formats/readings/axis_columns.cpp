#include "abbe/formats/readings/axis_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

// A command written with few digits may end just outside the travel.
constexpr double kTravelTolerance = 1e-6;

}  // namespace

std::optional<OutsideTravel> first_outside_travel(const Axis& axis, std::span<const double> commands) {
  if (axis.endless) return std::nullopt;
  for (std::size_t row = 0; row < commands.size(); ++row) {
    if (commands[row] >= axis.travel_min - kTravelTolerance && commands[row] <= axis.travel_max + kTravelTolerance) {
      continue;
    }
    const Unit& unit = unit_named(axis_quantity(axis), axis.kind == AxisKind::linear ? "mm" : "deg");
    const double scale = 1 / unit.factor;
    return OutsideTravel{
        row, fmt::format("{:.9g} {} is outside the travel of axis {}", commands[row] * scale, unit.suffix, axis.name),
        fmt::format("{:.9g} to {:.9g} {}", axis.travel_min * scale, axis.travel_max * scale, unit.suffix)};
  }
  return std::nullopt;
}

CsvColumn point_column() {
  CsvColumn column{"point", Quantity::dimensionless, true, false, CsvColumn::Range::any};
  column.is_label = true;
  return column;
}

std::vector<CsvColumn> axis_columns(const Machine& machine) {
  std::vector<CsvColumn> columns;
  for (const Axis& axis : machine.axes) {
    columns.push_back({axis.name, axis_quantity(axis), false, true, CsvColumn::Range::any});
  }
  return columns;
}

PoseList take_poses(std::string_view text, const std::string& file, const Machine& machine, CsvTable& table,
                    bool check_travel) {
  PoseList list;
  list.axis.resize(machine.axes.size());
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const CsvValues& values = table.columns[i];
    const auto outside = check_travel ? first_outside_travel(machine.axes[i], values.numbers) : std::nullopt;
    if (outside) {
      throw InputError({file, csv_line(text, outside->row), 0, values.header}, outside->problem, outside->expected);
    }
    list.axis[i] = std::move(table.columns[i].numbers);
  }
  return list;
}

std::string approach_header(const Axis& axis) { return axis.name + "_approach"; }

std::size_t add_approach_columns(const Machine& machine, std::vector<CsvColumn>& columns) {
  const std::size_t first = columns.size();
  for (const Axis& axis : machine.axes) {
    columns.push_back({approach_header(axis), Quantity::dimensionless, false, false, CsvColumn::Range::any});
  }
  return first;
}

std::vector<std::vector<std::int8_t>> take_approach(std::string_view text, const std::string& file,
                                                    const Machine& machine, const CsvTable& table, std::size_t first) {
  std::vector<std::vector<std::int8_t>> approach(machine.axes.size());
  bool known = false;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const CsvValues& column = table.columns[first + i];
    approach[i].assign(table.rows, 0);
    if (!column.present) continue;
    known = true;
    for (std::size_t row = 0; row < table.rows; ++row) {
      const double side = column.numbers[row];
      if (side != 1 && side != -1 && side != 0) {
        throw InputError({file, csv_line(text, row), 0, column.header}, fmt::format("{:.9g} is not a side", side),
                         "1 after a motion in positive direction, -1 in negative, 0 if it is not known");
      }
      approach[i][row] = static_cast<std::int8_t>(side);
    }
  }
  if (!known) approach.clear();
  return approach;
}

std::size_t add_state_columns(const Machine& machine, std::vector<CsvColumn>& columns) {
  const std::size_t first = columns.size();
  for (const MachineState& state : machine.states) {
    if (!is_input(state.kind)) continue;
    // The header is taken as it is: a state has one unit, which the machine file names.
    columns.push_back({state_column(state), Quantity::dimensionless, false, false, CsvColumn::Range::any});
  }
  return first;
}

void take_states(std::string_view text, const std::string& file, const Machine& machine, CsvTable& table,
                 std::size_t first, std::size_t time, const ChannelUse& channels, PoseList& poses) {
  const CsvValues none{};
  const CsvValues& times = time == kNoColumn ? none : table.columns[time];
  const std::vector<double>& time_s = times.numbers;
  std::vector<std::vector<double>> states(machine.states.size());
  bool known = false;
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (!is_input(machine.states[j].kind)) continue;
    CsvValues& column = table.columns[first++];
    if (!column.present) continue;
    known = true;
    states[j] = std::move(column.numbers);
  }
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (state.kind != StateKind::lag || !states[j].empty() || states[state.first].empty() || time_s.empty()) continue;
    if (channels.from != nullptr && channels.from->of(j) != nullptr) continue;
    for (std::size_t row = 1; row < time_s.size(); ++row) {
      if (time_s[row] >= time_s[row - 1]) continue;
      throw InputError({file, csv_line(text, row), 0, "time"},
                       fmt::format("is before the time of the reading before it, so that {} cannot be computed from {}",
                                   state.name, machine.states[state.first].name),
                       "times in order, or a column " + state_column(state));
    }
    states[j] = lagged(time_s, states[state.first], state.time_constant);
  }
  if (known) poses.state = std::move(states);
  if (channels.from == nullptr) return;
  const ReadingRows rows{file, times.header, [text](std::size_t row) { return csv_line(text, row); }};
  channels.from->give(machine, time_s, rows, poses, channels.starts);
}

bool has_state_column(const PoseList& poses, std::size_t state) {
  if (state >= poses.state.size() || poses.state[state].size() != poses.count()) return false;
  return std::all_of(poses.state[state].begin(), poses.state[state].end(),
                     [](double value) { return std::isfinite(value); });
}

std::vector<double> approach_numbers(const std::vector<std::int8_t>& sides) { return {sides.begin(), sides.end()}; }

}  // namespace abbe
