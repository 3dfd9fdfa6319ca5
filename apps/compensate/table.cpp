#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"
#include "abbe/controls/table_map.h"
#include "abbe/controls/table_text.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/table_options.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct TableCommand {
  std::string machine, errors, format, output, map, over;
  std::vector<std::string> at, axes, names, reference_position, states;
  std::optional<double> interpolation_um, limit_um, limit_urad;
  WorkpieceOptions workpiece;
  double interpolation_urad = 0.1, times_uncertainty = 0, least_reduction_percent = 1;
  std::optional<std::size_t> max_points, positions;
  std::size_t first_table = 0, encoder = 0;
  double unit_um = 1;
  int type = 1;
  bool json = false, dry_run = false, accept_misfit = false, negate = false, negate_own = false;
  std::set<TableSetting> given;

  std::string map_extension() const { return std::filesystem::path(map).extension().string(); }
};

void check_outputs(const TableCommand& command) {
  if (command.output.empty() && !command.dry_run) {
    throw InputError({.field = "-o"}, "no output", "a file, a folder, or --dry-run");
  }
  if (!command.output.empty()) refuse_input_as_output(command.output);
  if (command.map.empty()) return;
  refuse_input_as_output(command.map);
  const std::string extension = command.map_extension();
  if (extension != ".csv" && extension != ".vts" && extension != ".vtu") {
    throw InputError({.file = command.map}, "unknown kind of map file", "a name ending in .csv, .vts or .vtu");
  }
}

/// @returns the names of the files written
std::vector<std::string> write_tables(const TableCommand& command, const ControlTables& made) {
  if (made.files.empty()) return {};
  if (names_folder(command.output)) {
    std::vector<std::string> written;
    ResultsFolder folder(command.output);
    for (const ControlFile& file : made.files) {
      folder.write(file.name, file.text);
      written.push_back((std::filesystem::path(command.output) / file.name).string());
    }
    folder.commit();
    return written;
  }
  if (made.files.size() > 1) {
    throw InputError({.field = "-o " + command.output}, fmt::format("{} files are to be written", made.files.size()),
                     std::string("a folder (a name without ending)") +
                         (made.format->file_per_axis ? ", or one axis with --axis" : ""));
  }
  write_file_atomically(command.output, made.files.front().text);
  return {command.output};
}

/// What only some formats take.
void add_settings(const TableCommand& command, ControlTableRequest& request) {
  const auto given = [&](TableSetting setting) { return command.given.contains(setting); };
  const TableFormat& format = table_format(command.format);
  request.reference = axis_options(request.machine, "--at", command.at);
  request.reference_position = axis_options(request.machine, "--reference-position", command.reference_position);
  request.axes = command.axes;
  request.names = axis_names_option(format, command.names);
  if (command.interpolation_um) request.tolerance_mm = 1e-3 * *command.interpolation_um;
  if (given(TableSetting::tolerance_rad)) request.tolerance_rad = 1e-6 * command.interpolation_urad;
  request.most_nodes = command.max_points;
  if (given(TableSetting::type)) request.type = command.type;
  if (given(TableSetting::encoder)) request.encoder = command.encoder;
  if (given(TableSetting::first_table)) request.first_table = command.first_table;
  request.negate = command.negate;
  request.negate_own = command.negate_own;
  if (given(TableSetting::detection_unit)) request.detection_unit_mm = 1e-3 * command.unit_um;
}

int run_table(const TableCommand& command) {
  refuse_settings_of_other_formats(table_format(command.format), command.given);
  ControlTableRequest request;
  request.format = command.format;
  request.machine = read_machine(command.machine);
  const ErrorsFile file = read_errors_for_use(command.errors, request.machine, command.accept_misfit, command.states);
  request.errors = file.errors;
  request.errors_file = command.errors;
  request.covariance = file.covariance;
  if (!command.over.empty()) {
    request.over_file = command.over;
    request.over = read_errors_over_time(command.errors, request.machine, command.states, command.over);
  }
  request.workpiece = workpiece_option(request.machine, command.workpiece, command.states);
  check_outputs(command);
  if (command.limit_um) request.limit_mm = 1e-3 * *command.limit_um;
  if (command.limit_urad) request.limit_rad = 1e-6 * *command.limit_urad;
  request.positions = command.positions;
  request.least_reduction = 0.01 * command.least_reduction_percent;
  request.leave_out_below = command.times_uncertainty;
  add_settings(command, request);

  const ControlTables made = make_control_tables(request);
  const std::string extension = command.map_extension();
  const MapData map = command.map.empty() ? MapData() : control_table_map(request.machine, made);
  if (!command.map.empty() && extension != ".csv" && (extension == ".vts") != map_is_structured(map)) {
    throw InputError({.file = command.map}, "wrong kind of map file",
                     map_is_structured(map) ? ".vts for these poses" : ".vtu for these poses");
  }
  std::vector<std::string> written;
  if (!made.says_no() && !command.dry_run) written = write_tables(command, made);
  if (made.refused.empty() && !command.map.empty()) {
    write_file_atomically(command.map, map_text(command.map, map));
    written.push_back(command.map);
  }
  const TableReport report{request.machine, made, partial_errors(request.machine, file), written};
  fmt::print("{}", command.json ? json_text(table_json(report)) : table_text(report));
  if (command.dry_run && !command.json) fmt::print("dry run: no table is written\n");
  std::fflush(stdout);
  for (const std::string& words : made.refused) tell("abbe: {}; nothing is written\n", words);
  if (!made.too_few_nodes.empty()) tell("abbe: {}; no table is written\n", made.too_few_nodes);
  StateValues at_state = file.at_state;
  if (made.over_states && made.over_states->outside > 0) at_state.outside.push_back(made.over_states->outside_words());
  return tell_outside(at_state, made.says_no() ? kNegative : kDone);
}

}  // namespace

