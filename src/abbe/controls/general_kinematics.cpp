#include <fmt/format.h>

#include <charconv>

#include "abbe/controls/kinematic_format.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr char kHeading[] = "axis,relative_to,quantity,nominal,actual,standard_uncertainty\n";

std::vector<std::string> quantities(const std::string& axis, const std::string& relative_to, bool direction) {
  std::vector<std::string> names;
  for (const char letter : {'x', 'y', 'z'}) {
    names.push_back(direction ? fmt::format("{},{},direction_{}", axis, relative_to, letter)
                              : fmt::format("{},{},{}_mm", axis, relative_to, letter));
  }
  return names;
}

std::string zero_name(const std::string& axis) { return axis + ",machine,zero_deg"; }

/// The rotary axis next to this one towards the bed on its side, or npos.
std::size_t carrying_axis(const Machine& machine, std::size_t axis) {
  std::size_t found = Machine::npos;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& other = machine.axes[i];
    if (other.kind != AxisKind::rotary || other.side != machine.axes[axis].side) continue;
    if (other.side == ChainSide::workpiece ? i > axis && found == Machine::npos : i < axis) found = i;
  }
  return found;
}

std::vector<PlainValue> lines_of_axes(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                      std::optional<int>) {
  const Machine& machine = geometry.machine;
  std::vector<PlainValue> values;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.kind != AxisKind::rotary) continue;
    add_vector(values, quantities(axis.name, "machine", false), ValueKind::length, axis.point);
    add_vector(values, quantities(axis.name, "machine", true), ValueKind::direction, axis.direction);
    values.push_back({zero_name(axis.name), ValueKind::angle, geometry.zero[i]});
    add_vector(values, quantities(axis.name, "gauge point", false), ValueKind::length,
               axis.point - machine.tool_reference);
    const std::size_t carrying = carrying_axis(nominal.machine, i);
    if (carrying == Machine::npos) continue;
    add_vector(values, quantities(axis.name, machine.axes[carrying].name, false), ValueKind::length,
               axis.point - machine.axes[carrying].point);
  }
  if (values.empty()) {
    throw InputError({.field = "--for values"}, "the machine has no rotary axis",
                     "a machine with rotary axes; `abbe compensate table` writes tables for the others");
  }
  return values;
}

std::string value_rows(const BelievedMachine&, const std::vector<KinematicValue>& values, std::optional<int>) {
  std::string text = kHeading;
  for (const KinematicValue& value : values) {
    const double unit = value.kind == ValueKind::angle ? kDegree : 1;
    const int places = value.kind == ValueKind::length ? 6 : 9;
    text += fmt::format("{},{},{},{}\n", value.name, decimals(value.nominal / unit, places),
                        decimals(value.actual / unit, places),
                        value.standard_uncertainty ? decimals(*value.standard_uncertainty / unit, places) : "");
  }
  return text;
}

/// The column `actual` by the first three.
NamedNumbers read_value_rows(const std::string& text) {
  NamedNumbers numbers;
  std::size_t begin = text.find('\n') + 1;
  while (begin < text.size()) {
    const std::size_t end = text.find('\n', begin);
    std::vector<std::size_t> commas;
    for (std::size_t k = begin; k < end; ++k) {
      if (text[k] == ',') commas.push_back(k);
    }
    const std::string name = text.substr(begin, commas.at(2) - begin);
    const double unit = name.ends_with("_deg") ? kDegree : 1;
    double value = 0;
    std::from_chars(text.data() + commas.at(3) + 1, text.data() + commas.at(4), value);
    numbers[name] = unit * value;
    begin = end + 1;
  }
  return numbers;
}

BelievedMachine machine_of_rows(const BelievedMachine& nominal, const NamedNumbers& numbers, std::optional<int>) {
  BelievedMachine believed = nominal;
  for (std::size_t i = 0; i < believed.machine.axes.size(); ++i) {
    Axis& axis = believed.machine.axes[i];
    if (axis.kind != AxisKind::rotary) continue;
    axis.point = vector_of(numbers, quantities(axis.name, "machine", false));
    axis.direction = vector_of(numbers, quantities(axis.name, "machine", true)).normalized();
    believed.zero[i] = numbers.at(zero_name(axis.name));
  }
  return believed;
}

}  // namespace

KinematicFormat general_kinematic_values() {
  KinematicFormat format;
  format.name = "values";
  format.what = "table (CSV) of positions, directions and zero positions of all rotary axes, for every machine";
  format.convention =
      "mm and degrees, all axes at zero. A point of each axis line relative to the origin of the machine frame, to the "
      "gauge point, and to the axis that carries it; direction: unit vector; zero: the deviation of the axis from its "
      "command";
  format.cannot =
      "positions, directions and zero positions of rotary axes only; error motions and linear axes are not in it";
  format.file_name = "kinematic-values.csv";
  format.values = lines_of_axes;
  format.text = value_rows;
  format.read = read_value_rows;
  format.believed = machine_of_rows;
  format.settings = [](const BelievedMachine&) { return std::vector<std::string>(); };
  return format;
}

}  // namespace abbe
