#include "abbe/report/pages/scan_plan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/report/drawings/coverage_picture.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/report.h"
#include "abbe/report/words/scan_plan_words.h"

namespace abbe {
namespace {

/// Of more places every n-th is looked at for the colours; figures come from all.
constexpr std::size_t kPlacesForColours = 300'000;
constexpr std::size_t kFacesInTable = 200;

/// What became of the surface: all that happens, with its share of the area.
struct CoverageShares {
  std::vector<ScanObstacle> obstacles;  ///< none (covered) first
  std::vector<double> percent;
};

CoverageShares coverage_shares(const ScanPlan& plan) {
  CoverageShares shares{{ScanObstacle::none}, {100 * plan.covered_share()}};
  for (std::size_t k = 1; k < kScanObstacleCount; ++k) {
    const auto obstacle = static_cast<ScanObstacle>(k);
    const double area = plan.uncovered(obstacle);
    if (!(area > 0)) continue;
    shares.obstacles.push_back(obstacle);
    shares.percent.push_back(100 * area / plan.area());
  }
  return shares;
}

std::string colour_text(ScanObstacle obstacle) {
  const auto [red, green, blue] = scan_obstacle_colour(obstacle);
  return fmt::format("#{:02x}{:02x}{:02x}", red, green, blue);
}

SurfacePicture coloured_part(const TriangleMesh& part, const ScanPlan& plan, const ScanPlanOptions& options,
                             const CoverageShares& shares, int threads) {
  const RigidTransform& placed = options.workpiece_from_part;
  TriangleMesh mesh = part;
  mesh.vertices = ((placed.rotation * part.vertices).colwise() + placed.translation).eval();
  PlacesOfASurface places;
  for (const ScanObstacle obstacle : shares.obstacles) {
    places.reasons.emplace_back(obstacle == ScanObstacle::none ? "covered" : obstacle_words(obstacle));
  }
  const std::size_t every = 1 + plan.coverage.size() / kPlacesForColours;
  places.points.resize(3, static_cast<Eigen::Index>((plan.coverage.size() + every - 1) / every));
  for (std::size_t i = 0, next = 0; i < plan.coverage.size(); i += every, ++next) {
    const CoverageSample& sample = plan.coverage[i];
    const auto found = std::find(shares.obstacles.begin(), shares.obstacles.end(), sample.obstacle);
    places.points.col(static_cast<Eigen::Index>(next)) = placed * sample.point;
    places.reason.push_back(static_cast<std::uint8_t>(found - shares.obstacles.begin()));
  }
  SurfacePicture picture = coverage_picture(mesh, places, threads);
  picture.frame = "workpiece";
  picture.percent = shares.percent;
  for (const ScanObstacle obstacle : shares.obstacles) picture.colours.push_back(colour_text(obstacle));
  picture.colours.emplace_back("#c4c8cc");
  if (!options.wanted.empty()) picture.reasons.back() = "not asked for";
  return picture;
}

nlohmann::json figure_json(const char* symbol, const std::string& name, const char* key, double value, int decimals) {
  return {{"symbol", symbol}, {"name", name}, {key, value}, {"decimals", decimals}};
}

nlohmann::json figures_json(const ScanPlan& plan, const CoverageShares& shares) {
  nlohmann::json figures = nlohmann::json::array();
  figures.push_back(figure_json("covered", "share of the surface", "value_percent", shares.percent[0], 1));
  for (std::size_t i = 1; i < shares.obstacles.size(); ++i) {
    figures.push_back(figure_json(scan_obstacle_name(shares.obstacles[i]),
                                  std::string("not covered: ") + obstacle_words(shares.obstacles[i]), "value_percent",
                                  shares.percent[i], 2));
  }
  const auto count = [](std::size_t number) { return static_cast<double>(number); };
  figures.push_back(figure_json("points", "measured", "value", count(plan.points()), 0));
  figures.push_back(
      figure_json("missed", "places on the lines that are not reached", "value", count(plan.missed_places()), 0));
  figures.push_back(figure_json("time", "of the whole path, without acceleration", "value_s", plan.time, 0));
  figures.push_back(figure_json("sag", "surface from the middle of the range, half way between points, at most",
                                "value_um", 1e3 * plan.largest_sag, 1));
  figures.push_back(figure_json("around", "moves that go around because the surface would leave the range", "value",
                                count(plan.beyond_range), 0));
  figures.push_back(figure_json("blocked", "ways between lines on which the probe may touch part or stage", "value",
                                count(plan.blocked_links), 0));
  return figures;
}

EvaluationTable faces_table(const ScanPlan& plan) {
  EvaluationTable table;
  table.caption = "Faces";
  table.headers = {"face",   "path",   "area in mm\xC2\xB2", "covered in %",
                   "lines",  "points", "per mm\xC2\xB2",     "tilted",
                   "missed", "because"};
  for (std::size_t i = 0; i < plan.faces.size() && table.rows.size() < kFacesInTable; ++i) {
    const PlannedFace& face = plan.faces[i];
    if (!(face.area > 0)) continue;
    table.rows.push_back({fmt::format("{}", i + 1), scan_path_name(face.kind), fmt::format("{:.3f}", face.area),
                          fmt::format("{:.1f}", 100 * face.covered / face.area), fmt::format("{}", face.lines),
                          fmt::format("{}", face.points), fmt::format("{:.2f}", face.points_per_mm2()),
                          fmt::format("{}", face.tilted), fmt::format("{}", face.missed_places()), face.why});
  }
  return table;
}

}  // namespace

PathPicture path_picture(const Machine& machine, const ScanPlan& plan, const ScanPlanOptions& options) {
  PathPicture picture;
  picture.title = "Planned path";
  picture.tool = "probe";
  picture.tool_radius = options.probe_radius;
  picture.tool_length = options.probe_length;
  picture.working_distance = options.working_distance;
  picture.note = "Time: the slowest axis of each move and the rate of the probe, without acceleration.";
  double time = 0;
  for (std::size_t n = 0; n < plan.moves.size(); ++n) {
    const std::vector<double> positions = plan.positions.pose(n);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, positions);
    DrawnMove move;
    std::copy(positions.begin(), positions.end(), move.command.begin());
    move.point = pose.translation;
    move.direction = pose.rotation * machine.tool_direction;
    // The way to a line does not measure, even if its end does.
    move.working = n > 0 && plan.moves[n].measures && plan.moves[n - 1].measures && !plan.moves[n].blocked;
    move.time = time += plan.moves[n].time;
    picture.moves.push_back(move);
  }
  return picture;
}

