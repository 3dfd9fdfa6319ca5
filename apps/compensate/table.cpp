#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/line_tables.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/kept_inputs.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/volumetric_figures.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/position_words.h"
#include "compensate/reversal_words.h"
#include "compensate/safety.h"
#include "compensate/table_formats.h"
#include "compensate/table_left_out.h"
#include "compensate/table_options.h"
#include "compensate/table_report.h"
#include "compensate/travel_grid.h"
#include "compensate/useless_tables.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"

namespace abbe {
namespace {

/// Tables that make the error larger by more than this are refused.
constexpr double kWorse = 1.02;

struct TableCommand {
  std::string machine, errors, format, output, map;
  std::vector<std::string> at, axes, names, reference_position;
  std::optional<double> interpolation_um, limit_um, limit_urad;
  double interpolation_urad = 0.1, times_uncertainty = 0, least_reduction_percent = 1;
  std::optional<std::size_t> max_points, positions;
  std::size_t first_table = 0, encoder = 0;
  double unit_um = 1;
  int type = 1;
  bool json = false, dry_run = false, accept_misfit = false, negate = false;
  std::vector<std::string> given;  ///< of the options that not every format has
};

std::size_t checked_positions(const TableCommand& command, const Machine& machine) {
  if (!command.positions) return machine.axes.size() > 3 ? 5 : 9;
  const std::size_t positions = *command.positions;
  double poses = 1;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) poses *= static_cast<double>(positions);
  if (positions < 2 || poses > 1e6) {
    throw InputError({.field = fmt::format("--positions {}", positions)},
                     fmt::format("{:.0f} poses for {} axes", poses, machine.axes.size()),
                     "at least 2 positions per axis and at most 1,000,000 poses");
  }
  return positions;
}

/// What takes the reversal values that the tables do not carry.
void state_reversals(const ErrorSet& errors, const TableRequest& request, TableReport& report) {
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value == 0) continue;
    const Axis& axis = report.machine->axes[reversal.axis];
    const bool rotary = axis.kind == AxisKind::rotary, in_tables = report.format->directions;
    std::string words;
    if (in_tables && !request.axes.empty() && !request.axes[reversal.axis]) {
      words = "no table is wanted for this axis";
    } else if (report.format->backlash) {
      const bool named = !report.format->axis_names.empty();
      words = report.format->backlash(named ? table_axis(request.names, reversal.axis).name : axis.name,
                                      -reversal.value, rotary);
    } else {
      words =
          "backlash compensation of the control takes it, if it has one: " + lost_motion_words(-reversal.value, rotary);
    }
    report.reversals.emplace_back(reversal_name(*report.machine, reversal.axis), words);
  }
}

/// The largest corrections over tables and grid, and what of them is above a limit.
void look_at_limits(const TableCommand& command, const ControllerTables& tables, TableReport& report) {
  const Machine& machine = *report.machine;
  PoseList added;
  tables.correction->evaluate(report.poses, added);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    double& largest = rotary ? report.largest_rad : report.largest_mm;
    for (std::size_t k = 0; k < report.poses.count(); ++k) {
      if (!(std::abs(added.axis[i][k]) > largest)) continue;
      largest = std::abs(added.axis[i][k]);
      (rotary ? report.largest_rad_at : report.largest_mm_at) =
          fmt::format("{} for axis {}", position_words(machine, report.poses.pose(k)), machine.axes[i].name);
    }
  }
  const auto refuse = [&](double value, bool is_angle, const std::string& where) {
    const double limit = is_angle ? refusal_limit("--limit-urad", command.limit_urad, "urad")
                                  : refusal_limit("--limit-um", command.limit_um, "um");
    const double shown = micro_per_unit(is_angle) * value;
    if (!(shown <= limit)) {
      const char* const unit = micro_unit(is_angle);
      report.refused.push_back(fmt::format("{:.3f} {} is above --limit-{} {:g}: {}", shown, unit, unit, limit, where));
    }
  };
  const double before = report.before.position_statistics.rms, after = report.after.position_statistics.rms;
  if (!tables.tables.empty() && after > kWorse * before) {
    report.refused.push_back(fmt::format(
        "the displacement of the tool would grow from {:.3f} to {:.3f} um rms: the tables hold near the reference "
        "pose only (--at, --axis)",
        1e3 * before, 1e3 * after));
  }
  for (const TableSummary& table : tables.tables) {
    refuse(table.largest, table.is_angle, "table " + table.name);
  }
  refuse(report.largest_mm, false, report.largest_mm_at);
  refuse(report.largest_rad, true, report.largest_rad_at);
}

