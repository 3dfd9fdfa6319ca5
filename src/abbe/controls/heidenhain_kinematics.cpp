#include <fmt/format.h>

#include <algorithm>

#include "abbe/controls/description_rows.h"
#include "abbe/controls/kinematic_format.h"
#include "abbe/errors/calibrated_machine.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr const char* kValuesName = "heidenhain";
constexpr const char* kValuesFile = "KINEMATICS.TAB";

std::string shift_name(char letter, std::size_t c) { return fmt::format("MachAxis {}, Trans {:c}", letter, "XYZ"[c]); }

std::string turn_name(char letter, std::size_t coordinate) {
  return fmt::format("MachAxis {}, Trans {:c}", letter, "XYZABC"[coordinate]);
}

/// The geometry without errors is that of its axis lines.
std::vector<DescribedAxis> rotary_described(const Machine& geometry) {
  std::vector<DescribedAxis> axes = described_axes(geometry, {}, kValuesName);
  std::erase_if(axes, [](const DescribedAxis& axis) { return axis.coordinate < 3; });
  if (axes.empty()) {
    throw InputError({.field = "--for heidenhain"}, "the machine has no rotary axis",
                     "a machine with rotary axes; `abbe compensate table` writes tables for the others");
  }
  return axes;
}

std::vector<PlainValue> rows_of_axes(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                     std::optional<int>) {
  Machine machine = geometry.machine;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::linear) machine.axes[i].direction = nominal.machine.axes[i].direction;
  }
  std::vector<PlainValue> values;
  for (const DescribedAxis& axis : rotary_described(machine)) {
    add_vector(values, {shift_name(axis.letter, 0), shift_name(axis.letter, 1), shift_name(axis.letter, 2)},
               ValueKind::length, axis.shift);
    for (std::size_t turn = 0; turn < 2; ++turn) {
      values.push_back({turn_name(axis.letter, axis.tilt_coordinate[turn]), ValueKind::angle, axis.tilt[turn]});
    }
  }
  return values;
}

double actual_of(const std::vector<KinematicValue>& values, const std::string& name) {
  const auto found =
      std::find_if(values.begin(), values.end(), [&](const KinematicValue& one) { return one.name == name; });
  return found == values.end() ? 0 : found->actual;
}

void add_value_row(char letter, double value, const std::string& doc, std::vector<KinematicsRow>& rows) {
  if (!shown_in_row(kinematics_coordinate(letter), value)) return;
  rows.push_back({.axis = letter, .doc = doc, .coord = value});
}

std::string description_of_values(const BelievedMachine& nominal, const std::vector<KinematicValue>& values,
                                  std::optional<int>) {
  std::vector<KinematicsRow> rows;
  bool based = false;
  for (const DescribedAxis& axis : described_axes(nominal.machine, {}, kValuesName)) {
    const Axis& of = nominal.machine.axes[axis.axis];
    if (!based && of.side == ChainSide::workpiece) rows.push_back({.key = KinematicsRow::Key::mach_base});
    based = based || of.side == ChainSide::workpiece;
    const bool rotary = axis.coordinate >= 3;
    for (std::size_t c = 0; rotary && c < 3; ++c) {
      add_value_row("XYZ"[c], actual_of(values, shift_name(axis.letter, c)),
                    fmt::format("{:c} of {}", "XYZ"[c], of.name), rows);
    }
    const auto add_turn = [&](std::size_t turn, double sense) {
      const char letter = "XYZABC"[axis.tilt_coordinate[turn]];
      add_value_row(letter, sense * actual_of(values, turn_name(axis.letter, axis.tilt_coordinate[turn])),
                    fmt::format("{}tilt of {}", sense < 0 ? "-" : "", of.name), rows);
    };
    for (std::size_t turn = 0; rotary && turn < 2; ++turn) add_turn(turn, 1);
    rows.push_back({.key = KinematicsRow::Key::mach_axis, .axis = axis.letter});
    for (std::size_t turn = 2; rotary && turn-- > 0;) add_turn(turn, -1);
  }
  if (!based) rows.push_back({.key = KinematicsRow::Key::mach_base});
  return heidenhain_kinematics_text(rows, kValuesFile, {}, 1);
}