void add_compensate_table(Subcommand& compensate, CommandLine& line) {
  auto options = std::make_shared<TableCommand>();
  std::string formats = "Formats:\n";
  std::vector<std::string> names;
  for (const TableFormat& format : table_formats()) {
    names.emplace_back(format.name);
    formats += fmt::format("  {:<16} {}\n", format.name, format.what);
    if (format.unverified.empty()) continue;
    formats += fmt::format("  {:<16} EXPERIMENTAL, not verified: {}\n", "", format.unverified);
  }
  Subcommand* const command =
      compensate.add_subcommand("table", "Write tables for a control, and report what they cannot carry");
  command->footer(formats +
                  "\nExamples:\n"
                  "  abbe compensate table --machine examples/machines/three-axis-mill.machine.toml --errors "
                  "examples/compensate/mill.errors.toml --for linuxcnc --limit-um 100 -o comp\n"
                  "  abbe compensate table --machine examples/machines/three-axis-mill.machine.toml --errors "
                  "examples/compensate/mill.errors.toml --for aerotech-2d --interpolation-um 1 -o mill.cal\n"
                  "Signs, units and sources of every format: docs/controller-tables.md");
  add_machine_and_errors(*command, options->machine, options->errors);
  command->add_option("--for", options->format, "Format, see below")->required()->suggest(names);
  command->add_output_file_or_folder(
      "-o,--output", options->output,
      "File to write, or a folder (a name without an extension) if there are several files", &options->dry_run);
  command->add_flag("--dry-run", options->dry_run, "Report only; write no table");
  command->add_option("--at", options->at,
                      "AXIS_unit=position: position of an axis while another one moves, or if it is not in the grid "
                      "(default: the middle of its travel)");
  command->add_option("--axis", options->axes, "Write only tables over the position of this axis; repeatable");
  command->add_option("--name", options->names,
                      "AXIS=NAME: the name or number that the control has for an axis; repeatable");
  command->add_option("--interpolation-um", options->interpolation_um,
                      "Largest error of linear interpolation between nodes, um (default 0.1; fanuc-3d 1, including the "
                      "rounding of its data)");
  command->add_option("--interpolation-urad", options->interpolation_urad,
                      "The same for rotary axes, urad (default 0.1)");
  command->add_option("--max-points", options->max_points, "Largest number of nodes per table; for a grid, in total");
  command->add_option("--positions", options->positions,
                      "Positions per axis, between the nodes, at which the displacement is stated (default 9; 5 with "
                      "more than 3 axes)");
  command->add_option("--limit-um", options->limit_um, "Refuse any correction of a linear axis above this, um");
  command->add_option("--limit-urad", options->limit_urad, "Refuse any correction of a rotary axis above this, urad");
  command
      ->add_option("--least-reduction-percent", options->least_reduction_percent,
                   "Refuse tables that remove less of the error than this; 0 writes them anyway")
      ->check(in_range(0.0, 100.0))
      ->capture_default_str();
  command->add_option("--leave-out-below-uncertainty", options->times_uncertainty,
                      "Leave out tables that nowhere exceed this many times their standard uncertainties");
  command->add_option("--type", options->type, "linuxcnc: COMP_FILE_TYPE, 0 or 1 (default 1)");
  command->add_option("--first-table", options->first_table, "siemens-cec: index of the first table (default 0)");
  command->add_option("--encoder", options->encoder, "siemens-eec: measuring system, 0 or 1 (default 0)");
  command->add_flag("--negate", options->negate,
                    "siemens-cec, heidenhain, heidenhain-kinematics-comp, fanuc-pitch, fanuc-3d, aerotech-1d, "
                    "aerotech-2d: write values with the opposite sign (the sign of the control is not verified)");
  command->add_flag("--negate-own", options->negate_own,
                    "heidenhain-kinematics-comp: the same for the columns of the axes themselves; --negate then "
                    "reverses C1 to C6 and COMPTAB");
  command->add_option(
      "--detection-unit-um", options->unit_um,
      "fanuc-pitch, fanuc-3d: unit of the data, um, or thousandths of a degree for rotary axes (default 1)");
  command->add_option(
      "--reference-position", options->reference_position,
      "fanuc-pitch, fanuc-3d: AXIS_unit=position, the reference position of the control in machine file coordinates "
      "(default: 0, or the end of the travel next to it); repeatable");
  command->add_output_file(
      "--map", options->map,
      "Map to write: displacement without tables, with tables and with ideal compensation; .csv, .vts or .vtu");
  add_workpiece(*command, options->workpiece);
  add_states(*command, options->states);
  command->add_input_file(
      "--state-over", options->over,
      "Also state the error that remains with the tables at the states of a record (CSV: time_s and states)");
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options, command] {
    for (const TableSetting setting : table_settings()) {
      if (command->count(setting_option(setting)) > 0) options->given.insert(setting);
    }
    line.run = [options]() -> int { return run_table(*options); };
  });
}

}  // namespace abbe