void check_outputs(const TableCommand& command) {
  if (command.output.empty() && !command.dry_run) {
    throw InputError({.field = "-o"}, "no output", "a file, a folder, or --dry-run");
  }
  if (!command.output.empty()) refuse_input_as_output(command.output);
  if (command.map.empty()) return;
  refuse_input_as_output(command.map);
  const std::string extension = std::filesystem::path(command.map).extension().string();
  if (extension != ".csv" && extension != ".vts" && extension != ".vtu") {
    throw InputError({.file = command.map}, "unknown kind of map file", "a name ending in .csv, .vts or .vtu");
  }
}

void write_tables(const TableCommand& command, const ControllerTables& tables, TableReport& report) {
  if (tables.files.empty()) return;
  if (names_folder(command.output)) {
    ResultsFolder folder(command.output);
    for (const auto& [name, text] : tables.files) {
      folder.write(name, text);
      report.written.push_back((std::filesystem::path(command.output) / name).string());
    }
    folder.commit();
    return;
  }
  if (tables.files.size() > 1) {
    throw InputError({.field = "-o " + command.output}, fmt::format("{} files are to be written", tables.files.size()),
                     std::string("a folder (a name without ending)") +
                         (report.format->file_per_axis ? ", or one axis with --axis" : ""));
  }
  write_file_atomically(command.output, tables.files.front().second);
  report.written.push_back(command.output);
}

TableRequest request_of(const TableCommand& command, const Machine& machine, const ErrorSet& errors,
                        const TableFormat& format) {
  TableRequest request;
  request.tolerance_mm = 1e-3 * command.interpolation_um.value_or(format.default_interpolation_um);
  request.tolerance_rad = 1e-6 * command.interpolation_urad;
  if (!(request.tolerance_mm > 0 && request.tolerance_rad > 0)) {
    throw InputError({.field = "--interpolation-um, --interpolation-urad"}, "not above zero", "a positive number");
  }
  request.reference = pose_option(machine, "--at", middle_of_travel(machine, errors), command.at);
  request.reference_position =
      pose_option(machine, "--reference-position", machine_zero(machine), command.reference_position);
  request.axes = chosen_axes(machine, command.axes);
  request.names = table_axis_names(machine, format, command.names);
  if (command.max_points && *command.max_points < 2) {
    throw InputError({.field = fmt::format("--max-points {}", *command.max_points)}, "is no table", "at least 2 nodes");
  }
  request.most_nodes = command.max_points.value_or(0);
  if (command.type != 0 && command.type != 1) throw InputError({.field = "--type"}, "unknown type", "0 or 1");
  request.type = command.type;
  if (command.encoder > 1) throw InputError({.field = "--encoder"}, "unknown measuring system", "0 or 1");
  request.encoder = command.encoder;
  if (command.first_table > 999) throw InputError({.field = "--first-table"}, "too large", "0 to 999");
  request.first_table = command.first_table;
  request.negate = command.negate;
  if (!(command.unit_um >= 0.001 && command.unit_um <= 10)) {
    throw InputError({.field = "--detection-unit-um"}, "out of range", "0.001 to 10 um");
  }
  request.unit_mm = 1e-3 * command.unit_um;
  return request;
}

