// A program outside the project: an error of the table's squareness seen at the tool.
#include <abbe/errors/actual_pose.h>
#include <abbe/machine/machine.h>

#include <cmath>
#include <cstdio>

int main() {
  abbe::Machine machine;
  abbe::Axis c{.name = "C", .kind = abbe::AxisKind::rotary, .side = abbe::ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  const abbe::Axis x{.name = "X", .side = abbe::ChainSide::workpiece, .primed = true};
  abbe::Axis z{.name = "Z", .side = abbe::ChainSide::tool};
  z.direction = Eigen::Vector3d::UnitZ();
  machine.axes = {c, x, z};

  const std::vector<double> positions{0, 10, 5};
  const Eigen::Vector3d nominal = abbe::nominal_workpiece_from_tool(machine, positions).translation;
  std::printf("%s: tool at %.3f %.3f %.3f mm\n", machine.chain().c_str(), nominal.x(), nominal.y(), nominal.z());

  abbe::ErrorSet errors;
  errors.locations.push_back({.axis = 2, .component = abbe::Component::B, .value = 1e-3});  // Z leans towards X
  abbe::Deviation deviation;
  if (abbe::tool_deviation(machine, errors, positions, deviation) != abbe::PoseStatus::ok) return 1;
  std::printf("deviation %.4f %.4f %.4f mm\n", deviation[0], deviation[1], deviation[2]);
  return std::abs(deviation[0] - 5e-3) < 1e-6 ? 0 : 1;
}
