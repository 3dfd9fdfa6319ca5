#include "abbe/machine/machine.h"

#include <array>
#include <cassert>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {

std::size_t Machine::workpiece_axis_count() const {
  std::size_t count = 0;
  while (count < axes.size() && axes[count].side == ChainSide::workpiece) ++count;
  return count;
}

std::size_t Machine::find_axis(std::string_view axis_name) const {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].name == axis_name) return i;
  }
  return npos;
}

std::string Machine::chain() const {
  std::string text = "w";
  const std::size_t workpiece_side = workpiece_axis_count();
  for (std::size_t i = 0; i <= axes.size(); ++i) {
    if (i == workpiece_side) text += " b";
    if (i < axes.size()) text += " " + axes[i].name + (axes[i].primed ? "'" : "");
  }
  return text + " t";
}

bool axis_kind_from_letter(char letter, AxisKind& kind) {
  if (std::string_view("XYZUVWPQR").find(letter) != std::string_view::npos) {
    kind = AxisKind::linear;
  } else if (std::string_view("ABCDE").find(letter) != std::string_view::npos) {
    kind = AxisKind::rotary;
  } else {
    return false;
  }
  return true;
}

Eigen::Vector3d direction_from_letter(char letter) {
  if (std::string_view("XUPAD").find(letter) != std::string_view::npos) return Eigen::Vector3d::UnitX();
  if (std::string_view("YVQBE").find(letter) != std::string_view::npos) return Eigen::Vector3d::UnitY();
  return Eigen::Vector3d::UnitZ();
}

RigidTransform nominal_motion(const Axis& axis, double position) {
  const double displacement = axis.sense() * position;
  if (axis.kind == AxisKind::linear) return RigidTransform::translate(displacement * axis.direction);
  const Eigen::Matrix3d rotation = rotation_about(axis.direction, displacement);
  return {rotation, axis.point - rotation * axis.point};
}

namespace {

/// Positions of the axes at commands: these themselves where no axis is coupled.
class NominalPositions {
 public:
  NominalPositions(const Machine& machine, std::span<const double> commands) : at_(commands) {
    assert(commands.size() == machine.axes.size());
    if (machine.couplings.empty()) return;
    positions_of_commands(machine, commands.data(), coupled_.data());
    at_ = {coupled_.data(), commands.size()};
  }
  NominalPositions(const NominalPositions&) = delete;
  NominalPositions& operator=(const NominalPositions&) = delete;
  std::span<const double> span() const { return at_; }

 private:
  std::array<double, kMaxAxes> coupled_;
  std::span<const double> at_;
};

RigidTransform bed_from_tool(const Machine& machine, std::span<const double> positions) {
  assert(positions.size() == machine.axes.size());
  RigidTransform from_tool;
  for (std::size_t i = machine.workpiece_axis_count(); i < machine.axes.size(); ++i) {
    from_tool = from_tool * nominal_motion(machine.axes[i], positions[i]);
  }
  return from_tool * RigidTransform::translate(machine.tool_reference + machine.tool_offset);
}

RigidTransform bed_from_workpiece(const Machine& machine, std::span<const double> positions) {
  assert(positions.size() == machine.axes.size());
  RigidTransform from_workpiece;
  for (std::size_t i = machine.workpiece_axis_count(); i-- > 0;) {
    from_workpiece = from_workpiece * nominal_motion(machine.axes[i], positions[i]);
  }
  return from_workpiece * machine.bed_from_workpiece;
}

}  // namespace

RigidTransform nominal_bed_from_tool(const Machine& machine, const std::vector<double>& commands) {
  return bed_from_tool(machine, NominalPositions(machine, commands).span());
}

RigidTransform nominal_bed_from_workpiece(const Machine& machine, const std::vector<double>& commands) {
  return bed_from_workpiece(machine, NominalPositions(machine, commands).span());
}

RigidTransform nominal_workpiece_from_tool(const Machine& machine, std::span<const double> commands) {
  const NominalPositions positions(machine, commands);
  return bed_from_workpiece(machine, positions.span()).inverse() * bed_from_tool(machine, positions.span());
}

RigidTransform nominal_workpiece_from_tool(const Machine& machine, const std::vector<double>& commands) {
  return nominal_workpiece_from_tool(machine, std::span<const double>(commands));
}

}  // namespace abbe
