#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/machine/tool_path.h"
#include "abbe/machine/tool_path_miss.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/pages/path_page.h"
#include "abbe/report/words/geometry_facts.h"
#include "abbe/report/words/path_words.h"
#include "axis_option.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "step_reading.h"

namespace abbe {
namespace {

struct PathCommand {
  std::string machine, curve, errors, placement, part, report;
  std::vector<std::string> hold, start, words, outputs;
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
  options.comments = {"tool path of " + std::filesystem::path(command.curve).filename().string() + " on " +
                      machine.name};
  return options;
}

/// @param warnings  of the placement
void write_page(const PathCommand& command, const Machine& machine, const ToolPath& path,
                const std::vector<std::vector<double>>& commands, const std::vector<std::string>& warnings) {
  std::optional<SurfacePicture> part;
  std::string incomplete;
  if (!command.part.empty()) {
    const MeshFile mesh = command.step.read(command.part);
    part = part_picture(mesh.mesh, 0, 0);
    if (!mesh.left_out.empty()) incomplete = "; " + incomplete_words(mesh);
  }
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  std::vector<std::pair<std::string, std::string>> facts = path_facts(name(command.curve), path);
  if (!warnings.empty()) {
    facts.emplace_back("placement", fmt::format("{}; {}", name(command.placement), fmt::join(warnings, "; ")));
  }
  if (part) {
    facts.emplace_back("part",
                       fmt::format("{}, {} triangles{}", name(command.part), part->triangles_of_part, incomplete));
  }
  write_file_atomically(command.report, path_page("Tool path of " + name(command.curve), machine, facts,
                                                  path_picture(machine, path, commands), part));
}

int run_path(const PathCommand& command) {
  command.step.require_step_among({command.part});
  const Machine nominal = read_machine(command.machine);
  CalibratedMachine calibrated{nominal, std::vector<double>(nominal.axes.size(), 0.0), {}};
  if (!command.errors.empty()) {
    calibrated =
        calibrated_machine(nominal, read_errors_for_use(command.errors, nominal, command.accept_misfit).errors);
    if (!calibrated.variable.empty()) {
      throw InputError({.file = command.errors, .field = calibrated.variable},
                       "an error motion, which depends on the position of its axis",
                       "location errors and a tool offset error only: what changes the geometry of the machine once");
    }
  }
  Machine machine = calibrated.machine;
  std::vector<std::string> warnings;
  if (!command.placement.empty()) {
    PlacementFile file = read_placement(command.placement);
    machine = with_workpiece(machine, file.placement);
    warnings = std::move(file.warnings);
    for (const std::string& warning : warnings) tell("abbe: warning: {}: {}\n", command.placement, warning);
  }
  Curve curve = read_curve(command.curve, machine);
  for (CurvePoint& point : curve.points) {
    if (!(point.feed > 0)) point.feed = command.feed_mm_per_min / 60;
    if (point.working && !(point.feed > 0)) {
      throw InputError({.file = command.curve}, "moves at work without a feed",
                       "a column feed_mm_per_min, F in a program, or --feed-mm-per-min");
    }
    for (std::size_t k = 0; k < curve.indexed.size(); ++k) point.indexed[k] += calibrated.zero[curve.indexed[k]];
  }
  ToolPathOptions options;
  options.retract = command.retract_mm;
  options.tolerance = 1e-3 * command.tolerance_um;
  for (const std::string& text : command.hold) {
    HeldAxis held = axis_option(machine, "--hold", text);
    if (std::find(curve.indexed.begin(), curve.indexed.end(), held.axis) != curve.indexed.end()) {
      throw InputError({.field = "--hold " + text}, "the curve gives this axis its commands", "an axis of its own");
    }
    held.position += calibrated.zero[held.axis];
    options.path.inverse.held.push_back(held);
  }
  if (!command.start.empty()) {
    options.path.start.assign(machine.axes.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::string& text : command.start) {
      const HeldAxis at = axis_option(machine, "--start", text);
      options.path.start[at.axis] = at.position + calibrated.zero[at.axis];
    }
  }
  const PathProgramOptions program = program_options(command, machine);

  const ToolPath path = plan_tool_path(machine, curve, options);
  if (path.status == ToolPathStatus::no_retract) {
    throw InputError({.field = "--retract-mm"}, path.message, "a distance above zero");
  }
  if (path.status == ToolPathStatus::invalid_options) throw InputError({.file = command.curve}, path.message);
  if (path.status == ToolPathStatus::start_undecided) throw InputError({.field = "--start"}, path.message);
  if (path.status != ToolPathStatus::followed && path.status != ToolPathStatus::jumps_while_working) {
    tell("abbe: point {} of {}: {}\n", path.failed_point + 1, command.curve, path.message);
    return kNegative;
  }
  std::vector<std::vector<double>> commands;
  for (const ToolPathStep& step : path.steps) {
    std::vector<double> row(machine.axes.size());
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = step.command[i] - calibrated.zero[i];
    commands.push_back(std::move(row));
  }
  for (const std::string& output : command.outputs) {
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension == ".csv") {
      write_file_atomically(output, path_csv(machine, path, commands));
    } else if (extension == ".ngc" || extension == ".nc" || extension == ".tap" || extension == ".mpf") {
      write_file_atomically(output, path_program(machine, path, commands, program));
    } else {
      throw InputError({.file = output}, "unknown kind of program file",
                       "a name ending in .ngc, .nc, .tap, .mpf or .csv");
    }
  }
  if (!command.report.empty()) write_page(command, machine, path, commands, warnings);
  const ToolPathMiss miss = largest_miss(machine, curve, path);
  if (command.json) {
    nlohmann::ordered_json json = path_json(machine, path, miss);
    if (!warnings.empty()) json["warnings"] = warnings;
    fmt::print("{}", json_text(json));
  } else {
    fmt::print("{}", path_text(machine, path, miss));
    for (const std::string& output : command.outputs) fmt::print("{} written\n", output);
  }
  if (path.status == ToolPathStatus::jumps_while_working) {
    tell("abbe: {}: another start (--start), a held axis, or a cut of the curve there\n", path.message);
    return kNegative;
  }
  return kDone;
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
  add_errors(*command, options->errors, "Identified location errors and tool offset (*.errors.toml)");
  command->add_input_file("--placement", options->placement, "Where the workpiece is clamped (*.placement.toml)");
  command->add_option("--hold", options->hold, "Axis kept at a command, AXIS_unit=position; repeatable");
  command->add_option(
      "--start", options->start,
      "Where an axis stands before the path, AXIS_unit=position; repeatable. The nearest branch is taken; "
      "axes that are not named may stand anywhere");
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
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options]() -> int { return run_path(*options); }; });
}

}  // namespace abbe