int run_table(const TableCommand& command) {
  const TableFormat& format = table_format(command.format);
  refuse_options_of_other_formats(format, command.given);
  const Machine machine = read_machine(command.machine);
  const ErrorsFile file = read_errors_for_use(command.errors, machine, command.accept_misfit);
  check_outputs(command);
  check_leave_out(command.times_uncertainty, file, command.errors);
  refusal_limit("--limit-um", command.limit_um, "um");
  refusal_limit("--limit-urad", command.limit_urad, "urad");
  const ErrorSet& errors = file.errors;
  TableRequest request = request_of(command, machine, errors, format);
  TableReport report;
  report.format = &format;
  report.machine = &machine;
  report.partial = partial_errors(machine, file);
  report.poses = travel_grid(machine, errors, checked_positions(command, machine), report.grid);

  const Eigen::MatrixXd covariance = covariance_of(file);
  report.volumetric = volumetric_figures(machine, &errors, covariance, nullptr, stated_grid(machine, {&errors}));
  // What the tables are made of; they are judged by the errors of the file.
  ErrorSet carried = errors;
  std::vector<LeftOutReversal> left_out;
  if (covariance.size() > 0) {
    left_out = leave_out_uncertain_reversals(carried, covariance, command.times_uncertainty);
  }
  for (const LeftOutReversal& one : left_out) {
    report.left_out.push_back(
        fmt::format("{}: {:.2g} times its standard uncertainty", reversal_name(machine, one.axis), one.times));
  }
  ControllerTables tables = format.make(machine, carried, request);
  if (covariance.size() > 0) {
    std::vector<SmallTable> small, unused;
    report.uncertainty = table_uncertainties(carried, covariance, tables.tables, command.times_uncertainty, small);
    for (const SmallTable& table : leave_out_tables(machine, carried, covariance, report.poses, format, request,
                                                    command.times_uncertainty, tables, small)) {
      report.left_out_kept.push_back(table.text());
    }
    for (const SmallTable& table : small) report.left_out.push_back(table.text());
    if (!small.empty()) report.uncertainty = table_uncertainties(carried, covariance, tables.tables, 0, unused);
    ErrorMapOptions options;
    ParameterCovariance parameters;
    parameters.covariance = covariance;
    for (std::size_t p = 0; p < errors.parameter_count(); ++p) parameters.parameters.push_back(p);
    options.covariance = &parameters;
    options.orientation = false;
    const ErrorMap map = error_map(machine, errors, nullptr, pose_source(report.poses), options);
    report.uncertainty_statistics = sample_statistics(map.norm_uncertainty, map.covered);
  }
  report.tables = &tables;
  report.tolerance_mm = request.tolerance_mm;
  report.tolerance_rad = request.tolerance_rad;
  report.before = deviations_with(machine, errors, report.poses, NoCorrection());
  report.after = deviations_with(machine, errors, report.poses, *tables.correction);
  report.left_by_tables = volumetric_error_with(machine, errors, report.poses, *tables.correction);
  report.ideal = ideal_deviations(machine, errors, report.poses, report.ideal_not_reached);
  {
    std::vector<std::size_t> unused;
    const PoseList few = travel_grid(machine, errors, machine.axes.size() > 3 ? 3 : 5, unused);
    TableRequest quick = request;
    quick.nodes = 33;
    report.errors = carried_errors(machine, errors, few, [&](ErrorSet alone) {
      for (Reversal& reversal : alone.reversals) {
        for (const LeftOutReversal& one : left_out) reversal.value = reversal.axis == one.axis ? 0 : reversal.value;
      }
      return format.make(machine, alone, quick).correction;
    });
  }
  state_reversals(carried, request, report);
  look_at_limits(command, tables, report);
  report.refused.insert(report.refused.end(), tables.problems.begin(), tables.problems.end());
  if (report.refused.empty()) {
    const std::string useless = useless_tables(carried, request, report, command.least_reduction_percent);
    if (!useless.empty()) report.refused.push_back(useless);
  }
  const bool within =
      std::all_of(tables.tables.begin(), tables.tables.end(), [](const TableSummary& table) { return table.within; });
  const bool refused = !report.refused.empty();
  const std::string extension = std::filesystem::path(command.map).extension().string();
  if (!command.map.empty() && extension != ".csv" && (extension == ".vts") != table_map_is_structured(report)) {
    throw InputError({.file = command.map}, "wrong kind of map file",
                     table_map_is_structured(report) ? ".vts for these poses" : ".vtu for these poses");
  }
  if (!refused && within && !command.dry_run) write_tables(command, tables, report);
  if (!refused && !command.map.empty()) {
    write_file_atomically(command.map, table_map_text(report, extension == ".csv"));
    report.written.push_back(command.map);
  }
  if (command.json) {
    print_table_json(report);
  } else {
    print_table_report(report);
    if (command.dry_run) fmt::print("dry run: no table is written\n");
  }
  std::fflush(stdout);
  for (const std::string& words : report.refused) tell("abbe: {}; nothing is written\n", words);
  if (!refused && !within) {
    tell(
        "abbe: straight lines between the nodes that {} has room for do not keep to --interpolation-um or "
        "--interpolation-urad; no table is written\n",
        format.name);
  }
  return refused || !within ? kNegative : kDone;
}

}  // namespace

