#include <fmt/format.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/mesh_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/formats/scan_plan_file.h"
#include "abbe/geometry/mesh_check.h"
#include "abbe/geometry/rotation.h"
#include "abbe/geometry/vertex_welder.h"
#include "scan/scan.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct PlanOptions {
  std::string part, machine, stage, output, program, coverage;
  std::vector<double> position = {0, 0, 0}, turn = {0, 0, 0};
  double crease_deg = 30, angle_deg = 28, range_um = 400, rotary_speed_deg = 30;
  ScanPlanOptions scan;
  bool json = false;
};

/// Vertices at the same place become one, as the planner needs it.
TriangleMesh welded(const TriangleMesh& mesh) {
  VertexWelder welder(static_cast<std::size_t>(mesh.vertices.cols()));
  std::vector<std::uint32_t> index(static_cast<std::size_t>(mesh.vertices.cols()));
  welder.add({mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.size())}, index.data());
  TriangleMesh result;
  result.vertices = welder.vertices();
  result.triangles = mesh.triangles.unaryExpr([&](std::uint32_t vertex) { return index[vertex]; });
  return result;
}

TriangleMesh read_part(const std::string& file) {
  TriangleMesh mesh = welded(read_mesh(file).mesh);
  const MeshCheck check = check_mesh(mesh);
  if (!check.encloses_volume()) {
    throw InputError({file, 0, 0, ""},
                     fmt::format("the surface is not closed or not oriented: {} edges of one triangle, {} of more than "
                                 "two, {} turned over",
                                 check.border_edges, check.branching_edges, check.turned_edges),
                     "a closed mesh; abbe check says more");
  }
  if (!(check.volume > 0))
    throw InputError({file, 0, 0, ""}, "the triangles look inwards", "normals out of the material");
  return mesh;
}

int run_plan(PlanOptions options) {
  const Machine machine = read_machine(options.machine);
  const TriangleMesh part = read_part(options.part);
  ScanPlanOptions& scan = options.scan;
  if (!options.stage.empty()) scan.stage = read_mesh(options.stage).mesh;
  scan.workpiece_from_part = {
      rotation_from_error_angles(Eigen::Vector3d(options.turn[0], options.turn[1], options.turn[2]) * kDegree),
      {options.position[0], options.position[1], options.position[2]}};
  scan.crease_angle = options.crease_deg * kDegree;
  scan.largest_angle = options.angle_deg * kDegree;
  scan.range = 1e-3 * options.range_um;
  scan.rotary_speed = options.rotary_speed_deg * kDegree;
  const double most = check_mesh(part).area / (scan.along * scan.between);
  if (most > 5e6) {
    throw InputError({.field = "--along-mm"}, fmt::format("{:.0f} points", most),
                     "at most 5,000,000: larger distances");
  }
  Progress progress("planning the scan");
  scan.progress = progress.callback();
  const ScanPlan plan = plan_scan(machine, part, scan);

  const std::string name = std::filesystem::path(options.part).filename().string();
  if (!options.output.empty()) write_file_atomically(options.output, scan_plan_csv(machine, plan));
  if (!options.program.empty()) {
    write_file_atomically(options.program, scan_plan_program(machine, plan, "scan of " + name + " on " + machine.name));
  }
  if (!options.coverage.empty()) write_file_atomically(options.coverage, scan_coverage_ply(plan));

  std::size_t points = 0, missed = 0;
  for (const PlannedFace& face : plan.faces) {
    points += face.points;
    missed += face.hidden + face.collision + face.travel;
  }
  if (options.json) {
    nlohmann::ordered_json json = {{"part", name},
                                   {"machine", machine.name},
                                   {"points", points},
                                   {"missed", missed},
                                   {"covered_percent", 100 * plan.covered_share()},
                                   {"time_s", plan.time},
                                   {"largest_sag_um", 1e3 * plan.largest_sag},
                                   {"moves_beyond_range", plan.beyond_range},
                                   {"blocked_links", plan.blocked_links}};
    json["faces"] = nlohmann::ordered_json::array();
    for (const PlannedFace& face : plan.faces) {
      json["faces"].push_back({{"path", scan_path_name(face.kind)},
                               {"area_mm2", face.area},
                               {"covered_mm2", face.covered},
                               {"lines", face.lines},
                               {"points", face.points},
                               {"tilted", face.tilted},
                               {"hidden", face.hidden},
                               {"collision", face.collision},
                               {"travel", face.travel}});
    }
    fmt::print("{}\n", json_text(json));
  } else {
    fmt::print("{} on {}: {} faces\n", name, machine.name, plan.faces.size());
    fmt::print("  {:>4} {:<7}{:>12}{:>10}{:>7}{:>9}{:>8}{:>8}{:>11}{:>8}\n", "face", "path", "area mm2", "covered",
               "lines", "points", "tilted", "hidden", "collision", "travel");
    for (std::size_t i = 0; i < plan.faces.size() && i < 60; ++i) {
      const PlannedFace& f = plan.faces[i];
      fmt::print("  {:>4} {:<7}{:>12.3f}{:>8.1f} %{:>7}{:>9}{:>8}{:>8}{:>11}{:>8}\n", i + 1, scan_path_name(f.kind),
                 f.area, f.area > 0 ? 100 * f.covered / f.area : 0, f.lines, f.points, f.tilted, f.hidden, f.collision,
                 f.travel);
    }
    if (plan.faces.size() > 60) fmt::print("  ... {} more; --json has all\n", plan.faces.size() - 60);
    fmt::print("{} points, {} places not reached, {:.1f} % of the surface covered\n", points, missed,
               100 * plan.covered_share());
    fmt::print("time {:.0f} s; surface at most {:.1f} um from the middle of the range half way between points\n",
               plan.time, 1e3 * plan.largest_sag);
    if (plan.beyond_range > 0) {
      fmt::print("{} moves leave the range of the probe half way: smaller --along-mm\n", plan.beyond_range);
    }
    if (plan.blocked_links > 0) fmt::print("{} ways between lines are blocked\n", plan.blocked_links);
  }
  if (missed > 0 || plan.beyond_range > 0 || plan.blocked_links > 0) return kNegative;
  return kDone;
}

}  // namespace

