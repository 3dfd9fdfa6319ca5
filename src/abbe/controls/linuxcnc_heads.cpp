// Modules of LinuxCNC with rotary axes in the head.
#include <fmt/format.h>

#include <cmath>

#include "abbe/controls/linuxcnc_modules.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

constexpr double kModuleLength = 1e-6;  // mm, how far axes may be from where a module has them

bool is_head_axis_c(const Axis& axis) {
  return axis.name.front() == 'C' && (axis.direction - Vector3d::UnitZ()).norm() < kModuleDirection;
}

/// A machine of the modules *_trsrn: indices of its rotary axes, and the component across which all is drawn.
struct NutatingHead {
  std::string name;  ///< "xyzacb_trsrn"
  std::size_t table = 0, c = 0, nutating = 0;
  Eigen::Index plane = 1;  ///< the nutating axis and the pivot lie in the plane of it and Z
};

NutatingHead nutating_head_of(const Machine& nominal) {
  require_linear_axes(nominal, "linuxcnc");
  std::vector<std::size_t> of_table, of_head;
  for (std::size_t i = 0; i < nominal.axes.size(); ++i) {
    if (nominal.axes[i].kind == AxisKind::rotary)
      (i < nominal.workpiece_axis_count() ? of_table : of_head).push_back(i);
  }
  if (of_table.size() != 1) {
    refuse_chain_of_modules(fmt::format("of three rotary axes, {} are in the table", of_table.size()));
  }
  NutatingHead head;
  head.table = of_table[0];
  head.c = of_head[0];
  head.nutating = of_head[1];
  const Axis& table = nominal.axes[head.table];
  const Axis& nutating = nominal.axes[head.nutating];
  const bool a = table.name.front() == 'A', b = table.name.front() == 'B';
  if ((!a && !b) || (table.direction - (a ? Vector3d::UnitX() : Vector3d::UnitY())).norm() > kModuleDirection) {
    refuse_chain_of_modules(fmt::format("the table is {}", table.name));
  }
  if (!table.primed) refuse_chain_of_modules(fmt::format("the module turns {}' as ISO 841 says", table.name));
  if (!is_head_axis_c(nominal.axes[head.c])) {
    refuse_chain_of_modules(fmt::format("{} carries the head, not C along Z", nominal.axes[head.c].name));
  }
  head.plane = a ? 1 : 0;
  const Eigen::Index across = a ? 0 : 1;
  if (nutating.name.front() != (a ? 'B' : 'A') || std::abs(nutating.direction[across]) > kModuleDirection) {
    refuse_chain_of_modules(fmt::format("{} does not lie in the plane of {} and Z", nutating.name, a ? "Y" : "X"));
  }
  if (std::abs(nutating.point[across] - nominal.tool_reference[across]) > kModuleLength) {
    refuse_chain_of_modules(fmt::format("{} does not meet the line of the spindle", nutating.name));
  }
  head.name = a ? "xyzacb_trsrn" : "xyzbca_trsrn";
  return head;
}

}  // namespace

LinuxcncModule meeting_head_module(const Machine& nominal, const RotaryPair& pair) {
  const Axis& c = nominal.axes[pair.first];
  const Axis& b = nominal.axes[pair.second];
  if (!is_head_axis_c(c)) refuse_chain_of_modules(fmt::format("{} carries the head, not C along Z", c.name));
  if (b.name.front() != 'B' || (b.direction + Vector3d::UnitY()).norm() > kModuleDirection) {
    refuse_chain_of_modules(
        fmt::format("5axiskins turns B about -Y, against ISO 841, and the head has {} about ({:g}, {:g}, {:g})", b.name,
                    b.direction.x(), b.direction.y(), b.direction.z()));
  }
  const Vector3d& gauge = nominal.tool_reference;
  if ((c.point - gauge).head<2>().norm() > kModuleLength || std::abs((b.point - gauge).x()) > kModuleLength) {
    refuse_chain_of_modules("in 5axiskins the axes of the head meet in the line of the spindle, and here they do not");
  }
  if ((nominal.tool_direction - Vector3d::UnitZ()).norm() > kModuleDirection) {
    refuse_chain_of_modules("the spindle is not along Z");
  }
  LinuxcncModule module;
  module.name = "5axiskins";
  // The pin takes the length of the tool too.
  module.lines =
      "# Kinematic values for LinuxCNC, mm. In the INI file: [KINS] KINEMATICS = 5axiskins, LINEAR_UNITS = mm\n"
      "# spindle-pivot is a sum2: loadrt sum2 names=spindle-pivot, addf spindle-pivot servo-thread,\n"
      "# net tool-offset motion.tooloffset.z => spindle-pivot.in1\n"
      "# net pivot-length spindle-pivot.out => 5axiskins.pivot-length\n";
  module.settings = {
      "[KINS] KINEMATICS = 5axiskins, and 5axiskins.pivot-length linked to the sum of this value and "
      "motion.tooloffset.z (component sum2, named spindle-pivot)"};
  add_offsets_left_out(nominal, module);
  const std::string length = "spindle-pivot.in0";
  module.values = [pair, length](const Machine& geometry) {
    return std::vector<PlainValue>{
        {length, ValueKind::length, geometry.axes[pair.second].point.z() - geometry.tool_reference.z()}};
  };
  module.believe = [pair, length](const NamedNumbers& pins, Machine& believed) {
    believed.axes[pair.second].point.z() = believed.tool_reference.z() + pins.at(length);
  };
  return module;
}

