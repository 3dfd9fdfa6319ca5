#include "abbe/formats/machine/machine_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/machine_states.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/chain.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

/// Unit vector; what is a unit vector to rounding stays as it is, so that a written machine reads back the same.
Eigen::Vector3d direction(TomlTable& table, const Eigen::Vector3d& otherwise) {
  const auto values = table.optional_numbers("direction", Quantity::dimensionless, 3);
  if (!values) return otherwise;
  Eigen::Vector3d found = vector_of(*values);
  const double length = found.norm();
  if (length < 1e-6) table.fail("direction", "has no length", "a vector (x, y, z) along the positive direction");
  if (std::abs(length - 1) <= 4 * std::numeric_limits<double>::epsilon()) return found;
  return found / length;
}

void read_travel(TomlTable& table, Axis& axis) {
  const Quantity quantity = axis.kind == AxisKind::linear ? Quantity::length : Quantity::angle;
  axis.endless = table.boolean_or("endless", false);
  if (axis.endless) {
    if (axis.kind == AxisKind::linear) table.fail("endless", "a linear axis cannot be endless");
    if (table.has("travel", quantity)) table.fail_quantity("travel", quantity, "is given together with endless = true");
    table.optional_numbers("travel", quantity, 2);
    axis.travel_min = 0;
    axis.travel_max = 2 * std::numbers::pi;
    return;
  }
  const std::vector<double> travel = table.numbers("travel", quantity, 2);
  axis.travel_min = travel[0];
  axis.travel_max = travel[1];
  if (!(axis.travel_min < axis.travel_max)) {
    table.fail_quantity("travel", quantity, "the first limit is not below the second", "[smallest, largest] command");
  }
}

void read_axis(TomlTable& table, Axis& axis) {
  const std::size_t implied = axis.kind == AxisKind::linear ? 0 : 1;
  axis.kind = table.word_or("kind", implied, {"linear", "rotary"}) == 0 ? AxisKind::linear : AxisKind::rotary;
  axis.direction = direction(table, axis.direction);
  if (const auto point = table.optional_numbers("point", Quantity::length, 3)) axis.point = vector_of(*point);
  read_travel(table, axis);
  axis.setting = table.boolean_or("setting", false);
}

void read_workpiece(TomlTable table, Machine& machine) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), angles = Eigen::Vector3d::Zero();
  if (const auto values = table.optional_numbers("origin", Quantity::length, 3)) origin = vector_of(*values);
  if (const auto values = table.optional_numbers("angles", Quantity::angle, 3)) angles = vector_of(*values);
  machine.bed_from_workpiece = {rotation_from_error_angles(angles), origin};
  table.finish();
}

void read_tool(TomlTable table, Machine& machine) {
  if (const auto values = table.optional_numbers("reference", Quantity::length, 3)) {
    machine.tool_reference = vector_of(*values);
  }
  if (const auto values = table.optional_numbers("offset", Quantity::length, 3))
    machine.tool_offset = vector_of(*values);
  machine.tool_direction = direction(table, machine.tool_direction);
  table.finish();
}

}  // namespace

Machine parse_machine(const std::string& text, const std::string& file) {
  TomlTable root = TomlTable::parse(text, file);
  const std::string chain = root.text("chain");
  const ParsedChain parsed = parse_chain(chain);
  if (!parsed.ok) {
    root.fail("chain",
              fmt::format("\"{}\": found {} at character {}", chain, parsed.error.found, parsed.error.position + 1),
              parsed.error.expected);
  }
  Machine machine = parsed.machine;
  machine.name = root.text("name");
  machine.description = root.text_or("description", "");

  TomlTable axes = root.table("axis");
  for (const std::string& name : axes.keys()) {
    if (machine.find_axis(name) != Machine::npos) continue;
    axes.fail(name, fmt::format("the chain has no axis {}", name), "one of " + axis_names(machine));
  }
  std::vector<TomlTable> tables;
  for (Axis& axis : machine.axes) read_axis(tables.emplace_back(axes.table(axis.name)), axis);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    read_couplings(tables[i], machine.axes, i, machine.couplings);
    tables[i].finish();
  }
  axes.finish();
  if (auto workpiece = root.optional_table("workpiece")) read_workpiece(*workpiece, machine);
  if (auto tool = root.optional_table("tool")) read_tool(*tool, machine);
  read_states(root, machine);
  root.finish();

  for (const MachineProblem& problem : find_problems(machine)) {
    if (problem.field.starts_with("state.")) fail_state(root, problem);
    if (problem.axis.empty()) root.fail("", problem.text());
    root.table("axis").fail(problem.axis, problem.message);
  }
  return machine;
}

