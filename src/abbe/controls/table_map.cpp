#include "abbe/controls/table_map.h"

#include <array>
#include <string>
#include <vector>

#include "abbe/machine/axis_unit.h"

namespace abbe {

MapData control_table_map(const Machine& machine, const ControlTables& made) {
  MapData data;
  for (std::vector<double>& coordinate : data.points) coordinate.resize(made.poses.count());
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    const Eigen::Vector3d point = nominal_workpiece_from_tool(machine, made.poses.pose(k)).translation;
    for (std::size_t c = 0; c < 3; ++c) data.points[c][k] = point[static_cast<Eigen::Index>(c)];
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    data.fields.push_back({axis.name,
                           axis.kind == AxisKind::rotary ? Quantity::angle : Quantity::length,
                           position_suffix(axis),
                           {made.poses.axis[i]}});
  }
  const auto add = [&](const std::string& name, const PoseDeviations& deviations) {
    data.fields.push_back({name, Quantity::length, "um", {deviations.position}});
    data.fields.push_back({name + "_direction", Quantity::angle, "urad", {deviations.orientation}});
  };
  add("before", made.before);
  add("after", made.after);
  add("ideal", made.ideal);
  // Poses run with the last axis fastest, map files with the first direction fastest.
  data.grid.assign(made.grid.rbegin(), made.grid.rend());
  return data;
}

}  // namespace abbe
