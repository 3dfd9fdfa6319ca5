#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/linkage_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/linkage_report.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "machine_options.h"
#include "options.h"

namespace abbe {
namespace {

struct LinkageCommand {
  EvaluationOptions options;
  std::string machine, convention = "table-moves";
  double exit_to_axis = 0, board = 0;
  LinkageAccuracy accuracy;
  std::vector<std::string> given;  ///< options that stand on the command line

  bool has(const std::string& name) const { return std::find(given.begin(), given.end(), name) != given.end(); }
};

/// An uncertainty of the command line.
struct AccuracyOption {
  const char* name;
  Quantity quantity;
  const char* unit;
  double LinkageAccuracy::*value;
  const char* words;
};

constexpr std::array<AccuracyOption, 12> kAccuracyOptions = {{
    {"--u-x-um", Quantity::length, "um", &LinkageAccuracy::x, "a position of X"},
    {"--u-y-um", Quantity::length, "um", &LinkageAccuracy::y, "a position of Y"},
    {"--u-z-um", Quantity::length, "um", &LinkageAccuracy::z, "a position of Z"},
    {"--u-a-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::a, "a position of A"},
    {"--u-c1-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::c1, "a position of C1"},
    {"--u-c2-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::c2, "a position of C2"},
    {"--u-zero-a-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::zero_a, "the zero of A (step 1)"},
    {"--u-zero-c1-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::zero_c1, "the zero of C1 (step 1)"},
    {"--u-mark-um", Quantity::length, "um", &LinkageAccuracy::microscope, "a place read by the microscope"},
    {"--u-width-um", Quantity::length, "um", &LinkageAccuracy::width, "a width"},
    {"--u-exit-to-axis-um", Quantity::length, "um", &LinkageAccuracy::exit_to_axis, "--exit-to-axis-mm"},
    {"--u-board-um", Quantity::length, "um", &LinkageAccuracy::thickness, "--board-mm"},
}};

/// The machine of the command line, with all axes that the linkage needs.
Machine linkage_machine(const LinkageCommand& command) {
  Machine machine = read_machine(command.machine);
  for (const char* axis : {"X", "Y", "Z", "C1", "A"}) {
    if (machine.find_axis(axis) == Machine::npos) {
      throw InputError({.file = command.machine}, fmt::format("the machine has no axis {}", axis),
                       "axes X, Y, Z and a swing head C1, A, as in examples/machines/yin-engraver-u.machine.toml");
    }
  }
  const LinkageConvention convention = linkage_convention_of(machine);
  const char* const name = convention == LinkageConvention::table_moves ? "table-moves" : "head-moves";
  if (command.has("--convention") && command.convention != name) {
    throw InputError({.field = "--convention " + command.convention}, "is not what the machine's chain says",
                     fmt::format("{}, or without it", name));
  }
  return machine;
}

int run_linkage(const LinkageCommand& command) {
  LinkageReadings readings = read_linkage(command.options.file);
  std::optional<Machine> machine;
  readings.convention =
      command.convention == "head-moves" ? LinkageConvention::head_moves : LinkageConvention::table_moves;
  if (!command.machine.empty()) {
    machine = linkage_machine(command);
    readings.convention = linkage_convention_of(*machine);
  }
  readings.exit_to_axis = command.exit_to_axis;
  readings.board_thickness = command.board;
  const LinkageEvaluation found = evaluate_linkage(readings, command.accuracy);
  if (found.status != LinkageStatus::ok) {
    const bool circle =
        found.status == LinkageStatus::circle_reversed || found.status == LinkageStatus::circle_undetermined;
    throw InputError({command.options.file, 0, 0, circle ? "turn" : "width"}, found.reason,
                     circle
                         ? "turn_deg: the angle by which the focus has turned about the axis of the table, seen from "
                           "the board, counter-clockwise from above, at two angles or more"
                         : "width_um at four or more positions Z_mm, on both sides of the focus");
  }
  std::string exact;
  bool stated = false;
  for (const AccuracyOption& option : kAccuracyOptions) {
    const bool uncertain = command.accuracy.*option.value > 0;
    stated = stated || uncertain;
    if (!uncertain) exact += (exact.empty() ? "" : ", ") + std::string(option.name);
  }
  std::optional<LinkageErrors> errors;
  if (machine) errors = linkage_errors(*machine, readings.convention, found.linkage, found.covariance);
  EvaluationReport report =
      linkage_report("Linkage of " + std::filesystem::path(command.options.file).filename().string(), readings, found,
                     stated, machine ? &*machine : nullptr, errors ? &*errors : nullptr);
  if (!exact.empty()) report.notes.push_back("Not stated, taken as exact: " + exact + ".");
  EvaluationOptions options = command.options;
  if (errors) {
    const ErrorsFile contents{errors->errors, errors->covariance, {{"method", "five steps of a laser engraver"}}};
    options.files = {{"errors.toml", errors_text(*machine, contents, stated ? "errors.covariance.csv" : "")}};
    if (stated) options.files.emplace_back("errors.covariance.csv", covariance_text(*machine, contents));
  }
  return finish_evaluation(report, options);
}

}  // namespace

void add_evaluate_linkage(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<LinkageCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "linkage", "Linkage parameters of a laser engraver with a swing head C1, A, from the five steps",
      "  mark                     which reading a row is: exit, width, l1 ... l6, circle or point\n"
      "  X_mm, Y_mm, Z_mm         commands: Z of exit and width, X of l3 and l5, all three of circle and point\n"
      "  width_um                 of a line (width)\n"
      "  height_mm                of l1 and l2 on the upright board, measured upwards from the table\n"
      "  mark_x_mm, mark_y_mm     place of l3, l5 (x), l4, l6 (y) and circle (both), frame of the table\n"
      "  turn_deg                 by which the focus has turned about the table's axis, seen from the board (circle)\n"
      "Leave a field empty if it does not belong to the row; leave out a column if all its fields are empty.",
      "  abbe evaluate linkage examples/laser_engraver/five-steps.csv --machine "
      "examples/machines/yin-engraver-u.machine.toml --exit-to-axis-mm 120 --board-mm 4 --u-x-um 2.77 --u-y-um 1.55 "
      "--u-z-um 3.55 --u-mark-um 2 --u-width-um 2",
      command->options);
  add_number(app, "--exit-to-axis-mm", Quantity::length, "mm", {0, 1e5}, command->exit_to_axis,
             "d: from the exit of the beam to the axis of A")
      ->required();
  add_number(app, "--board-mm", Quantity::length, "mm", {0, 1e5}, command->board, "h: thickness of the board")
      ->required();
  add_machine(*app, command->machine,
              "Machine file (*.machine.toml): its errors are found; -o writes them as errors.toml");
  app->add_option("--convention", command->convention,
                  "Without --machine: table-moves (default, X and Y carry the table) or head-moves")
      ->check(one_of({"table-moves", "head-moves"}));
  for (const AccuracyOption& option : kAccuracyOptions) {
    add_number(app, option.name, option.quantity, option.unit, {0, 1e6}, command->accuracy.*option.value,
               fmt::format("Standard uncertainty of {}", option.words));
  }
  app->callback([&line, app, command] {
    command->given = app->given_options();
    line.run = [command] { return run_linkage(*command); };
  });
}

}  // namespace abbe
