#include "command.h"
#include "evaluate/evaluate.h"
#include "options.h"

namespace abbe {
void add_evaluate_diagonals(Subcommand& evaluate, CommandLine& line) {
  auto options = std::make_shared<EvaluationOptions>();
  Subcommand* command = add_evaluation(
      evaluate, "diagonals", "Positioning along body or face diagonals (ISO 230-6)",
      "  diagonal        name of the diagonal, such as +X+Y+Z\n"
      "  direction       + or -: side from which the target was approached\n"
      "  target_mm       distance along the diagonal\n"
      "  deviation_um    actual minus target; or actual_mm\n"
      "  run             optional: number or name of the run",
      "deviation_um=error",
      "  abbe evaluate diagonals examples/evaluate/diagonals.csv --tolerance E_d_um=30 -o results/diagonals", *options);
  add_customer_report_options(*command, *options);
  command->callback([&line, options] {
    line.run = [options] {
      return run_evaluation(*options, [&](const std::string& file) {
        return DiagonalsTest{read_diagonals(file, options->columns.mapping())};
      });
    };
  });
}

}  // namespace abbe