nlohmann::json scan_plan_page_data(const Machine& machine, const TriangleMesh& part, const ScanPlan& plan,
                                   const ScanPlanOptions& options, const std::string& name, int threads) {
  const CoverageShares shares = coverage_shares(plan);
  EvaluationReport report;
  report.kind = "scan plan";
  report.title = "Planned scan of " + name;
  report.standard = machine.name;
  report.facts = {
      {"part", fmt::format("{}, {} triangles, {} face{}", name, part.size(), plan.faces.size(),
                           plan.faces.size() == 1 ? "" : "s")},
      {"surface",
       fmt::format("{:.1f} mm\xC2\xB2{}", plan.area(), options.wanted.empty() ? "" : " of what is asked for")},
      {"covered", fmt::format("{:.1f} %", shares.percent[0])},
      {"points", fmt::format("{}, {} places not reached", plan.points(), plan.missed_places())},
      {"distances", fmt::format("{:g} mm along a line, {:g} mm between lines", options.along, options.between)},
      {"time", fmt::format("{:.0f} s", plan.time)}};
  if (plan.blocked_links > 0) {
    report.facts.emplace_back(
        "not clear", fmt::format("{} ways between lines: the probe may touch part or stage", plan.blocked_links));
  }
  report.tables.push_back(faces_table(plan));
  report.notes.emplace_back(
      "A piece of the surface counts as covered if a measured point of its own face lies within three quarters of the "
      "diagonal of the two distances; shares are by area, and the colour of a triangle is that of most of its pieces.");
  if (plan.faces.size() > kFacesInTable) {
    report.notes.push_back(fmt::format("The table shows {} of {} faces.", kFacesInTable, plan.faces.size()));
  }
  report.page = nlohmann::json::object();
  if (!plan.moves.empty()) report.page["path"] = path_data(machine, path_picture(machine, plan, options));
  report.page["machine"] = report_machine(machine);
  report.page["surface"] = surface_data(coloured_part(part, plan, options, shares, threads), nullptr);
  nlohmann::json data = evaluation_data(report);
  data["evaluation"]["figures"] = figures_json(plan, shares);
  return data;
}

std::string scan_plan_page(const Machine& machine, const TriangleMesh& part, const ScanPlan& plan,
                           const ScanPlanOptions& options, const std::string& name, int threads) {
  return report_page(scan_plan_page_data(machine, part, plan, options, name, threads));
}

}  // namespace abbe
