#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/planning/planned_scan.h"
#include "command.h"
#include "exit_code.h"
#include "machine_options.h"
#include "options.h"
#include "progress.h"
#include "scan/scan.h"
#include "step_reading.h"

namespace abbe {
namespace {

struct PlanOptions {
  std::string part, machine, stage, output, program, coverage, report;
  std::vector<double> position = {0, 0, 0}, turn = {0, 0, 0};
  std::vector<std::vector<double>> beyond;
  std::vector<std::string> words;
  double crease_deg = 30, angle_deg = 28, range_um = 400, rotary_speed_deg = 30, turn_between_deg = 10;
  ScanPlanOptions scan;
  StepReading step;
  bool json = false;
};

/// Reads a part or a stage, which must be complete.
MeshFile read_whole(const std::string& file, const StepReading& step) {
  return step.read_whole(file, "all faces of the part and the stage, because the probe must keep clear of them");
}

ScanPlanOptions scan_options(const PlanOptions& options) {
  ScanPlanOptions scan = options.scan;
  if (!options.stage.empty()) scan.stage = read_whole(options.stage, options.step).mesh;
  scan.workpiece_from_part = part_placement({options.position[0], options.position[1], options.position[2]},
                                            {options.turn[0], options.turn[1], options.turn[2]});
  for (const std::vector<double>& plane : options.beyond) {
    scan.wanted.push_back(beyond_plane({plane[0], plane[1], plane[2], plane[3]}));
  }
  scan.crease_angle = options.crease_deg * kDegree;
  scan.largest_angle = options.angle_deg * kDegree;
  scan.largest_turn = options.turn_between_deg * kDegree;
  scan.range = 1e-3 * options.range_um;
  scan.rotary_speed = options.rotary_speed_deg * kDegree;
  return scan;
}

/// "--range-um" -> "um"
std::string unit_in(const std::string& option) {
  for (const char* rate : {"mm-per-s", "deg-per-s", "per-second"}) {
    if (option.ends_with(rate)) return rate;
  }
  return option.substr(option.rfind('-') + 1);
}

/// A number from low to high; the error states the unit.
Check within(double low, double high, const std::string& unit) {
  return {[=](const std::string& text) {
            double value = 0;
            if (parse_number(text, 0, value) == NumberProblem::none && value >= low && value <= high)
              return std::string{};
            return fmt::format("{} is not a number from {} to {} {}", text, low, high, unit);
          },
          fmt::format("{} to {} {}", low, high, unit)};
}

int run_plan(const PlanOptions& options) {
  options.step.require_step_among({options.part, options.stage});
  ScanRequest request;
  request.machine = read_machine(options.machine);
  PathProgramOptions program;
  program.words = axis_words(request.machine, options.words, "--word");
  request.part_file = options.part;
  request.part = read_whole(options.part, options.step).mesh;
  request.scan = scan_options(options);
  Progress progress("planning the scan");
  const PlannedScan planned = plan_part_scan(request, {.progress = progress.callback()});
  if (!options.output.empty()) write_file_atomically(options.output, planned_scan_csv(planned));
  if (!options.program.empty()) write_file_atomically(options.program, planned_scan_program(planned, program));
  if (!options.coverage.empty()) write_file_atomically(options.coverage, scan_coverage_ply(planned.plan));
  if (!options.report.empty()) write_file_atomically(options.report, planned_scan_page(planned));
  fmt::print("{}", options.json ? json_text(planned_scan_json(planned)) : planned_scan_text(planned));
  return planned.is_complete() ? kDone : kNegative;
}

}  // namespace

void add_scan_plan(Subcommand& scan, CommandLine& line) {
  auto options = std::make_shared<PlanOptions>();
  Subcommand* command = scan.add_subcommand("plan", "Plan paths of a displacement probe over all faces of a part");
  command->footer(
      "Faces end where triangles meet at an edge. A flat face is scanned as a raster with one direction of the beam.\n"
      "A face of revolution is scanned on circles, if a rotary axis can be brought to its axis. All others are\n"
      "scanned along their normals. Exit code 1: not everything is reached.\n\n"
      "Examples:\n"
      "  abbe scan plan examples/cradle_scanner/pyramid.stl --machine examples/machines/liu-scanner.machine.toml -o "
      "path.csv "
      "--program path.ngc --coverage coverage.ply --report plan.html\n"
      "  abbe scan plan examples/cradle_scanner/pyramid.stl --machine examples/machines/liu-scanner.machine.toml "
      "--beyond-plane-mm 0 1 0 -0.8");
  command
      ->add_input_file("part", options->part,
                       "Closed mesh (.stl .ply .obj) or CAD file (.step .stp), mm, frame of the part")
      ->required();
  add_machine(*command, options->machine)->required();
  command->add_output_file("-o,--output", options->output, "Path as CSV");
  command->add_output_file("--program", options->program, "Path as NC program (G1, inverse time feed)");
  command->add_option("--word", options->words, "Word of an axis in the program, such as C1=C");
  command->add_output_file("--coverage", options->coverage, "Coverage as coloured points (.ply)");
  command->add_output_file(
      "--report", options->report,
      "Page to write (.html): an animation of the path over the part, coverage in colour, figures");
  command
      ->add_option("--beyond-plane-mm", options->beyond,
                   "Scan only what is beyond a plane: NX x + NY y + NZ z >= D, frame of the part; repeatable")
      ->expected(4)
      ->type_name("NX NY NZ D");
  command->add_option("--position-mm", options->position, "Position of the part in the workpiece frame")->expected(3);
  command->add_option("--turn-deg", options->turn, "Rotation of the part: about x, then y, then z")->expected(3);
  command->add_input_file("--stage", options->stage, "Mesh of the stage that turns with the part, workpiece frame");
  options->step.add_to(command);
  const auto ranged = [&](const std::string& name, double& value, double low, double high, const char* words) {
    command->add_option(name, value, words)->check(within(low, high, unit_in(name)))->capture_default_str();
  };
  const auto positive = [&](const char* name, double& value, const char* words) {
    ranged(name, value, 1e-9, 1e6, words);
  };
  positive("--along-mm", options->scan.along, "Distance of points along a line");
  positive("--between-mm", options->scan.between, "Distance of lines");
  ranged("--turn-between-deg", options->turn_between_deg, 0.1, 20,
         "Largest turn of the normal from point to point: points are closer where it turns faster");
  ranged("--crease-deg", options->crease_deg, 1, 90, "Faces end where triangles meet at a larger angle than this");
  ranged("--largest-angle-deg", options->angle_deg, 2, 85, "Largest angle between beam and normal");
  positive("--range-um", options->range_um, "Range of the probe about its middle, the functional point");
  positive("--working-distance-mm", options->scan.working_distance, "Distance from the measured point to the probe");
  positive("--probe-radius-mm", options->scan.probe_radius, "Radius of the probe beyond that distance");
  positive("--probe-length-mm", options->scan.probe_length, "Length of the probe");
  positive("--clearance-mm", options->scan.clearance, "Distance kept to part and stage");
  positive("--linear-speed-mm-per-s", options->scan.linear_speed, "Speed of linear axes");
  positive("--rotary-speed-deg-per-s", options->rotary_speed_deg, "Speed of rotary axes");
  positive("--readings-per-second", options->scan.readings_per_second, "Rate of the probe");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_plan(*options); }; });
}

}  // namespace abbe
