#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/compensation/found_positions.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "step_reading.h"

namespace abbe {
namespace {

struct PositionCommand {
  std::string file, output, maps;  ///< maps: "table-to-workpiece" if empty
  bool json = false;
  StepReading step;
};

PositionsRequest request_of(const PositionCommand& command) {
  if (command.output.empty() && !command.maps.empty()) {
    throw InputError({.field = "--maps"}, "there is no placement whose matrix maps that way", "with --output");
  }
  PositionsRequest request = read_positions_request(command.file, [&](const std::string& part) {
    command.step.require_step_among({part});
    return command.step.read(part);
  });
  if (!command.output.empty() && !request.scans.workpiece) {
    throw InputError({.field = "--output"}, "there is no workpiece to be placed",
                     "a table [workpiece] in " + command.file);
  }
  if (!request.part) command.step.require_step_among({});
  return request;
}

int run_position(const PositionCommand& command) {
  const PositionsRequest request = request_of(command);
  FoundPositions found;
  {
    Progress progress("registering");
    found = find_positions(request, {.progress = progress.callback()});
  }
  if (found.is_ok() && !command.output.empty()) {
    write_file_atomically(command.output, found_placement_file(found, command.maps != "workpiece-to-table"));
  }
  if (command.json) fmt::print("{}", json_text(found_positions_json(found)));
  if (!found.is_ok()) {
    tell("abbe: {}\n", found.problem);
    return kNegative;
  }
  if (command.json) return kDone;
  fmt::print("{}", found_positions_text(found));
  if (!command.output.empty()) fmt::print("{} written\n", command.output);
  return kDone;
}

}  // namespace

void add_position_command(CommandLine& line) {
  auto command = std::make_shared<PositionCommand>();
  Subcommand* app = line.add(
      "position",
      "Find where a scanner and a workpiece stand in a machine, from scans of targets, a sphere and the part",
      "  abbe position examples/laser_engraver/scanner.positioning.toml\n"
      "  abbe position examples/laser_engraver/scanner.positioning.toml -o part.placement.toml\n\n"
      "The file names a CSV with target, x_mm, y_mm, z_mm in the scanner's frame; docs/workpiece-position.md.\n"
      "Exit code 1: the scans do not determine the position; the message says why.");
  app->add_input_file("file", command->file, "Positioning file (*.positioning.toml): the scans and what they show")
      ->required();
  app->add_output_file("-o,--output", command->output, "Placement to write (*.placement.toml), as abbe path takes it");
  app->add_option("--maps", command->maps,
                  "Direction in which the matrix of the written placement maps: table-to-workpiece (default) or "
                  "workpiece-to-table")
      ->check(one_of({"table-to-workpiece", "workpiece-to-table"}));
  command->step.add_to(app);
  app->add_flag("--json", command->json, "Print JSON for programs");
  app->callback([&line, command] { line.run = [command] { return run_position(*command); }; });
}

}  // namespace abbe
