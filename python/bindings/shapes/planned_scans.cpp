#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/planning/planned_scan.h"
#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// What the probe and the axes can do, in the units of the arguments.
struct ScanArguments {
  double along_mm, between_mm, turn_between_deg, crease_deg, largest_angle_deg, range_um, working_distance_mm;
  double probe_radius_mm, probe_length_mm, clearance_mm, linear_speed_mm_per_s, rotary_speed_deg_per_s;
  double readings_per_second;
};

ScanPlanOptions options_of(const ScanArguments& given) {
  const auto positive = [](const char* name, double value) { return number_within(name, value, 1e-9, 1e6); };
  ScanPlanOptions scan;
  scan.along = positive("along_mm", given.along_mm);
  scan.between = positive("between_mm", given.between_mm);
  scan.largest_turn = number_within("turn_between_deg", given.turn_between_deg, 0.1, 20) * kDegree;
  scan.crease_angle = number_within("crease_deg", given.crease_deg, 1, 90) * kDegree;
  scan.largest_angle = number_within("largest_angle_deg", given.largest_angle_deg, 2, 85) * kDegree;
  scan.range = 1e-3 * positive("range_um", given.range_um);
  scan.working_distance = positive("working_distance_mm", given.working_distance_mm);
  scan.probe_radius = positive("probe_radius_mm", given.probe_radius_mm);
  scan.probe_length = positive("probe_length_mm", given.probe_length_mm);
  scan.clearance = positive("clearance_mm", given.clearance_mm);
  scan.linear_speed = positive("linear_speed_mm_per_s", given.linear_speed_mm_per_s);
  scan.rotary_speed = positive("rotary_speed_deg_per_s", given.rotary_speed_deg_per_s) * kDegree;
  scan.readings_per_second = positive("readings_per_second", given.readings_per_second);
  return scan;
}

/// The mesh of all faces. @throws InputError if faces are left out
TriangleMesh whole(const NamedMesh& mesh) {
  return whole_mesh(mesh, "all faces of the part and the stage, because the probe must keep clear of them");
}

Eigen::Vector3d triple(const Triple& numbers, const char* name) {
  for (const double number : numbers) {
    if (!(std::abs(number) <= kLargestInput))
      throw InputError({.field = name}, fmt::format("has {}", number), "at most 1e9");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

PlannedScan planned(const MeshArgument& part, const Machine& machine, const Triple& position_mm, const Triple& turn_deg,
                    const std::vector<std::array<double, 4>>& beyond_planes_mm,
                    const std::optional<MeshArgument>& stage, double along_mm, double between_mm,
                    double turn_between_deg, double crease_deg, double largest_angle_deg, double range_um,
                    double working_distance_mm, double probe_radius_mm, double probe_length_mm, double clearance_mm,
                    double linear_speed_mm_per_s, double rotary_speed_deg_per_s, double readings_per_second,
                    const nb::object& progress) {
  ScanRequest request;
  request.scan = options_of({along_mm, between_mm, turn_between_deg, crease_deg, largest_angle_deg, range_um,
                             working_distance_mm, probe_radius_mm, probe_length_mm, clearance_mm, linear_speed_mm_per_s,
                             rotary_speed_deg_per_s, readings_per_second});
  request.scan.workpiece_from_part = part_placement(triple(position_mm, "position_mm"), triple(turn_deg, "turn_deg"));
  naming_arguments([&] {
    for (const std::array<double, 4>& plane : beyond_planes_mm) request.scan.wanted.push_back(beyond_plane(plane));
  });
  if (stage) request.scan.stage = whole(mesh_of(*stage, std::nullopt));
  const NamedMesh mesh = mesh_of(part, std::nullopt);
  request.machine = machine;
  request.part = whole(mesh);
  request.part_file = mesh.name();
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return plan_part_scan(request, control.options("planning the scan")); });
  });
}

