#include "yin/commands.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "yin/printed.h"
#include "yin/reference.h"

namespace abbe {
namespace {

void add_axis_columns(ReproducedTable& table, const std::string& which) {
  add_columns(table, {"X" + which, "Y" + which, "Z" + which}, "mm", 4);
  add_columns(table, {"A" + which, "C1" + which}, "deg", 4);
}

void add_axis_cells(std::vector<ReproducedCell>& row, const SwingHeadCommand& c) {
  for (const double value : {c.x, c.y, c.z, c.a / kDegree, c.c1 / kDegree}) row.emplace_back(value);
}

}  // namespace

std::vector<YinAxisCommands> yin_axis_commands(const YinPositioning& positioning) {
  const SwingHeadLinkage l = yin_linkage();
  const RigidTransform& place = positioning.placement.table_from_workpiece;
  std::vector<YinAxisCommands> commands;
  for (const YinPoint& point : yin_curve()) {
    const Eigen::Vector3d p = place * point.point, beam = place.rotation * point.normal;
    YinAxisCommands c;
    c.point = point.point;
    c.positive = swing_head_command(l, LinkageConvention::table_moves, p, beam, 1);
    c.negative = swing_head_command(l, LinkageConvention::table_moves, p, beam, -1);
    c.printed = yin_printed::inverse(l, p, beam);
    c.printed_beam_off = angle_between(swing_head_beam(c.printed), beam);
    commands.push_back(c);
  }
  return commands;
}

std::vector<ReproducedTable> yin_command_tables(const std::vector<YinAxisCommands>& commands) {
  ReproducedTable table{
      "axis-commands",
      "Axis commands for the points x, y, z of Table A4 (workpiece frame): Tables 2 and 3, convention "
      "U, C2 = 0, beam along the normal of the cylinder, A > 0",
      {{"number", "", 0}, {"x", "mm", 3}, {"y", "mm", 3}, {"z", "mm", 3}},
      {},
      {}};
  ReproducedTable others{"axis-commands-other",
                         "The same with A < 0, and by equation (6) as printed (convention P)",
                         {{"number", "", 0}},
                         {},
                         {},
                         false};
  add_axis_columns(table, "");
  add_axis_columns(others, " negative");
  add_axis_columns(others, " printed");
  others.columns.push_back({"beam off printed", "deg", 4});
  double largest = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const YinAxisCommands& c = commands[i];
    std::vector<ReproducedCell> row = {i + 1, c.point.x(), c.point.y(), c.point.z()}, other = {i + 1};
    add_axis_cells(row, c.positive);
    add_axis_cells(other, c.negative);
    add_axis_cells(other, c.printed);
    other.emplace_back(c.printed_beam_off / kDegree);
    table.rows.push_back(std::move(row));
    others.rows.push_back(std::move(other));
    largest = std::max(largest, c.printed_beam_off);
  }
  table.notes = {fmt::format(
      "The paper prints the points and no commands. tables/axis-commands-other.csv and --json hold the "
      "commands with A < 0 and by (6) as printed, which turns the beam {:.2f} degrees away: it comes out of the part.",
      largest / kDegree)};
  return {std::move(table), std::move(others)};
}

}  // namespace abbe
