#include <fmt/format.h>

#include "abbe/formats/machine/machine_file.h"
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
  bool convention_given = false;
};

LinkageTest linkage_test(const LinkageCommand& command, const std::string& file) {
  LinkageTest test;
  test.readings = read_linkage(file, command.options.columns.mapping());
  test.readings.exit_to_axis = command.exit_to_axis;
  test.readings.board_thickness = command.board;
  test.accuracy = command.accuracy;
  test.machine_file = command.machine;
  if (!command.machine.empty()) test.machine = read_machine(command.machine);
  if (command.convention_given) {
    test.convention =
        command.convention == "head-moves" ? LinkageConvention::head_moves : LinkageConvention::table_moves;
  }
  return test;
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
      "height_mm=h",
      "  abbe evaluate linkage examples/laser_engraver/five-steps.csv --machine "
      "examples/machines/yin-engraver-u.machine.toml --exit-to-axis-mm 120 --board-mm 4 --u-x-um 2.77 --u-y-um 1.55 "
      "--u-z-um 3.55 --u-mark-um 2 --u-width-um 2",
      command->options);
  add_customer_report_options(*app, command->options);
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
  for (const LinkageAccuracyName& name : linkage_accuracy_names()) {
    add_number(app, name.option, name.quantity, name.unit, {0, 1e6}, command->accuracy.*name.value,
               fmt::format("Standard uncertainty of {}", name.words));
  }
  app->callback([&line, app, command] {
    command->convention_given = app->count("--convention") > 0;
    line.run = [command] {
      return run_evaluation(command->options, [&](const std::string& file) { return linkage_test(*command, file); });
    };
  });
}

}  // namespace abbe
