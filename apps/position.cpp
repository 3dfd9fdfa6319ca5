#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/readings/scanner_positioning_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/registration/registration.h"
#include "abbe/report/words/geometry_facts.h"
#include "abbe/report/words/positioning_words.h"
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

PlacedWorkpiece lay_on_workpiece(const WorkpieceScan& workpiece, const StepReading& step) {
  PlacedWorkpiece result;
  if (workpiece.part.empty()) {
    FeatureRegistrationOptions options;
    options.noise_mm = workpiece.noise;
    result.fine =
        register_to_features(workpiece.points, workpiece.features, workpiece.labels, workpiece.start, options);
    result.ok = result.fine.status == FineRegistrationStatus::ok;
    result.status = registration_status_name(result.fine.status);
    return result;
  }
  RegistrationOptions options;
  options.noise_mm = workpiece.noise;
  const MeshFile part = step.read(workpiece.part);
  if (!part.left_out.empty()) result.warnings.push_back("the part is " + incomplete_words(part));
  const PointCloudFile scan = read_point_cloud(workpiece.scan);
  Progress progress("registering");
  const Registration found = RegistrationTarget(part.mesh, options).register_scan(scan.cloud, progress.callback());
  result.fine = found.fine;
  result.ok = found.status == RegistrationStatus::ok;
  result.status = registration_status_name(found.status);
  return result;
}

int run_position(const PositionCommand& command) {
  const ScannerPositioningFile file = read_scanner_positioning(command.file);
  if (!command.output.empty() && !file.workpiece) {
    throw InputError({.field = "--output"}, "there is no workpiece to be placed",
                     "a table [workpiece] in " + command.file);
  }
  if (command.output.empty() && !command.maps.empty()) {
    throw InputError({.field = "--maps"}, "there is no placement whose matrix maps that way", "with --output");
  }
  command.step.require_step_among({file.workpiece ? file.workpiece->part : std::filesystem::path()});
  const ScannerPosition scanner = locate_scanner(file.scans);
  std::optional<PlacedWorkpiece> placed;
  if (scanner.status == PositioningStatus::ok && file.workpiece) {
    placed = lay_on_workpiece(*file.workpiece, command.step);
    if (placed->ok) placed->placement = locate_workpiece(scanner, placed->fine);
  }
  const PlacedWorkpiece* const workpiece = placed ? &*placed : nullptr;
  const bool found = scanner.status == PositioningStatus::ok && (workpiece == nullptr || workpiece->ok);
  if (found && !command.output.empty()) {
    write_file_atomically(command.output, placement_text({workpiece->placement, workpiece->warnings},
                                                         command.maps != "workpiece-to-table"));
  }
  if (command.json) fmt::print("{}", json_text(positions_json(command.file, scanner, workpiece)));
  if (scanner.status != PositioningStatus::ok) {
    tell("abbe: {}: the scanner's position is not found: {}\n", command.file, scanner.reason);
    return kNegative;
  }
  if (placed && !placed->ok) {
    tell("abbe: {}: the workpiece's position is not found: {}\n", command.file, placed->status);
    return kNegative;
  }
  if (command.json) return kDone;
  fmt::print("{}", positions_text(command.file, scanner, workpiece));
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
  app->add_input_file("file", command->file, "Scans and what they show (*.positioning.toml)")->required();
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