std::vector<std::string> line_names(char letter) {
  std::vector<std::string> names;
  for (const char* what : {"point x", "point y", "point z", "direction x", "direction y", "direction z"}) {
    names.push_back(fmt::format("{} {}", letter, what));
  }
  return names;
}

/// Values by the names of rows_of_axes(), and lines of rotary axes in the frame of the tool reference point: whatever
/// rows state them.
NamedNumbers read_lines(const std::string& text) {
  NamedNumbers numbers;
  RigidTransform chain;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (const KinematicsRow& row : parse_heidenhain_kinematics(text, kValuesFile, {}, 1)) {
    const std::size_t coordinate = kinematics_coordinate(row.axis);
    if (row.key == KinematicsRow::Key::mach_base || (row.key == KinematicsRow::Key::mach_axis && coordinate < 3))
      continue;
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(coordinate % 3));
    if (row.key == KinematicsRow::Key::mach_axis) {
      const std::vector<std::string> names = line_names(row.axis);
      const Eigen::Vector3d direction = chain.rotation * unit;
      for (std::size_t c = 0; c < 3; ++c) {
        numbers[names[c]] = chain.translation[static_cast<Eigen::Index>(c)];
        numbers[names[c + 3]] = direction[static_cast<Eigen::Index>(c)];
        numbers[shift_name(row.axis, c)] = (chain.translation - before)[static_cast<Eigen::Index>(c)];
      }
      before = chain.translation;
      DescribedAxis axis;
      axis.coordinate = coordinate;
      tilt_to(direction, axis);
      for (std::size_t turn = 0; turn < 2; ++turn) {
        numbers[turn_name(row.axis, axis.tilt_coordinate[turn])] = axis.tilt[turn];
      }
    } else {
      const double value = row.coord.value_or(0);
      chain = chain * (coordinate < 3 ? RigidTransform::translate(value * unit)
                                      : RigidTransform::rotate(rotation_about(unit, value)));
    }
  }
  return numbers;
}

BelievedMachine machine_of_lines(const BelievedMachine& nominal, const NamedNumbers& numbers, std::optional<int>) {
  BelievedMachine believed = nominal;
  for (Axis& axis : believed.machine.axes) {
    if (axis.kind != AxisKind::rotary) continue;
    const std::vector<std::string> names = line_names(axis.name.front());
    axis.point = nominal.machine.tool_reference + vector_of(numbers, {names[0], names[1], names[2]});
    axis.direction = described_sense(axis) * vector_of(numbers, {names[3], names[4], names[5]}).normalized();
  }
  return believed;
}

}  // namespace

KinematicFormat heidenhain_kinematic_values() {
  KinematicFormat format;
  format.name = kValuesName;
  format.what = "kinematics description of HEIDENHAIN iTNC 530: rows Trans and MachAxis from the tool to the table";
  format.convention =
      "COORD in mm and degrees, all axes at zero: starting at the tool reference point (gauge point), each Trans moves "
      "the frame; tilts of an axis come before MachAxis and are undone after it";
  format.unverified =
      "the sense of rows and axes, which follows from one example of the manual; header, end and columns of the text; "
      "that angles are in degrees; how many decimals the control keeps; that its machine coordinates have their zero "
      "where the machine file has it";
  format.cannot =
      "positions and directions of rotary axes only; zero positions (MP960), error motions and linear axes are not in "
      "it";
  format.file_name = kValuesFile;
  format.values = rows_of_axes;
  format.text = description_of_values;
  format.read = read_lines;
  format.believed = machine_of_lines;
  format.settings = [](const BelievedMachine&) {
    return std::vector<std::string>{
        "rows of the control's own table that are not here (TOOLFILE, SUBFILE, CMO, ToolAxis) stay as they are there; "
        "presets of workpieces have to be set again"};
  };
  return format;
}

}  // namespace abbe
