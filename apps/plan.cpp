#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/planning/plan_page.h"
#include "abbe/study/planning/plan_text.h"
#include "abbe/study/planning/planning.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"

namespace abbe {
void add_plan_command(CommandLine& line) {
  struct Options {
    std::string study, output, plot, report;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command =
      line.add("plan", "Choose the readings that determine a machine's errors best",
               "  abbe plan examples/trunnion/trunnion.study.toml -o poses.csv --report readings.html");
  command->add_input_file("study", options->study, "Study file (*.study.toml) with tables [plan] and [identify]")
      ->required();
  command->add_output_file("-o,--output", options->output, "Readings to take, ordered for short travel (*.csv)");
  command->add_output_file("--svg", options->plot, "Plot of uncertainty against number of readings (*.svg)");
  command->add_output_file("--report", options->report,
                           "Page with the curve, the comparison with grids and the chosen poses (*.html)");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] {
    line.share([options](ProcessGroup* processes) -> int {
      const Study study = read_study(options->study);
      SharedWork work(processes, "", tell_sentence);
      const StudyPlan result = plan_study(study, work.job(Progress("planning").callback()));
      if (!work.is_first()) return kDone;
      const bool done = result.plan.status == PlanningStatus::done;
      if (done && !options->output.empty()) write_file_atomically(options->output, plan_csv(study, result));
      if (done && !options->plot.empty()) write_file_atomically(options->plot, plan_svg(study, result));
      if (done && !options->report.empty()) write_file_atomically(options->report, plan_page(study, result));
      if (options->json) {
        fmt::print("{}", json_text(plan_json(study, result)));
      } else {
        fmt::print("{}", study_plan_text(study, result));
        if (done && !options->output.empty()) fmt::print("\n{} written\n", options->output);
      }
      return done && !leaves_states_open(result) ? kDone : kNegative;
    });
  });
}

}  // namespace abbe
