#include "reproduce/yin_commands.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "reproduce/yin_printed.h"
#include "reproduce/yin_reference.h"

namespace abbe {
namespace {

nlohmann::ordered_json command_json(const SwingHeadCommand& c) {
  return {{"X_mm", c.x}, {"Y_mm", c.y}, {"Z_mm", c.z}, {"A_deg", c.a / kDegree}, {"C1_deg", c.c1 / kDegree}};
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

nlohmann::ordered_json yin_commands_json(const std::vector<YinAxisCommands>& commands) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const YinAxisCommands& c = commands[i];
    json.push_back({{"number", i + 1},
                    {"point_mm", {c.point.x(), c.point.y(), c.point.z()}},
                    {"positive_A", command_json(c.positive)},
                    {"negative_A", command_json(c.negative)},
                    {"equation_6_as_printed", command_json(c.printed)},
                    {"equation_6_beam_off_deg", c.printed_beam_off / kDegree}});
  }
  return json;
}

void print_yin_commands(const std::vector<YinAxisCommands>& commands) {
  if (commands.empty()) return;
  fmt::print(
      "Table A4: the paper's points in the workpiece frame, and the axis commands for them (Tables 2 and 3, convention "
      "U, C2 = 0,\nbeam along the normal of the cylinder, A > 0)\n");
  fmt::print("  {:>3}{:>10}{:>9}{:>9}  |{:>11}{:>11}{:>11}{:>10}{:>10}\n", "No.", "x / mm", "y / mm", "z / mm",
             "X / mm", "Y / mm", "Z / mm", "A / deg", "C1 / deg");
  double largest = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const YinAxisCommands& c = commands[i];
    fmt::print("  {:>3}{:>10.3f}{:>9.3f}{:>9.3f}  |{:>11.4f}{:>11.4f}{:>11.4f}{:>10.4f}{:>10.4f}\n", i + 1, c.point.x(),
               c.point.y(), c.point.z(), c.positive.x, c.positive.y, c.positive.z, c.positive.a / kDegree,
               c.positive.c1 / kDegree);
    largest = std::max(largest, c.printed_beam_off);
  }
  fmt::print(
      "  The paper prints no commands (its G code is \"available on request\"). A < 0 and (6) as printed are in "
      "axis_commands.csv\n  and --json; (6) as printed turns the beam {:.2f} degrees away: it comes out of the "
      "part.\n\n",
      largest / kDegree);
}

std::string yin_commands_csv(const std::vector<YinAxisCommands>& commands) {
  std::string text =
      "# Points of Table A4 and the axis commands for them: Tables 2 and 3, convention U, C2 = 0; both signs of A; "
      "equation (6) as printed (convention P)\n"
      "number,x_mm,y_mm,z_mm";
  for (const char* which : {"", "_negative", "_printed"}) {
    for (const char* axis : {"X", "Y", "Z", "A", "C1"}) {
      text += fmt::format(",{}{}_{}", axis, which, axis[0] == 'A' || axis[0] == 'C' ? "deg" : "mm");
    }
  }
  text += ",beam_off_printed_deg\n";
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const YinAxisCommands& c = commands[i];
    text += fmt::format("{},{:.3f},{:.3f},{:.3f}", i + 1, c.point.x(), c.point.y(), c.point.z());
    for (const SwingHeadCommand* command : {&c.positive, &c.negative, &c.printed}) {
      text += fmt::format(",{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}", command->x, command->y, command->z,
                          command->a / kDegree, command->c1 / kDegree);
    }
    text += fmt::format(",{:.6f}\n", c.printed_beam_off / kDegree);
  }
  return text;
}

}  // namespace abbe
