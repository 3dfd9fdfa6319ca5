#include "evaluate/evaluate.h"

#include "command.h"
#include "options.h"

namespace abbe {

void add_evaluate_command(CommandLine& line) {
  Subcommand* command =
      line.add("evaluate", "Compute figures of ISO 230 from readings: table, plot, report, tolerances",
               "  abbe evaluate positioning examples/evaluate/linear.csv\n"
               "  abbe evaluate positioning examples/evaluate/linear.csv --tolerance A_um=10 -o results/x\n"
               "  abbe evaluate diagonals examples/evaluate/diagonals.csv\n\n"
               "abbe evaluate KIND --help names the columns of the file.");
  command->require_subcommand(1);
  add_evaluate_positioning(*command, line);
  add_evaluate_diagonals(*command, line);
  add_evaluate_circular(*command, line);
  add_evaluate_rotation(*command, line);
  add_evaluate_straightness(*command, line);
  add_evaluate_squareness(*command, line);
  add_evaluate_contour(*command, line);
  add_evaluate_linkage(*command, line);
  add_evaluate_thermal(*command, line);
}

}  // namespace abbe