std::string program(const PlannedScan& scan, const std::vector<std::string>& words) {
  PathProgramOptions options;
  options.words = naming_arguments([&] { return axis_words(scan.machine, words, "--words"); });
  return planned_scan_program(scan, options);
}

void bind_moves(nb::class_<PlannedScan>& bound) {
  bound
      .def_prop_ro(
          "positions_mm_rad", [](const PlannedScan& s) { return copied_poses(s.plan.positions); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] commands of all moves.")
      .def_prop_ro(
          "points_mm", [](const PlannedScan& s) { return vectors_of_each(s.plan.moves, &PlannedMove::point); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3] workpiece frame.")
      .def_prop_ro(
          "normals", [](const PlannedScan& s) { return vectors_of_each(s.plan.moves, &PlannedMove::normal); },
          nb::sig("def normals(self) -> numpy.ndarray"), "[n, 3] of the surface.")
      .def_prop_ro(
          "beams", [](const PlannedScan& s) { return vectors_of_each(s.plan.moves, &PlannedMove::beam); },
          nb::sig("def beams(self) -> numpy.ndarray"), "[n, 3] from the part to the probe.")
      .def_prop_ro(
          "measures", [](const PlannedScan& s) { return flags_of_each(s.plan.moves, &PlannedMove::measures); },
          nb::sig("def measures(self) -> numpy.ndarray"),
          "[n] False where the probe moves around the part, away from it.")
      .def_prop_ro(
          "blocked", [](const PlannedScan& s) { return flags_of_each(s.plan.moves, &PlannedMove::blocked); },
          nb::sig("def blocked(self) -> numpy.ndarray"), "[n] no clear path was found: the probe may touch.")
      .def_prop_ro(
          "face", [](const PlannedScan& s) { return ints_of_each(s.plan.moves, &PlannedMove::face); },
          nb::sig("def face(self) -> numpy.ndarray"), "[n] index into faces.")
      .def_prop_ro(
          "line", [](const PlannedScan& s) { return ints_of_each(s.plan.moves, &PlannedMove::line); },
          nb::sig("def line(self) -> numpy.ndarray"), "[n] index of the scan line on its face.");
}

void bind_faces(nb::module_& module) {
  nb::class_<PlannedFace>(module, "PlannedFace", "A face of a part in a planned scan.")
      .def_prop_ro(
          "kind", [](const PlannedFace& f) { return scan_path_name(f.kind); }, "'rotary', 'raster' or 'free'.")
      .def_ro("why", &PlannedFace::why, "Why it is scanned this way.")
      .def_ro("area_mm2", &PlannedFace::area, "Area to be scanned.")
      .def_ro("covered_mm2", &PlannedFace::covered, "Area that is scanned.")
      .def_ro("lines", &PlannedFace::lines)
      .def_ro("points", &PlannedFace::points)
      .def_ro("largest_angle_rad", &PlannedFace::largest_angle, "Between beam and normal.")
      .def_prop_ro("missed_places", &PlannedFace::missed_places, "Places on its lines that are not measured.")
      .def("__repr__", [](const PlannedFace& f) {
        return fmt::format("<abbe.PlannedFace {}: {} points>", scan_path_name(f.kind), f.points);
      });
}

}  // namespace

void bind_planned_scans(nb::module_& module) {
  bind_faces(module);
  nb::class_<PlannedScan> bound(module, "PlannedScan", "Paths of a probe over a part. Made by plan_scan().");
  bind_moves(bound);
  add_json(bound, &planned_scan_json);
  bound.def_ro("machine", &PlannedScan::machine)
      .def_prop_ro("faces", [](const PlannedScan& s) { return s.plan.faces; })
      .def_prop_ro(
          "points", [](const PlannedScan& s) { return s.plan.points(); }, "Number of points measured.")
      .def_prop_ro("time_s", [](const PlannedScan& s) { return s.plan.time; })
      .def_prop_ro(
          "covered_share", [](const PlannedScan& s) { return s.plan.covered_share(); }, "Share of the wanted area.")
      .def_prop_ro("complete", &PlannedScan::is_complete, "Whether all of the wanted area is reached, on a clear path.")
      .def("text", &planned_scan_text, "What `abbe scan plan` prints.")
      .def("csv", &planned_scan_csv, "The path as CSV.")
      .def("program", &program, nb::arg("words") = std::vector<std::string>{},
           "The path as an NC program (G1, inverse time feed). words: of axes, such as ['C1=C'].")
      .def(
          "coverage_ply",
          [](const PlannedScan& s) {
            const std::string bytes = scan_coverage_ply(s.plan);
            return nb::bytes(bytes.data(), bytes.size());
          },
          "The coverage as coloured points, PLY.")
      .def("page_html", &planned_scan_page, "The page that plays the path over the part, HTML.")
      .def(
          "write",
          [](const PlannedScan& s, const std::filesystem::path& path, bool overwrite) {
            const std::string ending = path.extension().string();
            if (ending == ".csv") return write_text(path, planned_scan_csv(s), overwrite);
            if (ending == ".ngc") return write_text(path, program(s, {}), overwrite);
            if (ending == ".ply") return write_text(path, scan_coverage_ply(s.plan), overwrite);
            if (ending == ".html") return write_text(path, planned_scan_page(s), overwrite);
            throw InputError({.file = path.string()}, "has another ending",
                             ".csv (path), .ngc (program), .ply (coverage) or .html (page)");
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes the path (.csv, .ngc), the coverage (.ply) or the page (.html), whole or not at all.")
      .def("__len__", [](const PlannedScan& s) { return s.plan.moves.size(); })
      .def("__repr__", [](const PlannedScan& s) {
        return fmt::format("<abbe.PlannedScan: {} points on {} faces>", s.plan.points(), s.plan.faces.size());
      });
  module.def(
      "plan_scan", &planned, nb::arg("part"), nb::arg("machine"), nb::kw_only(), nb::arg("position_mm") = Triple{},
      nb::arg("turn_deg") = Triple{}, nb::arg("beyond_planes_mm") = std::vector<std::array<double, 4>>{},
      nb::arg("stage") = nb::none(), nb::arg("along_mm") = 0.5, nb::arg("between_mm") = 0.5,
      nb::arg("turn_between_deg") = 10.0, nb::arg("crease_deg") = 30.0, nb::arg("largest_angle_deg") = 28.0,
      nb::arg("range_um") = 400.0, nb::arg("working_distance_mm") = 10.0, nb::arg("probe_radius_mm") = 5.0,
      nb::arg("probe_length_mm") = 60.0, nb::arg("clearance_mm") = 0.5, nb::arg("linear_speed_mm_per_s") = 10.0,
      nb::arg("rotary_speed_deg_per_s") = 30.0, nb::arg("readings_per_second") = 100.0,
      nb::arg("progress") = nb::none(),
      "Paths of a displacement probe over all faces of a part: `abbe scan plan`.\n\n"
      "part: a closed Mesh, or a file, frame of the part. position_mm, turn_deg (about x, then y, then z): "
      "where it stands\n"
      "in the workpiece frame. beyond_planes_mm: [(nx, ny, nz, d)], only nx x + ny y + nz z >= d is scanned. "
      "stage: a Mesh\n"
      "or a file of what turns with the part, workpiece frame. along_mm, between_mm: distances of points and of "
      "lines.\n"
      "turn_between_deg: largest turn of the normal from point to point. crease_deg: faces end where triangles\n"
      "meet at a larger angle. largest_angle_deg: between beam and normal. range_um of the probe about its middle;\n"
      "working_distance_mm from the point to the probe, a rod of probe_radius_mm and probe_length_mm that keeps\n"
      "clearance_mm. progress: a function of the step, what is done and its total. Raises InputError, Stopped.\n"
      "Method: docs/scan.md.");
}

}  // namespace abbe::python
