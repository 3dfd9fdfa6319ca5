#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/compensation/errors_map.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct MapOptions {
  std::string machine, errors, reference, poses;
  std::vector<std::string> grid, outputs, states;
  WorkpieceOptions workpiece;
  bool fit_datum = false, keep_datum = false, accept_uncovered = false, json = false;
};

ErrorsMapRequest request_of_map(const MapOptions& options) {
  ErrorsMapRequest request;
  request.machine = read_machine(options.machine);
  request.errors = read_errors_and_tell(options.errors, request.machine, options.states);
  if (!options.reference.empty())
    request.minus = read_errors_and_tell(options.reference, request.machine, options.states);
  request.workpiece = workpiece_option(request.machine, options.workpiece, options.states);
  request.fit_datum = !options.keep_datum;
  if (!options.poses.empty()) {
    request.poses.emplace();
    request.poses->poses = read_poses(options.poses, request.machine);
    request.poses->words = fmt::format("{} poses of {}", request.poses->poses.count(),
                                       std::filesystem::path(options.poses).filename().string());
  }
  request.grid.resize(request.machine.axes.size());
  for (const std::string& text : options.grid) take_grid_option(request.machine, text, request.grid);
  return request;
}

int run_map(const MapOptions& options, ProcessGroup* processes) {
  const ErrorsMapRequest request = request_of_map(options);
  SharedWork work(processes, options.outputs.empty() ? "" : options.outputs.front(), tell_sentence);
  const ErrorsMap map =
      map_errors(request, {.progress = Progress("mapping the volumetric error").callback(), .work = work.driver()});
  if (!work.is_first()) return kDone;
  const MapData data = errors_map_data(map);
  for (const std::string& output : options.outputs) require_map_name(output, data);
  for (const std::string& output : options.outputs) write_file_atomically(output, map_text(output, data));
  work.done();
  if (options.json) {
    fmt::print("{}", json_text(errors_map_json(map)));
  } else {
    fmt::print("{}", errors_map_text(map));
    for (const std::string& output : options.outputs) fmt::print("{} written\n", output);
  }
  return tell_left_out(map.left_out(), options.accept_uncovered);
}

}  // namespace

void add_map_command(CommandLine& line) {
  auto options = std::make_shared<MapOptions>();
  Subcommand* command =
      line.add("map", "Compute the volumetric error over a grid or at given poses, with uncertainty",
               "  abbe map --machine examples/machines/aguado.machine.toml --errors "
               "examples/aguado/results/aguado/errors.toml --grid C_deg=0:315:8 -o "
               "map.csv -o map.vts\n"
               "  abbe map --machine examples/machines/aguado.machine.toml --errors readings/truth.errors.toml --minus "
               "examples/aguado/results/aguado/errors.toml\n\n"
               "The examples of run and simulate write these files. docs/conventions.md defines the\n"
               "figures. Without --grid, every axis runs over the range in which its errors are\n"
               "known.");
  add_machine_and_errors(*command, options->machine, options->errors);
  command->add_input_file("--minus", options->reference,
                          "Errors that are corrected (*.errors.toml): adds the error that remains");
  add_states(*command, options->states);
  add_workpiece(*command, options->workpiece);
  command->add_option("--grid", options->grid, "AXIS_unit=from:to:count or AXIS_unit=position; repeat per axis");
  command
      ->add_input_file("--poses", options->poses, "CSV with one column per axis (X_mm, C_deg, ...) instead of a grid")
      ->excludes("--grid");
  command->add_flag("--keep-datum", options->keep_datum,
                    "Do not fit the workpiece datum: gives displacements, not the volumetric error");
  command
      ->add_flag("--fit-datum", options->fit_datum,
                 "Remove the best-fit rigid motion of the workpiece (done unless --keep-datum is given)")
      ->excludes("--keep-datum");
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_output_file("-o,--output", options->outputs, "File to write: .csv, .vts or .vtu (ParaView); repeatable");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.share([options](ProcessGroup* all) { return run_map(*options, all); }); });
}

}  // namespace abbe
