#include <fmt/format.h>

#include "abbe/formats/files/results_folder.h"
#include "abbe/study/results.h"
#include "abbe/study/run_study.h"
#include "abbe/study/summary.h"
#include "command.h"
#include "exit_code.h"
#include "options.h"
#include "progress.h"
#include "study_outcome.h"
#include "uncovered_poses.h"

namespace abbe {

void add_run_command(CommandLine& line) {
  struct Options {
    std::string study, output;
    bool accept_uncovered = false, accept_misfit = false, all_values = false, json = false;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command =
      line.add("run", "Run a whole study: simulate or read, identify, verify, map, report",
               "  abbe run examples/aguado/aguado.study.toml\n"
               "  abbe run examples/three_axis/level-and-autocollimator.study.toml -o results/level --json");
  command->add_input_file("study", options->study, "Study file (*.study.toml)")->required();
  command->add_output_folder("-o,--output", options->output, "Results folder (default: as in the study)");
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_flag("--all-values", options->all_values,
                    "Print every identified value, outlier and direction that the readings do not determine");
  command->add_flag("--json", options->json, "Print the summary as JSON for programs");
  command->add_flag("--accept-misfit", options->accept_misfit,
                    "End with exit code 0 and usable errors although the result is not to be trusted");
  command->callback([&line, options] {
    line.run = [options]() -> int {
      Study study = read_study(options->study);
      if (!options->output.empty()) study.output = options->output;
      check_results_folder(study.output);
      StepProgress progress;
      const StudyResult result =
          run_study(study, {.accept_misfit = options->accept_misfit,
                            .progress = [&](StudyStep step, std::size_t done, std::size_t total) {
                              progress.show(step_words(study, step), done, total);
                            }});
      progress.end();
      const std::string summary = write_results(study, result);
      if (options->json) {
        fmt::print("{}", summary);
      } else {
        fmt::print("{}", study_text(study, result, options->all_values ? nullptr : "--all-values, or summary.json"));
        fmt::print("\nresults in {}\n", study.output.string());
        if (study.report.page) fmt::print("report:    {}\n", (study.output / "report.html").string());
      }
      tell_distrust(study, result);
      int code = study_exit_code(study, result);
      if (result.map) {
        const int uncovered = tell_left_out(result.map->left_out(), options->accept_uncovered);
        if (code == kDone) code = uncovered;
      }
      return code;
    };
  });
}

}  // namespace abbe
