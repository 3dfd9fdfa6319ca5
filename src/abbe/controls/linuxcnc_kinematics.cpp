#include <fmt/format.h>

#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/rotary_pair.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr double kAlong = 1e-9;

/// A trunnion table that one of the two modules turns.
struct Trunnion {
  std::string module;   ///< "xyzac-trt-kins"
  std::string offset;   ///< pin of the offset across the cradle's axis: "y-offset"
  Eigen::Index across;  ///< its component
  std::size_t cradle, table;
  bool primed;  ///< both axes

  std::string pin(const std::string& name) const { return module + "." + name; }
};

[[noreturn]] void refuse_trunnion(const std::string& why) {
  throw InputError({.field = "--for linuxcnc"}, why,
                   "the chain of xyzac-trt-kins (w C A ... or w C' A' ...) or of xyzbc-trt-kins (w C B ...): a table C "
                   "about Z in a cradle A about X or B about Y, spindle along Z; --for values takes every machine");
}

Trunnion trunnion_of(const Machine& machine) {
  const RotaryPair pair = rotary_pair(machine, "linuxcnc");
  if (pair.kind != RotaryPairKind::table) {
    refuse_trunnion(pair.kind == RotaryPairKind::head ? "both rotary axes are in the head"
                                                      : "one rotary axis is in the head");
  }
  const Axis& cradle = machine.axes[pair.first];
  const Axis& table = machine.axes[pair.second];
  const bool a = cradle.name.front() == 'A' && (cradle.direction - Eigen::Vector3d::UnitX()).norm() < kAlong;
  const bool b = cradle.name.front() == 'B' && (cradle.direction - Eigen::Vector3d::UnitY()).norm() < kAlong;
  if (!a && !b) refuse_trunnion(fmt::format("the cradle is {}", cradle.name));
  if (table.name.front() != 'C' || (table.direction - Eigen::Vector3d::UnitZ()).norm() > kAlong) {
    refuse_trunnion(fmt::format("the table is {}", table.name));
  }
  if (cradle.primed != table.primed) refuse_trunnion("only one of the rotary axes is primed");
  if ((machine.tool_direction - Eigen::Vector3d::UnitZ()).norm() > kAlong) {
    refuse_trunnion("the spindle is not along Z");
  }
  return {a ? "xyzac-trt-kins" : "xyzbc-trt-kins",
          a ? "y-offset" : "x-offset",
          a ? 1 : 0,
          pair.first,
          pair.second,
          cradle.primed};
}

std::vector<std::string> point_pins(const Trunnion& trunnion) {
  return {trunnion.pin("x-rot-point"), trunnion.pin("y-rot-point"), trunnion.pin("z-rot-point")};
}

std::vector<PlainValue> trt_values(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                   std::optional<int>) {
  const Trunnion trunnion = trunnion_of(nominal.machine);
  const Machine& machine = geometry.machine;
  const Eigen::Vector3d table = machine.axes[trunnion.table].point - machine.tool_reference;
  const Eigen::Vector3d offset = machine.axes[trunnion.cradle].point - machine.axes[trunnion.table].point;
  std::vector<PlainValue> values;
  add_vector(values, point_pins(trunnion), ValueKind::length, table);
  values.push_back({trunnion.pin(trunnion.offset), ValueKind::length, offset[trunnion.across]});
  values.push_back({trunnion.pin("z-offset"), ValueKind::length, offset[2]});
  return values;
}

std::string trt_text(const BelievedMachine& nominal, const std::vector<KinematicValue>& values, std::optional<int>) {
  const Trunnion trunnion = trunnion_of(nominal.machine);
  std::string text = fmt::format(
      "# Kinematic values for LinuxCNC, mm. In the INI file: [KINS] KINEMATICS = {0}, LINEAR_UNITS = mm\n"
      "# The module is loaded by: loadrt {0}\n"
      "# Tool length: net tool-offset motion.tooloffset.z => {0}.tool-offset\n",
      trunnion.module);
  if (trunnion.primed) {
    text += fmt::format("setp {} 1\n", trunnion.pin("conventional-directions"));
  }
  for (const KinematicValue& value : values) text += fmt::format("setp {} {}\n", value.name, decimals(value.actual, 6));
  return text;
}

BelievedMachine trt_believed(const BelievedMachine& nominal, const NamedNumbers& numbers, std::optional<int>) {
  const Trunnion trunnion = trunnion_of(nominal.machine);
  BelievedMachine believed = nominal;
  Eigen::Vector3d& table = believed.machine.axes[trunnion.table].point;
  Eigen::Vector3d& cradle = believed.machine.axes[trunnion.cradle].point;
  table = nominal.machine.tool_reference + vector_of(numbers, point_pins(trunnion));
  cradle = table;
  cradle[trunnion.across] += numbers.at(trunnion.pin(trunnion.offset));
  cradle[2] += numbers.at(trunnion.pin("z-offset"));
  return believed;
}

std::vector<std::string> trt_settings(const BelievedMachine& nominal) {
  const Trunnion trunnion = trunnion_of(nominal.machine);
  std::vector<std::string> settings = {fmt::format(
      "[KINS] KINEMATICS = {}, and motion.tooloffset.z linked to {}.tool-offset", trunnion.module, trunnion.module)};
  if (trunnion.primed) {
    settings.push_back(
        "the table turns as ISO 841 says (primed axes): the pin conventional-directions is needed, which LinuxCNC "
        "2.9 of Debian 12 does not have; without it the module turns the other way");
  }
  if (nominal.machine.tool_offset.head<2>().norm() > 0) {
    settings.push_back(
        "the module knows tool offsets along Z only; those in X and Y of the machine file are not in it");
  }
  return settings;
}

}  // namespace

KinematicFormat linuxcnc_kinematic_values() {
  KinematicFormat format;
  format.name = "linuxcnc";
  format.what = "pins of xyzac-trt-kins or xyzbc-trt-kins (a table in a cradle), setp lines for a HAL file";
  format.convention =
      "mm, in joint positions: the gauge point with all joints at zero is the origin. rot-point: a point of the axis "
      "of C; offset: from there to the axis of A or B";
  format.cannot = "the module has positions of axes and no directions; error motions and linear axes are not in it";
  format.file_name = "kinematics.hal";
  format.values = trt_values;
  format.text = trt_text;
  format.read = [](const std::string& text) { return numbers_of_lines(text, "setp ", " "); };
  format.believed = trt_believed;
  format.settings = trt_settings;
  return format;
}

}  // namespace abbe
