#include <fmt/format.h>

#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/rotary_pair.h"

namespace abbe {
namespace {

constexpr int kParameterDecimals = 3;  // IS-B: the smallest unit is 0.001 mm

/// First of three parameters, X, Y and Z (A-79348E).
constexpr int kTablePosition = 19700;  // machine origin to the first axis of the table, or its only one
constexpr int kTableOffset = 19703;    // from there to the second axis of the table
constexpr int kSpindleOffset = 19709;  // tool axis to the second axis of the head, or its only one
constexpr int kHeadOffset = 19712;     // from there to the first axis of the head

std::vector<std::string> three_parameters(int first) {
  return {fmt::format("N{}", first), fmt::format("N{}", first + 1), fmt::format("N{}", first + 2)};
}

std::vector<PlainValue> offsets_of_axes(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                        std::optional<int>) {
  const RotaryPair pair = rotary_pair(nominal.machine, "fanuc");
  const Machine& machine = geometry.machine;
  const Eigen::Vector3d first = machine.axes[pair.first].point - machine.tool_reference;
  const Eigen::Vector3d second = machine.axes[pair.second].point - machine.tool_reference;
  std::vector<PlainValue> values;
  if (pair.kind == RotaryPairKind::table) {
    add_vector(values, three_parameters(kTablePosition), ValueKind::length, first);
    add_vector(values, three_parameters(kTableOffset), ValueKind::length, second - first);
  } else if (pair.kind == RotaryPairKind::head) {
    add_vector(values, three_parameters(kSpindleOffset), ValueKind::length, second);
    add_vector(values, three_parameters(kHeadOffset), ValueKind::length, first - second);
  } else {
    add_vector(values, three_parameters(kTablePosition), ValueKind::length, second);
    add_vector(values, three_parameters(kSpindleOffset), ValueKind::length, first);
  }
  return values;
}

std::string parameter_text(const BelievedMachine&, const std::vector<KinematicValue>& values, std::optional<int>) {
  std::string text = "%\n";
  for (const KinematicValue& value : values) {
    text += fmt::format("{}P{}\n", value.name, decimals(value.actual, kParameterDecimals));
  }
  return text + "%\n";
}

BelievedMachine machine_of_parameters(const BelievedMachine& nominal, const NamedNumbers& numbers, std::optional<int>) {
  const RotaryPair pair = rotary_pair(nominal.machine, "fanuc");
  BelievedMachine believed = nominal;
  const Eigen::Vector3d& gauge = nominal.machine.tool_reference;
  Eigen::Vector3d& first = believed.machine.axes[pair.first].point;
  Eigen::Vector3d& second = believed.machine.axes[pair.second].point;
  const auto vector = [&](int parameter) { return vector_of(numbers, three_parameters(parameter)); };
  if (pair.kind == RotaryPairKind::table) {
    first = gauge + vector(kTablePosition);
    second = first + vector(kTableOffset);
  } else if (pair.kind == RotaryPairKind::head) {
    second = gauge + vector(kSpindleOffset);
    first = second + vector(kHeadOffset);
  } else {
    second = gauge + vector(kTablePosition);
    first = gauge + vector(kSpindleOffset);
  }
  return believed;
}

std::vector<std::string> unit_type(const BelievedMachine& nominal) {
  const RotaryPair pair = rotary_pair(nominal.machine, "fanuc");
  const int type = pair.kind == RotaryPairKind::table ? 12 : pair.kind == RotaryPairKind::head ? 2 : 21;
  std::vector<std::string> settings = {
      fmt::format("parameter 19680 = {} with {} as the first and {} as the second rotation axis", type,
                  nominal.machine.axes[pair.first].name, nominal.machine.axes[pair.second].name)};
  if (pair.kind != RotaryPairKind::table) {
    settings.emplace_back(
        "parameter 19666 (tool holder offset) = 0: point D of the manual is then the gauge point of the spindle");
  }
  return settings;
}

}  // namespace

KinematicFormat fanuc_kinematic_values() {
  KinematicFormat format;
  format.name = "fanuc";
  format.what = "FANUC 30i tool center point control: parameters 19700 to 19705 (table) and 19709 to 19714 (head)";
  format.convention =
      "mm in steps of 0.001 (IS-B), in the machine coordinate system: the gauge point with all axes at zero is its "
      "origin";
  format.unverified =
      "the numbers 19700 to 19702, whose page of the manual is not public; the form of the blocks for parameters with "
      "decimals; that the machine coordinate system has its zero where the machine file has it";
  format.cannot =
      "the parameters have positions of rotary axes; inclinations (19698, 19699 and others) are not written. Zero "
      "positions, error motions and linear axes are not in them";
  format.file_name = "KINEMATICS.PRM";
  format.values = offsets_of_axes;
  format.text = parameter_text;
  format.read = [](const std::string& text) {
    NamedNumbers numbers;
    for (const auto& [name, value] : numbers_of_lines(text, "N", "P")) numbers["N" + name] = value;
    return numbers;
  };
  format.believed = machine_of_parameters;
  format.settings = unit_type;
  return format;
}

}  // namespace abbe
