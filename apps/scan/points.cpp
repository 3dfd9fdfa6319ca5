#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/scan_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
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
  std::string machine, readings, errors, output;
  std::vector<double> zero, beam, range;
  std::vector<std::string> columns, ignore;
  ScanOptions scan;
  bool any_travel = false, json = false, accept_misfit = false, accept_uncovered = false;
};

/// "indication_um=h": our name with its unit = name in the file.
void read_mapping(const PointsOptions& options, ColumnMapping& mapping) {
  for (const std::string& text : options.columns) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw InputError({.field = "--column " + text}, "not understood", "NAME_unit=COLUMN, such as indication_um=h");
    }
    if (!mapping.columns.emplace(text.substr(0, equals), text.substr(equals + 1)).second) {
      throw InputError({.field = "--column " + text}, "this name is given twice");
    }
  }
  mapping.ignore = options.ignore;
  mapping.ignored_by = "--ignore";
}

ProbeBeam beam_of(const PointsOptions& options, const Machine& machine) {
  ProbeBeam beam;
  beam.direction = -machine.tool_direction;
  if (!options.zero.empty()) beam.zero = {options.zero[0], options.zero[1], options.zero[2]};
  if (!options.beam.empty()) {
    beam.direction = {options.beam[0], options.beam[1], options.beam[2]};
    const double length = beam.direction.norm();
    if (!(length > 1e-12) || !std::isfinite(length)) {
      throw InputError({.field = "--beam"}, "the direction has no length", "three numbers, not all of them zero");
    }
    beam.direction /= length;
  }
  return beam;
}

int run_points(PointsOptions options) {
  const Machine machine = read_machine(options.machine);
  ErrorSet errors;
  if (!options.errors.empty()) errors = read_errors_for_use(options.errors, machine, options.accept_misfit).errors;
  read_mapping(options, options.scan.mapping);
  options.scan.check_travel = !options.any_travel;
  if (!options.range.empty()) {
    options.scan.lowest_indication = options.range[0];
    options.scan.highest_indication = options.range[1];
    if (!(options.range[0] < options.range[1])) {
      throw InputError({.field = "--indication-range-mm"}, "the range is empty", "the lower end first");
    }
  }
  Progress progress("computing points");
  options.scan.progress = progress.callback();
  const ScanSummary summary = scan_points(
      options.readings, machine, PointScan(machine, errors, beam_of(options, machine)), options.output, options.scan);
  if (options.json) {
    nlohmann::ordered_json json;
    json["machine"] = machine.name;
    json["errors"] = options.errors;
    json["readings"] = summary.readings;
    json["points"] = summary.points;
    json["outside_indication_range"] = summary.out_of_range;
    json["outside_known_errors"] = summary.not_covered;
    if (summary.points > 0) {
      json["lowest_mm"] = {summary.lowest[0], summary.lowest[1], summary.lowest[2]};
      json["highest_mm"] = {summary.highest[0], summary.highest[1], summary.highest[2]};
    }
    json["output"] = options.output;
    fmt::print("{}", json_text(json));
  } else {
    fmt::print("{} readings on {}, {}\n", summary.readings, machine.name,
               options.errors.empty() ? "machine without errors" : "errors of " + options.errors);
    fmt::print("{} points written to {}\n", summary.points, options.output);
    if (summary.points > 0) {
      fmt::print("  x {:.4f} to {:.4f} mm, y {:.4f} to {:.4f} mm, z {:.4f} to {:.4f} mm\n", summary.lowest[0],
                 summary.highest[0], summary.lowest[1], summary.highest[1], summary.lowest[2], summary.highest[2]);
    }
    if (summary.out_of_range > 0) {
      fmt::print("  {} readings outside the probe's range are left out\n", summary.out_of_range);
    }
  }
  const int code = tell_left_out({.all = summary.readings, .not_covered = summary.not_covered, .what = "readings"},
                                 options.accept_uncovered);
  if (summary.points > 0) return code;
  // Readings outside the known errors have already been reported.
  if (summary.not_covered == 0) tell("abbe: no reading lies within the probe's range\n");
  return kNegative;
}

}  // namespace

void add_scan_points(Subcommand& scan, CommandLine& line) {
  auto options = std::make_shared<PointsOptions>();
  Subcommand* command =
      scan.add_subcommand("points", "Turn axis positions and indications of a probe into points of the part");
  command->footer(
      "Readings: CSV with one column per axis (X_mm, C_deg) and the indication (indication_mm, _um), positive away "
      "from\n"
      "the probe. Points are in the workpiece frame, in the order of the readings. Files of any length: neither the\n"
      "readings nor the points are kept in memory.\n\n"
      "Example:\n"
      "  abbe scan points examples/cradle_scanner/readings.csv --machine examples/machines/liu-scanner.machine.toml -o "
      "points.csv\n"
      "  abbe scan points examples/cradle_scanner/readings.csv --machine examples/machines/liu-scanner.machine.toml "
      "--errors "
      "examples/cradle_scanner/stages.errors.toml --indication-range-mm -0.2 0.2 -o points.ply");
  command->add_input_file("readings", options->readings, "CSV of axis positions and indications")->required();
  command->take_from_arguments({add_machine(*command, options->machine)->required()});
  add_errors(*command, options->errors, "Errors file (*.errors.toml): calibrated axes and all other errors");
  command->add_output_file("-o,--output", options->output, "Points: .csv (x_mm,y_mm,z_mm) or .ply (binary, double)")
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
  command
      ->add_option("--column", options->columns,
                   "Column that has another name: NAME_unit=COLUMN, such as indication_um=h")
      ->expected(1)
      ->take_all();
  command->add_option("--ignore", options->ignore, "Column that is not read")->expected(1)->take_all();
  command->add_option("--decimals", options->scan.decimals, "Decimals of a coordinate in CSV (default 9)")
      ->check(in_range(0, 12));
  command->add_flag("--any-travel", options->any_travel, "Accept positions outside the travel of an axis");
  command->add_option("--threads", options->scan.threads, "Threads (0: all)")->check(in_range(0, 64));
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_points(*options); }; });
}

}  // namespace abbe
