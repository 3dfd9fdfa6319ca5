#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/pages/evaluation_files.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/comparison/compared_campaigns.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct CompareCommand {
  std::vector<std::string> campaigns, states, tolerances;
  std::string machine, output;
  double level_percent = 5;
  bool json = false;
};

int run_compare(const CompareCommand& command) {
  CompareRequest request = read_campaigns(command.campaigns, command.machine);
  for (const IdentifiedCampaign& campaign : request.campaigns) tell_distrusted(campaign.errors_file, campaign.errors);
  request.level = command.level_percent / 100;
  request.states = command.states;
  request.tolerances = command.tolerances;
  request.page = !command.output.empty();
  Progress progress("comparing campaigns");
  const ComparedCampaigns result = compare_campaigns(request, {.progress = progress.callback()});
  if (!command.output.empty()) {
    std::vector<std::pair<std::string, std::string>> files = evaluation_files(result.report);
    for (auto& file : comparison_files(result)) files.push_back(std::move(file));
    write_result_files(command.output, files);
  }
  if (command.json) {
    fmt::print("{}", json_text(evaluation_json(result.report)));
  } else {
    fmt::print("{}", evaluation_text(result.report));
    if (!command.output.empty()) fmt::print("\nresults in {}\n", command.output);
  }
  if (!result.is_judged()) tell("abbe: not all changes could be judged\n");
  return tell_outside(result.at_state, result.is_judged() && !result.report.exceeds_tolerance() ? kDone : kNegative);
}

}  // namespace

void add_compare_command(CommandLine& line) {
  auto command = std::make_shared<CompareCommand>();
  Subcommand* app = line.add(
      "compare", "Compare campaigns of one machine: which errors changed, by how much, and whether significantly",
      "  abbe compare examples/compare/march.errors.toml examples/compare/october.errors.toml --machine "
      "examples/machines/three-axis-mill.machine.toml\n"
      "  abbe compare examples/compare/march.errors.toml examples/compare/june.errors.toml "
      "examples/compare/october.errors.toml --machine examples/machines/three-axis-mill.machine.toml --tolerance "
      "V_max_C_A_um=20 -o results/compare\n"
      "\n"
      "Campaigns are given in chronological order. Each is compared with the first, and with the one before. Exit\n"
      "code 1 if nothing can be compared, the significance of a change is not known, or a tolerance is exceeded.\n"
      "Method and figures: docs/compare.md.");
  app->add_input_file("campaigns", command->campaigns,
                      "Results folders of abbe run, or errors files (*.errors.toml); two or more")
      ->required();
  add_machine(*app, command->machine, "Machine file of all campaigns (default: machine.toml of each results folder)");
  app->add_option("--level-percent", command->level_percent,
                  "Significance level: probability that any error of a pair is reported as changed if none has")
      ->check(in_range(1e-6, 50.0))
      ->capture_default_str();
  app->add_output_folder("-o,--output", command->output,
                         "Results folder to write: evaluation.json, maps of the change, plots, report.html");
  app->add_option("--tolerance", command->tolerances,
                  "Largest permitted amount of a figure, such as V_max_um=10; repeatable. Exit code 1 if exceeded")
      ->allow_extra_args(false);
  add_states(*app, command->states);
  app->add_flag("--json", command->json, "Print JSON for programs");
  app->callback([&line, command] { line.run = [command] { return run_compare(*command); }; });
}

}  // namespace abbe
