#include "abbe/formats/axis_columns.h"

#include <fmt/format.h>

#include "abbe/formats/error_fields.h"
#include "abbe/formats/input_error.h"

namespace abbe {
namespace {

// A command written with few digits may end just outside the travel.
constexpr double kTravelTolerance = 1e-6;

void check_axis_travel(std::string_view text, const std::string& file, const Axis& axis, const CsvValues& values) {
  if (axis.endless) return;
  for (std::size_t row = 0; row < values.numbers.size(); ++row) {
    const double command = values.numbers[row];
    if (command >= axis.travel_min - kTravelTolerance && command <= axis.travel_max + kTravelTolerance) continue;
    const Unit& unit = unit_named(axis_quantity(axis), axis.kind == AxisKind::linear ? "mm" : "deg");
    const double scale = 1 / unit.factor;
    throw InputError({file, csv_line(text, row), 0, values.header},
                     fmt::format("{:.9g} {} is outside the travel of axis {}", command * scale, unit.suffix, axis.name),
                     fmt::format("{:.9g} to {:.9g} {}", axis.travel_min * scale, axis.travel_max * scale, unit.suffix));
  }
}

}  // namespace

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
    if (check_travel) check_axis_travel(text, file, machine.axes[i], table.columns[i]);
    list.axis[i] = std::move(table.columns[i].numbers);
  }
  return list;
}

}  // namespace abbe
