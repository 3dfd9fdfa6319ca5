#include "abbe/formats/scan_plan_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numbers>

#include "abbe/formats/ply_file.h"

namespace abbe {
namespace {

double shown(const Axis& axis, double command) {
  return axis.kind == AxisKind::rotary ? command * 180 / std::numbers::pi : command;
}

/// What a comment in parentheses may hold.
std::string comment(std::string text) {
  for (char& c : text) {
    if (c == '(' || c == ')' || c < ' ') c = ' ';
  }
  return text;
}

}  // namespace

std::string scan_plan_csv(const Machine& machine, const ScanPlan& plan) {
  std::string text = "time_s";
  auto out = std::back_inserter(text);
  for (const Axis& axis : machine.axes) {
    fmt::format_to(out, ",{}_{}", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
  }
  text += ",measures,face,line,x_mm,y_mm,z_mm,i,j,k\n";
  double time = 0;
  for (std::size_t n = 0; n < plan.moves.size(); ++n) {
    const PlannedMove& move = plan.moves[n];
    time += move.time;
    fmt::format_to(out, "{:.4f}", time);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      fmt::format_to(out, ",{:.7f}", shown(machine.axes[i], plan.positions.axis[i][n]));
    }
    fmt::format_to(out, ",{},{},{},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f}\n", move.measures ? 1 : 0, move.face + 1,
                   move.line + 1, move.point.x(), move.point.y(), move.point.z(), move.beam.x(), move.beam.y(),
                   move.beam.z());
  }
  return text;
}

std::string scan_plan_program(const Machine& machine, const ScanPlan& plan, const std::string& title) {
  std::string text = fmt::format("({})\nG21 G90 G94\nG93\n", comment(title));
  auto out = std::back_inserter(text);
  std::size_t face = plan.faces.size(), line = 0;
  for (std::size_t n = 0; n < plan.moves.size(); ++n) {
    const PlannedMove& move = plan.moves[n];
    if (move.measures && (move.face != face || move.line != line)) {
      face = move.face;
      line = move.line;
      fmt::format_to(out, "(face {} line {}, {})\n", face + 1, line + 1, scan_path_name(plan.faces[face].kind));
    }
    text += "G1";
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      fmt::format_to(out, " {}{:.6f}", machine.axes[i].name, shown(machine.axes[i], plan.positions.axis[i][n]));
    }
    // The first block has no way before it that could be timed: a minute.
    fmt::format_to(out, " F{:.4f}\n", 60 / (n == 0 ? 60.0 : std::max(move.time, 1e-3)));
  }
  text += "G94\nM2\n";
  return text;
}

std::string scan_coverage_ply(const ScanPlan& plan) {
  const auto count = static_cast<Eigen::Index>(plan.coverage.size());
  Eigen::Matrix3Xd points(3, count);
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> colours(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const CoverageSample& sample = plan.coverage[static_cast<std::size_t>(i)];
    points.col(i) = sample.point;
    colours.col(i) << (sample.covered ? 40 : 210), (sample.covered ? 160 : 40), (sample.covered ? 70 : 40);
  }
  PlyParts parts{points};
  parts.colours = colours;
  return ply_bytes(parts);
}

}  // namespace abbe