void add_scan_plan(CLI::App& scan, CommandLine& line) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = scan.add_subcommand("plan", "Paths of a displacement probe over all faces of a part");
  command->footer(
      "Faces end where triangles meet at an edge. Flat ones are scanned as a raster with one direction of the beam, "
      "those\n"
      "of revolution about the workpiece's own rotary axis on circles, all others along their normals. Exit code 1: "
      "not\n"
      "everything is reached.\n\n"
      "Example:\n"
      "  abbe scan plan examples/cradle_scanner/pyramid.stl --machine examples/machines/liu-scanner.machine.toml -o "
      "path.csv "
      "--program path.ngc --coverage coverage.ply");
  command->add_option("part", options->part, "Closed mesh (.stl .ply .obj), mm, frame of the part")->required();
  command->add_option("--machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("-o,--output", options->output, "Path as CSV");
  command->add_option("--program", options->program, "Path as NC program (G1, inverse time feed)");
  command->add_option("--coverage", options->coverage, "Coverage as coloured points (.ply)");
  command->add_option("--position-mm", options->position, "Where the part stands in the workpiece frame")->expected(3);
  command->add_option("--turn-deg", options->turn, "How it is turned: about x, then y, then z")->expected(3);
  command->add_option("--stage", options->stage, "Mesh of what turns with the part, workpiece frame");
  const auto positive = [&](const char* name, double& value, const char* words) {
    command->add_option(name, value, words)->check(CLI::Range(1e-9, 1e6))->capture_default_str();
  };
  positive("--along-mm", options->scan.along, "Distance of points along a line");
  positive("--between-mm", options->scan.between, "Distance of lines");
  command->add_option("--crease-deg", options->crease_deg, "Faces end where triangles meet at more")
      ->check(CLI::Range(1.0, 90.0))
      ->capture_default_str();
  command->add_option("--largest-angle-deg", options->angle_deg, "Largest angle between beam and normal")
      ->check(CLI::Range(2.0, 85.0))
      ->capture_default_str();
  positive("--range-um", options->range_um, "Range of the probe about its middle, the functional point");
  positive("--working-distance-mm", options->scan.working_distance, "From the measured point to the probe");
  positive("--probe-radius-mm", options->scan.probe_radius, "Radius of the probe behind it");
  positive("--probe-length-mm", options->scan.probe_length, "Length of the probe");
  positive("--clearance-mm", options->scan.clearance, "Distance kept to part and stage");
  positive("--linear-speed-mm-per-s", options->scan.linear_speed, "Speed of linear axes");
  positive("--rotary-speed-deg-per-s", options->rotary_speed_deg, "Speed of rotary axes");
  positive("--readings-per-second", options->scan.readings_per_second, "Rate of the probe");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_plan(*options); }; });
}

}  // namespace abbe