Machine read_machine(const std::filesystem::path& path) {
  return parse_machine(read_file_of_kind(path, ".machine.toml"), path.string());
}

std::string machine_text(const Machine& machine) {
  std::string text = fmt::format("name = {}\n", toml_string(machine.name));
  if (!machine.description.empty()) text += fmt::format("description = {}\n", toml_string(machine.description));
  text += fmt::format("chain = {}\n", toml_string(machine.chain()));
  if (machine.gravity != Machine{}.gravity) {
    text += fmt::format("gravity_m_per_s2 = {}\n", vector_text(machine.gravity));
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    text += fmt::format("\n[axis.{}]\n", axis.name);
    text += fmt::format("kind = \"{}\"\n", axis.kind == AxisKind::linear ? "linear" : "rotary");
    text += fmt::format("direction = {}\n", vector_text(axis.direction));
    text += fmt::format("point_mm = {}\n", vector_text(axis.point));
    if (axis.endless) {
      text += "endless = true\n";
    } else if (axis.kind == AxisKind::linear) {
      text += fmt::format("travel_mm = [{}, {}]\n", shortest_text(axis.travel_min), shortest_text(axis.travel_max));
    } else {
      text += toml_angles("travel", {axis.travel_min, axis.travel_max});
    }
    if (axis.setting) text += "setting = true\n";
    text += couplings_text(machine, i);
  }
  const Eigen::Vector3d angles = error_angles_from_rotation(machine.bed_from_workpiece.rotation);
  text += fmt::format("\n[workpiece]\norigin_mm = {}\n", vector_text(machine.bed_from_workpiece.translation));
  if (angles != Eigen::Vector3d::Zero()) text += toml_angles("angles", {angles.x(), angles.y(), angles.z()});
  text +=
      fmt::format("\n[tool]\nreference_mm = {}\noffset_mm = {}\ndirection = {}\n", vector_text(machine.tool_reference),
                  vector_text(machine.tool_offset), vector_text(machine.tool_direction));
  text += states_text(machine);
  return text;
}

std::string commented_machine_file(const std::string& chain) {
  const ParsedChain parsed = parse_chain(chain);
  if (!parsed.ok) {
    throw InputError(
        {"", 0, 0, "chain"},
        fmt::format("\"{}\": found {} at character {}", chain, parsed.error.found, parsed.error.position + 1),
        parsed.error.expected);
  }
  const Machine& machine = parsed.machine;
  std::string text = fmt::format(
      R"(# Machine file of Abbe. Every length is in mm, every angle in degrees, as the names say; _um, _m, _rad, _urad and
# _arcsec may be written instead. The machine frame is fixed to the bed: right-handed, X Y Z of ISO 841. Directions and
# points are those with every axis at zero.

name = "unnamed machine"
description = ""

# From the workpiece (w) over the bed (b) to the tool (t). A prime: the axis carries the workpiece, its positive command
# moves the table the other way.
chain = {}
)",
      toml_string(machine.chain()));
  for (const Axis& axis : machine.axes) {
    const bool linear = axis.kind == AxisKind::linear;
    text += fmt::format("\n[axis.{}]\n", axis.name);
    text += fmt::format("# kind = \"{}\"          # implied by the letter\n", linear ? "linear" : "rotary");
    text += fmt::format("direction = {}   # of positive motion{}\n", vector_text(axis.direction),
                        linear ? "" : ": right-hand rule about this vector");
    if (linear) {
      text += fmt::format("travel_mm = [{}, {}]  # smallest and largest command\n", shortest_text(axis.travel_min),
                          shortest_text(axis.travel_max));
      text += "point_mm = [0, 0, 0]    # reference point: where this axis's angular errors turn\n";
    } else {
      text += axis.endless ? "endless = true          # or travel_deg = [smallest, largest]\n"
                           : fmt::format("travel_deg = [{:g}, {:g}]  # or endless = true\n", axis.travel_min / kDegree,
                                         axis.travel_max / kDegree);
      text += "point_mm = [0, 0, 0]    # any point on the axis\n";
      text += "# setting = true         # set beforehand, not interpolated with the others\n";
    }
  }
  text += R"(
[workpiece]
origin_mm = [0, 0, 0]     # origin of the workpiece frame
# angles_deg = [0, 0, 0]  # its attitude: turned about x, then y, then z of the machine

[tool]
reference_mm = [0, 0, 0]  # gauge point of the spindle
offset_mm = [0, 0, 0]     # from there to the functional point: tool tip, reflector
direction = [0, 0, 1]     # from the functional point to the spindle
)";
  return text;
}

}  // namespace abbe
