#include <fmt/format.h>

#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/rotary_pair.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr int kLengthDecimals = 6;
constexpr int kDirectionDecimals = 9;

/// A vector of the control, I1 to I4; from where to where depends on the kind of machine.
struct OffsetVector {
  int carrier;                  ///< number of its first $TC_CARR
  const char* machine_data[3];  ///< $MC_TRAFO5_..., by RotaryPairKind; null: the kind has none
};

// SINUMERIK Operate Commissioning Manual 6FC5397-1DP40-6BA1 (12/2017), 21.7 "Swiveling". PART_OFFSET is MD24500,
// BASE_TOOL MD24550, JOINT_OFFSET_PART MD24558, JOINT_OFFSET MD24560.
constexpr OffsetVector kOffsets[] = {
    {1, {nullptr, "PART_OFFSET", "JOINT_OFFSET"}},             // I1
    {4, {"BASE_TOOL", "JOINT_OFFSET", "BASE_TOOL"}},           // I2
    {15, {"JOINT_OFFSET", "BASE_TOOL", "JOINT_OFFSET_PART"}},  // I3
    {18, {"PART_OFFSET", nullptr, "PART_OFFSET"}},             // I4
};
constexpr int kFirstAxisCarrier = 7, kSecondAxisCarrier = 10;

std::vector<std::string> indexed(const std::string& name) { return {name + "[0]", name + "[1]", name + "[2]"}; }

std::vector<std::string> carrier_names(int first, int carrier) {
  std::vector<std::string> names;
  for (int k = 0; k < 3; ++k) names.push_back(fmt::format("$TC_CARR{}[{}]", first + k, carrier));
  return names;
}

/// Names of one offset vector; empty if machines of this kind have none.
std::vector<std::string> offset_names(const OffsetVector& offset, RotaryPairKind kind, std::optional<int> carrier) {
  const char* const data = offset.machine_data[static_cast<int>(kind)];
  if (data == nullptr) return {};
  if (carrier) return carrier_names(offset.carrier, *carrier);
  return indexed(fmt::format("$MC_TRAFO5_{}_1", data));
}

std::vector<std::string> axis_names(bool first, std::optional<int> carrier) {
  if (carrier) return carrier_names(first ? kFirstAxisCarrier : kSecondAxisCarrier, *carrier);
  return indexed(first ? "$MC_TRAFO5_AXIS1_1" : "$MC_TRAFO5_AXIS2_1");
}

std::vector<PlainValue> vectors_of_chain(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                         std::optional<int> carrier) {
  const RotaryPair pair = rotary_pair(nominal.machine, "siemens");
  const Machine& machine = geometry.machine;
  const Axis& first = machine.axes[pair.first];
  const Axis& second = machine.axes[pair.second];
  const Eigen::Vector3d& gauge = machine.tool_reference;
  Eigen::Vector3d vectors[4];
  if (pair.kind == RotaryPairKind::table) {
    vectors[1] = first.point - gauge;
    vectors[2] = second.point - first.point;
    vectors[3] = -(vectors[1] + vectors[2]);
  } else if (pair.kind == RotaryPairKind::head) {
    vectors[2] = second.point - gauge;
    vectors[1] = first.point - second.point;
    vectors[0] = -(vectors[1] + vectors[2]);
  } else {
    vectors[1] = first.point - gauge;
    vectors[0] = -vectors[1];
    vectors[2] = second.point - gauge;
    vectors[3] = -vectors[2];
  }
  std::vector<PlainValue> values;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<std::string> names = offset_names(kOffsets[k], pair.kind, carrier);
    if (!names.empty()) add_vector(values, names, ValueKind::length, vectors[k]);
  }
  // A positive command turns what the axis carries about this vector.
  add_vector(values, axis_names(true, carrier), ValueKind::direction, first.sense() * first.direction);
  add_vector(values, axis_names(false, carrier), ValueKind::direction, second.sense() * second.direction);
  return values;
}

const char* carrier_type(RotaryPairKind kind) {
  return kind == RotaryPairKind::table ? "P" : kind == RotaryPairKind::head ? "T" : "M";
}

int transformation_type(RotaryPairKind kind) {
  return kind == RotaryPairKind::table ? 40 : kind == RotaryPairKind::head ? 24 : 56;
}