LinuxcncModule nutating_head_module(const Machine& nominal) {
  const NutatingHead head = nutating_head_of(nominal);
  if ((nominal.tool_direction - Vector3d::UnitZ()).norm() > kModuleDirection) {
    refuse_chain_of_modules("the spindle is not along Z");
  }
  LinuxcncModule module;
  module.name = head.name;
  const std::string pins = head.name + "_kins.";
  module.lines = fmt::format(
      "# Kinematic values for LinuxCNC, mm and degrees. In the INI file: [KINS] KINEMATICS = {}, LINEAR_UNITS = mm\n"
      "# They count where motion.switchkins-type is 1.\n"
      "# Tool length: net tool-offset motion.tooloffset.z => {}tool-offset-z\n",
      head.name, pins);
  module.settings = {
      fmt::format("[KINS] KINEMATICS = {}, and motion.tooloffset.z linked to {}tool-offset-z", head.name, pins),
      "motion.switchkins-type is 1 where the program is one for six axes (0: the joints are the axes)"};
  add_offsets_left_out(nominal, module);
  const Eigen::Index plane = head.plane;
  const std::string letter = plane == 1 ? "y" : "x";
  const std::string pivot = pins + letter + "-pivot", pivot_z = pins + "z-pivot", offset_x = pins + "x-offset",
                    offset_y = pins + "y-offset", table = pins + letter + "-rot-axis", table_z = pins + "z-rot-axis",
                    angle = pins + "nut-angle";
  module.values = [=](const Machine& geometry) {
    const Vector3d& gauge = geometry.tool_reference;
    const Axis& nutating = geometry.axes[head.nutating];
    Vector3d to_pivot = nutating.point - gauge;
    to_pivot[1 - plane] = 0;
    const Vector3d offset = geometry.axes[head.c].point - gauge - to_pivot;
    const Vector3d to_table = geometry.axes[head.table].point - gauge;
    return std::vector<PlainValue>{
        {pivot, ValueKind::length, to_pivot[plane]},
        {pivot_z, ValueKind::length, to_pivot.z()},
        {offset_x, ValueKind::length, offset.x()},
        {offset_y, ValueKind::length, offset.y()},
        {table, ValueKind::length, to_table[plane]},
        {table_z, ValueKind::length, to_table.z()},
        {angle, ValueKind::angle, std::atan2(nutating.direction[plane], nutating.direction.z())}};
  };
  module.believe = [=](const NamedNumbers& of, Machine& believed) {
    const Vector3d& gauge = believed.tool_reference;
    Axis& nutating = believed.axes[head.nutating];
    nutating.point = gauge;
    nutating.point[plane] += of.at(pivot);
    nutating.point.z() += of.at(pivot_z);
    nutating.direction.setZero();
    nutating.direction[plane] = std::sin(of.at(angle));
    nutating.direction.z() = std::cos(of.at(angle));
    Vector3d& c = believed.axes[head.c].point;
    c = nutating.point + Vector3d(of.at(offset_x), of.at(offset_y), 0);
    Vector3d& at = believed.axes[head.table].point;
    at[plane] = gauge[plane] + of.at(table);
    at.z() = gauge.z() + of.at(table_z);
  };
  return module;
}

}  // namespace abbe
