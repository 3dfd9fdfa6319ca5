#include "abbe/formats/readings/scan_plan_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "abbe/formats/nc/program_text.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// By ScanObstacle.
constexpr std::array<std::array<std::uint8_t, 3>, kScanObstacleCount> kColours = {
    {{40, 160, 70}, {230, 160, 0}, {110, 110, 110}, {0, 115, 200}, {205, 45, 40}, {150, 70, 170}, {240, 220, 60}}};

}  // namespace

std::string scan_plan_csv(const Machine& machine, const ScanPlan& plan) {
  std::string text = "time_s";
  auto out = std::back_inserter(text);
  for (const Axis& axis : machine.axes) {
    fmt::format_to(out, ",{}_{}", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
  }
  text += ",measures,blocked,face,line,x_mm,y_mm,z_mm,i,j,k\n";
  double time = 0;
  for (std::size_t n = 0; n < plan.moves.size(); ++n) {
    const PlannedMove& move = plan.moves[n];
    time += move.time;
    fmt::format_to(out, "{:.4f}", time);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      fmt::format_to(out, ",{:.7f}", in_degrees_or_mm(machine.axes[i], plan.positions.axis[i][n]));
    }
    fmt::format_to(out, ",{},{},{},{},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f}\n", move.measures ? 1 : 0,
                   move.blocked ? 1 : 0, move.face + 1, move.line + 1, move.point.x(), move.point.y(), move.point.z(),
                   move.beam.x(), move.beam.y(), move.beam.z());
  }
  return text;
}

std::string scan_plan_program(const Machine& machine, const ScanPlan& plan, const std::string& title,
                              const PathProgramOptions& options) {
  std::string text = program_comment(title) + "G21 G90 G94\nG93\n";
  auto out = std::back_inserter(text);
  std::size_t face = plan.faces.size(), line = 0;
  for (std::size_t n = 0; n < plan.moves.size(); ++n) {
    const PlannedMove& move = plan.moves[n];
    if (move.measures && (move.face != face || move.line != line)) {
      face = move.face;
      line = move.line;
      fmt::format_to(out, "(face {} line {}, {})\n", face + 1, line + 1, scan_path_name(plan.faces[face].kind));
    }
    // Before the first move of such a way; the one before measures.
    if (move.blocked && (n == 0 || plan.moves[n - 1].measures)) {
      text += "(no clear way to the next line: the probe may touch the part or the stage)\nM0\n";
    }
    text += "G1";
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      fmt::format_to(out, " {}{}", axis_word(machine.axes[i].name, options),
                     fixed_number(in_degrees_or_mm(machine.axes[i], plan.positions.axis[i][n]), options.decimals));
    }
    // The first block has no way before it that could be timed: a minute.
    fmt::format_to(out, " F{:.4f}\n", 60 / (n == 0 ? 60.0 : std::max(move.time, 1e-3)));
  }
  text += "G94\nM2\n";
  return text;
}

std::array<std::uint8_t, 3> scan_obstacle_colour(ScanObstacle obstacle) {
  return kColours[static_cast<std::size_t>(obstacle)];
}

std::string scan_coverage_ply(const ScanPlan& plan) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment unit mm\ncomment obstacle:";
  for (std::size_t i = 0; i < kScanObstacleCount; ++i) {
    bytes += fmt::format(" {} {}", i, scan_obstacle_name(static_cast<ScanObstacle>(i)));
  }
  bytes += fmt::format(
      "\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty uint face\nproperty uchar obstacle\nend_header\n",
      plan.coverage.size());
  const auto put = [&](const auto& value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    bytes.append(raw.data(), raw.size());
  };
  for (const CoverageSample& sample : plan.coverage) {
    for (const double coordinate : sample.point) put(coordinate);
    for (const std::uint8_t part : kColours[static_cast<std::size_t>(sample.obstacle)]) put(part);
    put(static_cast<std::uint32_t>(sample.face));
    put(static_cast<std::uint8_t>(sample.obstacle));
  }
  return bytes;
}

nlohmann::ordered_json scan_plan_summary(const Machine& machine, const ScanPlan& plan, const std::string& part) {
  nlohmann::ordered_json json = {{"part", part},
                                 {"machine", machine.name},
                                 {"points", plan.points()},
                                 {"missed", plan.missed_places()},
                                 {"area_mm2", plan.area()},
                                 {"covered_percent", 100 * plan.covered_share()}};
  if (plan.area() > 0) json["points_per_mm2"] = static_cast<double>(plan.points()) / plan.area();
  json["time_s"] = plan.time;
  json["largest_sag_um"] = 1e3 * plan.largest_sag;
  json["moves_beyond_range"] = plan.beyond_range;
  json["blocked_links"] = plan.blocked_links;
  json["faces"] = nlohmann::ordered_json::array();
  for (const PlannedFace& face : plan.faces) {
    nlohmann::ordered_json entry = {{"path", scan_path_name(face.kind)}, {"why", face.why}};
    if (face.kind == ScanPathKind::rotary) {
      entry["turning_axis"] = machine.axes[face.turning_axis].name;
      entry["axis_tilt_deg"] = face.axis_tilt / kDegree;
    }
    entry["area_mm2"] = face.area;
    entry["covered_mm2"] = face.covered;
    if (face.area > 0) entry["covered_percent"] = 100 * face.covered / face.area;
    entry["lines"] = face.lines;
    entry["points"] = face.points;
    entry["points_per_mm2"] = face.points_per_mm2();
    entry["largest_angle_deg"] = face.largest_angle / kDegree;
    entry["tilted"] = face.tilted;
    entry["missed"] = nlohmann::ordered_json::object();
    entry["uncovered_mm2"] = nlohmann::ordered_json::object();
    for (std::size_t i = 1; i < kScanObstacleCount; ++i) {
      const char* name = scan_obstacle_name(static_cast<ScanObstacle>(i));
      if (face.missed[i] > 0) entry["missed"][name] = face.missed[i];
      if (face.uncovered[i] > 0) entry["uncovered_mm2"][name] = face.uncovered[i];
    }
    json["faces"].push_back(entry);
  }
  return json;
}

}  // namespace abbe
