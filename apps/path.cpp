#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/compensation/planned_path.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "step_reading.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct PathCommand {
  std::string machine, curve, errors, placement, part, report;
  std::vector<std::string> hold, start, words, outputs, states;
  double feed_mm_per_min = 0, retract_mm = 0, tolerance_um = 0;
  int decimals = 6;
  bool feed_per_minute = false, json = false, accept_misfit = false;
  StepReading step;
};

PathProgramOptions program_options(const PathCommand& command, const Machine& machine) {
  PathProgramOptions options;
  options.decimals = command.decimals;
  options.inverse_time = !command.feed_per_minute;
  options.words = axis_words(machine, command.words, "--word");
  return options;
}

PathRequest request_of(const PathCommand& command) {
  PathRequest request;
  request.machine = read_machine(command.machine);
  request.errors_file = command.errors;
  if (!command.errors.empty()) {
    request.errors = read_errors_for_use(command.errors, request.machine, command.accept_misfit, command.states);
  }
  request.placement_file = command.placement;
  if (!command.placement.empty()) {
    request.placement = read_placement(command.placement);
    for (const std::string& warning : request.placement->warnings) {
      tell("abbe: warning: {}: {}\n", command.placement, warning);
    }
  }
  request.curve_file = command.curve;
  request.curve = read_curve(command.curve, request.machine);
  request.feed = command.feed_mm_per_min / 60;
  request.retract = command.retract_mm;
  request.tolerance = 1e-3 * command.tolerance_um;
  request.held = axis_options(request.machine, "--hold", command.hold);
  request.start = axis_options(request.machine, "--start", command.start);
  return request;
}

void write_page(const PathCommand& command, const PlannedPath& planned) {
  std::optional<MeshFile> part;
  if (!command.part.empty()) part = command.step.read(command.part);
  write_file_atomically(command.report, planned_path_page(planned, part ? &*part : nullptr, command.part));
}

int run_path(const PathCommand& command) {
  command.step.require_step_among({command.part});
  const PathRequest request = request_of(command);
  const PathProgramOptions program = program_options(command, request.machine);
  const PlannedPath planned = plan_path(request);
  if (planned.has_path()) {
    for (const std::string& output : command.outputs) {
      write_file_atomically(output, planned_path_file(planned, output, program));
    }
    if (!command.report.empty()) write_page(command, planned);
    if (command.json) {
      fmt::print("{}", json_text(planned_path_json(planned)));
    } else {
      fmt::print("{}", planned_path_text(planned));
      for (const std::string& output : command.outputs) fmt::print("{} written\n", output);
    }
  }
  if (!planned.refused.empty()) tell("abbe: {}\n", planned.refused);
  return tell_outside(planned.at_state, planned.refused.empty() ? kDone : kNegative);
}

}  // namespace

void add_path_command(CommandLine& line) {
  auto options = std::make_shared<PathCommand>();
  Subcommand* command = line.add(
      "path", "Turn a curve on the workpiece into axis commands and an NC program for the calibrated machine",
      "  abbe path examples/laser_engraver/table-a4.csv --machine examples/machines/yin-engraver-u.machine.toml "
      "--placement "
      "examples/laser_engraver/part.placement.toml -o program.ngc -o commands.csv --report path.html\n"
      "  abbe path examples/laser_engraver/regions.ngc --machine examples/machines/yin-engraver-u.machine.toml "
      "--errors "
      "examples/laser_engraver/linkage.errors.toml --retract-mm 20 --tolerance-um 1 --word C1=C --word C2=B\n\n"
      "The curve: CSV with x_mm, y_mm, z_mm, i, j, k (direction from the tool to the spindle or source), optional\n"
      "feed_mm_per_min, pierce_s, beam and axes set beforehand (C2_deg); or a program with G0, G1, X Y Z I J K, F, G4, "
      "M3.");
  command->add_input_file("curve", options->curve, "Curve (.csv, .ngc, .nc, .tap, .mpf) in workpiece coordinates")
      ->required();
  command->take_from_arguments({add_machine(*command, options->machine)->required()});
  add_errors(*command, options->errors, "Identified errors (*.errors.toml)");
  command->add_input_file("--placement", options->placement, "Where the workpiece is clamped (*.placement.toml)");
  command->add_option("--hold", options->hold, "Axis kept at a command, AXIS_unit=position; repeatable");
  command->add_option("--start", options->start,
                      "Position of an axis before the path, AXIS_unit=position; repeatable. The nearest branch is "
                      "taken; axes that are not named may be anywhere");
  command->add_option("--feed-mm-per-min", options->feed_mm_per_min, "Feed where the curve has none")
      ->check(positive_number());
  command
      ->add_option("--retract-mm", options->retract_mm,
                   "Retract along the tool before and after each region; needed if axes are repositioned in between")
      ->check(non_negative_number());
  command
      ->add_option("--tolerance-um", options->tolerance_um,
                   "Insert poses until the tool stays this close to the lines between the points (0: none)")
      ->check(non_negative_number());
  command->add_option("--word", options->words, "Word of an axis in the program, AXIS=WORD (C1=C); repeatable");
  command->add_option("--decimals", options->decimals, "Decimals of mm and degrees in the program")
      ->check(in_range(1, 12));
  command->add_flag("--feed-per-minute", options->feed_per_minute,
                    "Write F in mm/min (G94) instead of inverse time (G93)");
  command->add_output_file("-o,--output", options->outputs, "File to write: .ngc, .nc, .tap, .mpf or .csv; repeatable");
  command->add_output_file("--report", options->report,
                           "Page to write (.html): an animation of the tool on its path over the part");
  command->add_input_file("--part", options->part, "Mesh of the workpiece for that page (.stl .ply .obj .step), mm")
      ->needs("--report");
  options->step.add_to(command);
  add_states(*command, options->states);
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options]() -> int { return run_path(*options); }; });
}

}  // namespace abbe
