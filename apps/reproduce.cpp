#include "reproduce.h"

#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"
#include "options.h"

namespace abbe {

void add_reproduce_command(CommandLine& line) { add_reproduce_command(line, start_papers_program); }

void add_reproduce_command(CommandLine& line, const std::function<int(const ReproduceOptions&)>& run) {
  auto options = std::make_shared<ReproduceOptions>();
  Subcommand* command = line.add(
      "reproduce", "Recompute a published study: its figures beside ours, and where its equations are wrong",
      "  abbe reproduce wang\n"
      "  abbe reproduce wang --grids examples/wang/grids\n"
      "  abbe reproduce aguado -o results/aguado_paper\n\n"
      "Papers:\n"
      "  aguado  laser tracker on a machine w C' X' b Z t, strategies of identification (2014)\n"
      "  liu     cradle-type five-axis scanner: points, error terms, calibrations, virtual measurement (2021)\n"
      "  ma      six motions of a rotary table by a polygon prism (2021)\n"
      "  wang    36 measured errors of a grinder w C b X Z A Y B t, integrated error (2020)\n"
      "  yin     laser engraver measures its linkage and the place of its workpiece (2021)");
  command->add_option("paper", options->paper, "aguado, liu, ma, wang or yin")
      ->required()
      ->check(one_of({"aguado", "liu", "ma", "wang", "yin"}));
  command->add_output_folder("-o,--output", options->output,
                             "Results folder to write (tables, figures, report, study); default: print only");
  command->add_option("--grids", options->grids,
                      "wang: decouple the indications of this folder (X.csv, A.csv, ...) instead");
  command->add_option("--threads", options->threads, "Threads (0: all)")->check(in_range(0, 64));
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options, run] {
    line.run = [options, run]() -> int {
      if (options->paper != "wang" && !options->grids.empty()) {
        throw InputError({.field = "--grids"}, fmt::format("does not belong to {}", options->paper),
                         "abbe reproduce wang");
      }
      return run(*options);
    };
  });
}

}  // namespace abbe
