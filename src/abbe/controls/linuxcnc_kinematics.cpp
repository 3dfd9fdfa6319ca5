#include <fmt/format.h>

#include <cmath>

#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/linuxcnc_modules.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

LinuxcncModule module_of(const Machine& nominal) {
  std::size_t rotary = 0;
  for (const Axis& axis : nominal.axes) rotary += axis.kind == AxisKind::rotary ? 1 : 0;
  if (rotary == 3) return nutating_head_module(nominal);
  const RotaryPair pair = rotary_pair(nominal, "linuxcnc");
  switch (pair.kind) {
    case RotaryPairKind::head:
      return meeting_head_module(nominal, pair);
    case RotaryPairKind::mixed:
      refuse_chain_of_modules("one rotary axis is in the head, the other in the table");
    case RotaryPairKind::table:
      break;
  }
  return nominal.axes[pair.second].name.front() == 'A' ? dual_table_module(nominal, pair)
                                                       : trunnion_module(nominal, pair);
}

/// How a pin is written: in mm, degrees.
double unit_of_pin(ValueKind kind) { return kind == ValueKind::angle ? kDegree : 1; }

std::string module_text(const BelievedMachine& nominal, const std::vector<KinematicValue>& values, std::optional<int>) {
  std::string text = module_of(nominal.machine).lines;
  for (const KinematicValue& value : values) {
    const int count = value.kind == ValueKind::angle ? 9 : 6;
    text += fmt::format("setp {} {}\n", value.name, decimals(value.actual / unit_of_pin(value.kind), count));
  }
  return text;
}

NamedNumbers pins_in(const std::string& text) {
  NamedNumbers pins = numbers_of_lines(text, "setp ", " ");
  for (auto& [name, value] : pins) {
    if (name.ends_with("-angle")) value *= kDegree;
  }
  return pins;
}

}  // namespace

void refuse_chain_of_modules(const std::string& why) {
  throw InputError({.field = "--for linuxcnc"}, why,
                   "the chain of a kinematics module, as docs/kinematic-values.md lists them: xyzac-trt-kins, "
                   "xyzbc-trt-kins, xyzab_tdr_kins, 5axiskins, xyzacb_trsrn or xyzbca_trsrn; --for values takes every "
                   "machine");
}

void add_offsets_left_out(const Machine& nominal, LinuxcncModule& module) {
  if (nominal.tool_offset.head<2>().norm() == 0) return;
  module.settings.push_back(
      "the module knows tool offsets along Z only; those in X and Y of the machine file are not in it");
}

KinematicFormat linuxcnc_kinematic_values() {
  KinematicFormat format;
  format.name = "linuxcnc";
  format.what = "pins of a kinematics module that fits the chain, setp lines for a HAL file";
  format.convention =
      "mm and degrees, in joint positions: the gauge point with all joints at zero is the origin; "
      "docs/kinematic-values.md explains the pins";
  format.cannot =
      "the modules have positions of axes and, apart from one angle of xyzacb_trsrn and xyzbca_trsrn, no directions; "
      "error motions and linear axes are not in them";
  format.file_name = "kinematics.hal";
  format.values = [](const BelievedMachine& nominal, const BelievedMachine& geometry, std::optional<int>) {
    return module_of(nominal.machine).values(geometry.machine);
  };
  format.text = module_text;
  format.read = pins_in;
  format.believed = [](const BelievedMachine& nominal, const NamedNumbers& pins, std::optional<int>) {
    BelievedMachine believed = nominal;
    module_of(nominal.machine).believe(pins, believed.machine);
    return believed;
  };
  format.settings = [](const BelievedMachine& nominal) { return module_of(nominal.machine).settings; };
  return format;
}

}  // namespace abbe