std::string machine_data_text(const BelievedMachine& nominal, const std::vector<KinematicValue>& values,
                              std::optional<int> carrier) {
  const RotaryPair pair = rotary_pair(nominal.machine, "siemens");
  const std::string& first = nominal.machine.axes[pair.first].name;
  const std::string& second = nominal.machine.axes[pair.second].name;
  std::string text = carrier ? "; kinematic values of an orientable tool carrier, mm\n"
                             : "; kinematic values of the transformation of five axes, mm\nCHANDATA(1)\n";
  text += carrier ? fmt::format("; first rotary axis {}, second {}; $TC_CARR23[{}] = \"{}\"\n", first, second, *carrier,
                                carrier_type(pair.kind))
                  : fmt::format("; first rotary axis {}, second {}; MD24100 $MC_TRAFO_TYPE_1 = {}\n", first, second,
                                transformation_type(pair.kind));
  for (const KinematicValue& value : values) {
    const int places = value.kind == ValueKind::length ? kLengthDecimals : kDirectionDecimals;
    text += fmt::format("{}={}\n", value.name, decimals(value.actual, places));
  }
  return text + "M17\n";
}

/// The control's vectors as points and directions.
BelievedMachine machine_of_vectors(const BelievedMachine& nominal, const NamedNumbers& numbers,
                                   std::optional<int> carrier) {
  const RotaryPair pair = rotary_pair(nominal.machine, "siemens");
  BelievedMachine believed = nominal;
  Axis& first = believed.machine.axes[pair.first];
  Axis& second = believed.machine.axes[pair.second];
  const Eigen::Vector3d& gauge = nominal.machine.tool_reference;
  const Eigen::Vector3d i2 = vector_of(numbers, offset_names(kOffsets[1], pair.kind, carrier));
  const Eigen::Vector3d i3 = vector_of(numbers, offset_names(kOffsets[2], pair.kind, carrier));
  if (pair.kind == RotaryPairKind::table) {
    first.point = gauge + i2;
    second.point = first.point + i3;
  } else if (pair.kind == RotaryPairKind::head) {
    second.point = gauge + i3;
    first.point = second.point + i2;
  } else {
    first.point = gauge + i2;
    second.point = gauge + i3;
  }
  first.direction = first.sense() * vector_of(numbers, axis_names(true, carrier)).normalized();
  second.direction = second.sense() * vector_of(numbers, axis_names(false, carrier)).normalized();
  return believed;
}

std::vector<std::string> trafo_settings(const BelievedMachine& nominal) {
  const RotaryPair pair = rotary_pair(nominal.machine, "siemens");
  return {fmt::format("MD24100 $MC_TRAFO_TYPE_1 = {} ({} = 1st, {} = 2nd rotary axis), or 72 with MD24582 "
                      "$MC_TRAFO5_TCARR_NO_1 and --tool-carrier; $TC_CARR23 = \"{}\"",
                      transformation_type(pair.kind), nominal.machine.axes[pair.first].name,
                      nominal.machine.axes[pair.second].name, carrier_type(pair.kind)),
          "MD10240 $MN_SCALING_SYSTEM_IS_METRIC = 1 (mm); fine offsets $TC_CARR41 to $TC_CARR60 = 0; "
          "MD24520 $MC_TRAFO5_ROT_SIGN_IS_PLUS_1 = 1: the vectors have the sense of rotation"};
}

}  // namespace

KinematicFormat siemens_kinematic_values() {
  KinematicFormat format;
  format.name = "siemens";
  format.what = "SINUMERIK TRAORI: machine data $MC_TRAFO5_..., or $TC_CARR of a tool carrier with --tool-carrier";
  format.convention =
      "mm, in the machine coordinate system: the gauge point with all axes at zero is the machine reference point. "
      "Vectors I1 to I4 and V1, V2 as in CYCLE996 and CYCLE800, chain closed. V of a primed axis is reversed";
  format.unverified =
      "that the machine reference point of I2 (tables) and I3 (mixed) is the gauge point with all axes at zero; check "
      "the values against those in the control before loading";
  format.cannot =
      "the control has positions and directions of rotary axes; zero positions, error motions and linear axes are not "
      "in them";
  format.file_name = "TRAFO5.INI";
  format.takes_tool_carrier = true;
  format.values = vectors_of_chain;
  format.text = machine_data_text;
  format.read = [](const std::string& text) {
    NamedNumbers numbers;
    for (const auto& [name, value] : numbers_of_lines(text, "$", "=")) numbers["$" + name] = value;
    return numbers;
  };
  format.believed = machine_of_vectors;
  format.settings = trafo_settings;
  return format;
}

}  // namespace abbe
