#include "abbe/controls/description_rows.h"

#include <fmt/format.h>

#include <cmath>

namespace abbe {
namespace {

constexpr std::string_view kRowLetters = "XYZABC";

void add_shift(const Machine& machine, const DescribedAxis& described, std::vector<KinematicsRow>& rows) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = described.shift[static_cast<Eigen::Index>(c)];
    if (!shown_in_row(c, value)) continue;
    KinematicsRow row;
    row.axis = kRowLetters[c];
    row.doc = fmt::format("{} of {}", row.axis, machine.axes[described.axis].name);
    row.coord = value;
    rows.push_back(std::move(row));
  }
}

void add_columns(const Machine& machine, const ComponentTable& table, std::vector<KinematicsRow>& rows) {
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (!table.columns.at(c)) continue;
    KinematicsRow row;
    row.axis = kRowLetters[c];
    row.doc = error_motion_name(machine, table.axis, static_cast<Component>(c));
    row.column = ComptabColumn{table.axis, c};
    rows.push_back(std::move(row));
  }
}

/// One of the two turns of an axis; @param sense  -1 behind MachAxis
KinematicsRow tilt_row(const Machine& machine, const DescribedAxis& nominal, const DescribedAxis& described,
                       std::size_t turn, double sense) {
  KinematicsRow row;
  const std::size_t coordinate = described.tilt_coordinate[turn];
  row.axis = kRowLetters[coordinate];
  const bool by_errors = shown_in_row(coordinate, described.tilt[turn] - nominal.tilt[turn]);
  if (shown_in_row(coordinate, nominal.tilt[turn])) row.coord = sense * nominal.tilt[turn];
  if (by_errors) row.constant = sense * (described.tilt[turn] - nominal.tilt[turn]);
  row.doc = by_errors ? location_error_name(machine, described.axis, static_cast<Component>(coordinate))
                      : fmt::format("tilt of {}", machine.axes[described.axis].name);
  if (sense < 0) row.doc = "-" + row.doc;
  return row;
}

}  // namespace

bool shown_in_row(std::size_t coordinate, double value) {
  return std::abs(value) > (coordinate >= 3 ? 0.8e-9 : 0.5e-6);  // half the last digit: 1e-7 degrees, 1e-6 mm
}

std::vector<KinematicsRow> description_rows(const Machine& machine, const ErrorSet& errors,
                                            const std::vector<ComponentTable>& tables, const std::string& format) {
  const std::vector<DescribedAxis> nominal = described_axes(machine, {}, format);
  const std::vector<DescribedAxis> described = described_axes(machine, errors, format);
  std::vector<KinematicsRow> rows;
  const auto add_tilt = [&](std::size_t k, std::size_t turn, double sense) {
    KinematicsRow row = tilt_row(machine, nominal[k], described[k], turn, sense);
    if (row.coord || row.constant) rows.push_back(std::move(row));
  };
  bool based = false;
  for (std::size_t k = 0; k < described.size(); ++k) {
    const DescribedAxis& axis = described[k];
    if (!based && machine.axes[axis.axis].side == ChainSide::workpiece) {
      rows.push_back({.key = KinematicsRow::Key::mach_base});
      based = true;
    }
    add_shift(machine, axis, rows);
    for (const ComponentTable& table : tables) {
      if (table.axis == axis.axis) add_columns(machine, table, rows);
    }
    add_tilt(k, 0, 1);
    add_tilt(k, 1, 1);
    rows.push_back({.key = KinematicsRow::Key::mach_axis, .axis = axis.letter});
    add_tilt(k, 1, -1);
    add_tilt(k, 0, -1);
  }
  if (!based) rows.push_back({.key = KinematicsRow::Key::mach_base});
  return rows;
}

}  // namespace abbe
