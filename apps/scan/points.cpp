#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/scans/scanned_points.h"
#include "column_options.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "scan/scan.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct PointsOptions {
  ScannedPointsRequest request;
  std::string machine;
  std::vector<double> zero, beam, range;
  std::vector<std::string> states;
  ColumnOptions columns;
  bool any_travel = false, json = false, accept_misfit = false, accept_uncovered = false;
};

Eigen::Vector3d vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

int run_points(const PointsOptions& options) {
  ScannedPointsRequest request = options.request;
  request.machine = read_machine(options.machine);
  if (!request.errors_file.empty()) {
    const ErrorsFile file =
        read_errors_for_use(request.errors_file, request.machine, options.accept_misfit, options.states);
    request.errors = file.errors;
    request.at_state = file.at_state;
  }
  request.scan.mapping = options.columns.mapping();
  request.scan.check_travel = !options.any_travel;
  if (!options.zero.empty()) request.beam_zero = vector_of(options.zero);
  if (!options.beam.empty()) request.beam = vector_of(options.beam);
  if (!options.range.empty()) request.indication_range = {options.range[0], options.range[1]};
  Progress progress("computing points");
  const ScannedPoints result = write_scanned_points(request, {.progress = progress.callback()});
  fmt::print("{}", options.json ? json_text(scanned_points_json(result)) : scanned_points_text(result));
  const int code = tell_left_out(result.left_out(), options.accept_uncovered);
  if (result.refused.empty()) return code;
  // Readings outside the known errors have already been reported.
  if (result.left_out().count() == 0) tell("abbe: {}\n", result.refused);
  return kNegative;
}

}  // namespace

void add_scan_points(Subcommand& scan, CommandLine& line) {
  auto options = std::make_shared<PointsOptions>();
  Subcommand* command =
      scan.add_subcommand("points", "Turn axis positions and indications of a probe into points of the part");
  command->footer(
      "Readings: CSV with one column per axis (X_mm, C_deg) and the indication (indication_mm, _um), positive away\n"
      "from the probe. Points are in the workpiece frame, in the order of the readings. Files of any length: neither\n"
      "the readings nor the points are kept in memory.\n\n"
      "Example:\n"
      "  abbe scan points examples/cradle_scanner/readings.csv --machine examples/machines/liu-scanner.machine.toml "
      "-o points.csv\n"
      "  abbe scan points examples/cradle_scanner/readings.csv --machine examples/machines/liu-scanner.machine.toml "
      "--errors examples/cradle_scanner/stages.errors.toml --indication-range-mm -0.2 0.2 -o points.ply");
  command->add_input_file("readings", options->request.readings, "CSV of axis positions and indications")->required();
  command->take_from_arguments({add_machine(*command, options->machine)->required()});
  add_errors(*command, options->request.errors_file,
             "Errors file (*.errors.toml): calibrated axes and all other errors");
  command
      ->add_output_file("-o,--output", options->request.output,
                        "Points: .csv (x_mm,y_mm,z_mm) or .ply (binary, double)")
      ->required();
  command
      ->add_option("--beam-zero-mm", options->zero,
                   "Point of the beam where the indication is zero, from the gauge point (default 0 0 0)")
      ->expected(3);
  command
      ->add_option("--beam", options->beam,
                   "Direction from the probe to the part, tool frame (default: against the tool's direction)")
      ->expected(3);
  command
      ->add_option("--indication-range-mm", options->range,
                   "Leave out indications outside this range: they are not measurements")
      ->expected(2);
  add_columns(command, options->columns, "indication_um=h");
  command->add_option("--decimals", options->request.scan.decimals, "Decimals of a coordinate in CSV (default 9)")
      ->check(in_range(0, 12));
  command->add_flag("--any-travel", options->any_travel, "Accept positions outside the travel of an axis");
  command->add_option("--threads", options->request.scan.threads, "Threads (0: all)")->check(in_range(0, 64));
  add_states(*command, options->states);
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_points(*options); }; });
}

}  // namespace abbe
