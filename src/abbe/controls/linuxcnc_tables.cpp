// Modules of LinuxCNC with both rotary axes in the table.
#include <fmt/format.h>

#include "abbe/controls/linuxcnc_modules.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

bool is_along(const Axis& axis, char letter, const Vector3d& direction) {
  return axis.name.front() == letter && (axis.direction - direction).norm() < kModuleDirection;
}

void require_spindle_along_z(const Machine& nominal) {
  if ((nominal.tool_direction - Vector3d::UnitZ()).norm() > kModuleDirection) {
    refuse_chain_of_modules("the spindle is not along Z");
  }
}

std::vector<std::string> point_pins(const std::string& module) {
  return {module + ".x-rot-point", module + ".y-rot-point", module + ".z-rot-point"};
}

}  // namespace

LinuxcncModule trunnion_module(const Machine& nominal, const RotaryPair& pair) {
  const Axis& cradle = nominal.axes[pair.first];
  const Axis& table = nominal.axes[pair.second];
  const bool a = is_along(cradle, 'A', Vector3d::UnitX());
  if (!a && !is_along(cradle, 'B', Vector3d::UnitY())) {
    refuse_chain_of_modules(fmt::format("the cradle is {}", cradle.name));
  }
  if (!is_along(table, 'C', Vector3d::UnitZ())) refuse_chain_of_modules(fmt::format("the table is {}", table.name));
  if (cradle.primed != table.primed) refuse_chain_of_modules("only one of the rotary axes is primed");
  require_spindle_along_z(nominal);
  LinuxcncModule module;
  module.name = a ? "xyzac-trt-kins" : "xyzbc-trt-kins";
  module.lines = fmt::format(
      "# Kinematic values for LinuxCNC, mm. In the INI file: [KINS] KINEMATICS = {0}, LINEAR_UNITS = mm\n"
      "# The module is loaded by: loadrt {0}\n"
      "# Tool length: net tool-offset motion.tooloffset.z => {0}.tool-offset\n",
      module.name);
  module.settings = {
      fmt::format("[KINS] KINEMATICS = {0}, and motion.tooloffset.z linked to {0}.tool-offset", module.name)};
  if (cradle.primed) {
    module.lines += fmt::format("setp {}.conventional-directions 1\n", module.name);
    module.settings.push_back(
        "the table turns as ISO 841 says (primed axes): the pin conventional-directions is needed, which LinuxCNC "
        "2.9 of Debian 12 does not have; without it the module turns the other way");
  }
  add_offsets_left_out(nominal, module);
  const Eigen::Index across = a ? 1 : 0;
  const std::string offset = module.name + (a ? ".y-offset" : ".x-offset"), height = module.name + ".z-offset";
  const std::vector<std::string> point = point_pins(module.name);
  module.values = [pair, point, offset, height, across](const Machine& geometry) {
    const Vector3d at = geometry.axes[pair.second].point;
    const Vector3d apart = geometry.axes[pair.first].point - at;
    std::vector<PlainValue> values;
    add_vector(values, point, ValueKind::length, at - geometry.tool_reference);
    values.push_back({offset, ValueKind::length, apart[across]});
    values.push_back({height, ValueKind::length, apart[2]});
    return values;
  };
  module.believe = [pair, point, offset, height, across](const NamedNumbers& pins, Machine& believed) {
    Vector3d& at = believed.axes[pair.second].point;
    at = believed.tool_reference + vector_of(pins, point);
    Vector3d& carrier = believed.axes[pair.first].point;
    carrier = at;
    carrier[across] += pins.at(offset);
    carrier[2] += pins.at(height);
  };
  return module;
}

LinuxcncModule dual_table_module(const Machine& nominal, const RotaryPair& pair) {
  const Axis& carrier = nominal.axes[pair.first];
  const Axis& table = nominal.axes[pair.second];
  if (!is_along(carrier, 'B', Vector3d::UnitY()) || !is_along(table, 'A', Vector3d::UnitX())) {
    refuse_chain_of_modules(fmt::format("the table is {}, carried by {}", table.name, carrier.name));
  }
  if (!carrier.primed || !table.primed) {
    refuse_chain_of_modules("xyzab_tdr_kins turns both tables as ISO 841 says, and a rotary axis is not primed");
  }
  require_spindle_along_z(nominal);
  LinuxcncModule module;
  module.name = "xyzab_tdr_kins";
  module.lines = fmt::format(
      "# Kinematic values for LinuxCNC, mm. In the INI file: [KINS] KINEMATICS = {0}, LINEAR_UNITS = mm\n"
      "# They count where motion.switchkins-type is 1.\n"
      "# Tool length: net tool-offset motion.tooloffset.z => {0}.tool-offset-z\n",
      module.name);
  module.settings = {
      fmt::format("[KINS] KINEMATICS = {0}, and motion.tooloffset.z linked to {0}.tool-offset-z", module.name),
      "motion.switchkins-type is 1 where the program is one for five axes (0: the joints are the axes)"};
  add_offsets_left_out(nominal, module);
  const std::vector<std::string> point = point_pins(module.name);
  const std::string height = module.name + ".z-offset";
  // X of A and Y of B are places along these axes: the first line is crossed at X and Z, the second at Y and Z. The
  // pin x-offset is one of them: it drops out of the equations.
  module.values = [pair, point, height](const Machine& geometry) {
    const Vector3d& b = geometry.axes[pair.first].point;
    const Vector3d& a = geometry.axes[pair.second].point;
    std::vector<PlainValue> values;
    add_vector(values, point, ValueKind::length, Vector3d(b.x(), a.y(), b.z()) - geometry.tool_reference);
    values.push_back({height, ValueKind::length, a.z() - b.z()});
    return values;
  };
  module.believe = [pair, point, height](const NamedNumbers& pins, Machine& believed) {
    Vector3d& b = believed.axes[pair.first].point;
    b = believed.tool_reference + vector_of(pins, point);
    believed.axes[pair.second].point = b + Vector3d(0, 0, pins.at(height));
  };
  return module;
}

}  // namespace abbe