void add_compensate_table(Subcommand& compensate, CommandLine& line) {
  auto options = std::make_shared<TableCommand>();
  std::string formats = "Formats:\n";
  for (const TableFormat& format : table_formats()) {
    formats += fmt::format("  {:<16} {}\n", format.name, format.what);
    if (format.unverified.empty()) continue;
    formats += fmt::format("  {:<16} EXPERIMENTAL, not verified: {}\n", "", format.unverified);
  }
  Subcommand* const command = compensate.add_subcommand("table", "Tables for a control, and what they do not carry");
  command->footer(formats +
                  "\nExample:\n"
                  "  abbe compensate table examples/machines/three-axis-mill.machine.toml "
                  "examples/compensate/mill.errors.toml --for linuxcnc --limit-um 100 -o comp\n"
                  "Signs, units and sources of every format: docs/controller-tables.md");
  command->add_option("machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("errors", options->errors, "Errors file (*.errors.toml)")->required();
  command->add_option("--for", options->format, "Format, see below")->required();
  command->add_output_file_or_folder("-o,--output", options->output,
                                     "File to write, or a folder (a name without ending) where there are several",
                                     &options->dry_run);
  command->add_flag("--dry-run", options->dry_run, "Say all, write no table");
  command->add_option("--at", options->at,
                      "AXIS_unit=position: where an axis stands while another moves or that is not in a grid; default "
                      "the middle of its travel");
  command->add_option("--axis", options->axes, "Only tables over this axis's position; repeatable");
  command->add_option("--name", options->names,
                      "AXIS=NAME: what the control calls an axis (joint, number); repeatable");
  command->add_option(
      "--interpolation-um", options->interpolation_um,
      "Largest error of straight lines between nodes, um (0.1; fanuc-3d, with the rounding of its data: 1)");
  command->add_option("--interpolation-urad", options->interpolation_urad, "The same of rotary axes, urad (0.1)");
  command->add_option("--max-points", options->max_points,
                      "Nodes per table the control has room for; of a grid in all");
  command->add_option("--positions", options->positions,
                      "Positions per axis between the nodes, where the displacement is stated (9, 5 above 3 axes)");
  command->add_option("--limit-um", options->limit_um, "Refuse any correction of a linear axis above this, um");
  command->add_option("--limit-urad", options->limit_urad, "Refuse any correction of a rotary axis above this, urad");
  command
      ->add_option("--least-reduction-percent", options->least_reduction_percent,
                   "Refuse tables that take away less of the error than this; 0 writes them anyway")
      ->check(in_range(0.0, 100.0))
      ->capture_default_str();
  command->add_option("--leave-out-below-uncertainty", options->times_uncertainty,
                      "Leave out tables that are nowhere more than so many standard uncertainties");
  command->add_option("--type", options->type, "linuxcnc: COMP_FILE_TYPE, 0 or 1 (1)");
  command->add_option("--first-table", options->first_table, "siemens-cec: index of the first table (0)");
  command->add_option("--encoder", options->encoder, "siemens-eec: measuring system, 0 or 1 (0)");
  command->add_flag(
      "--negate", options->negate,
      "siemens-cec, heidenhain, fanuc-pitch, fanuc-3d: values with the other sign (theirs is not known for "
      "sure)");
  command->add_option("--detection-unit-um", options->unit_um,
                      "fanuc-pitch, fanuc-3d: unit of the data, um; of rotary axes thousandths of a degree (1)");
  command->add_option(
      "--reference-position", options->reference_position,
      "fanuc-pitch, fanuc-3d: AXIS_unit=position, where the control's reference position is in the machine file; "
      "default 0, or the end of the travel next to it; repeatable");
  command->add_output_file("--map", options->map,
                           "Map of the displacement without tables, with them and ideal: .csv, .vts or .vtu");
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options, command] {
    for (const FormatOption& option : format_options()) {
      if (command->count(option.name) > 0) options->given.push_back(option.name);
    }
    line.run = [options]() -> int { return run_table(*options); };
  });
}

}  // namespace abbe
