#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/history/machine_history.h"
#include "abbe/history/machine_trends.h"
#include "abbe/report/pages/evaluation_files.h"
#include "abbe/report/words/evaluation_text.h"
#include "command.h"
#include "errors_for_use.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct HistoryCommand {
  std::string history, machine, output;
  std::vector<std::string> campaigns, dates;
  int number = 0;
  TrendRequest trends;
  bool json = false;
};

int run_add(const HistoryCommand& command) {
  if (command.dates.size() != command.campaigns.size()) {
    throw InputError({.field = "--date"},
                     fmt::format("{} for {}", counted(command.dates.size(), "date", "dates"),
                                 counted(command.campaigns.size(), "campaign", "campaigns")),
                     "one date for each campaign, in their order");
  }
  std::vector<CampaignToKeep> campaigns;
  for (std::size_t i = 0; i < command.campaigns.size(); ++i) {
    campaigns.push_back(campaign_to_keep(command.campaigns[i], command.machine, date_of(command.dates[i])));
    tell_distrusted(campaigns.back().campaign.errors_file, campaigns.back().campaign.errors);
  }
  const std::vector<std::int64_t> numbers = add_to_history(command.history, campaigns);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    fmt::print("{}  {}  {}\n", numbers[i], date_text(campaigns[i].measured), campaigns[i].campaign.name);
  }
  return kDone;
}

int run_list(const HistoryCommand& command) {
  const std::vector<KeptCampaign> campaigns = read_history(command.history);
  fmt::print("{}", command.json ? json_text(history_json(campaigns)) : history_text(campaigns));
  return kDone;
}

int run_trends(const HistoryCommand& command) {
  TrendRequest request = command.trends;
  request.campaigns = read_history(command.history);
  request.page = !command.output.empty();
  Progress progress("comparing campaigns");
  const MachineTrends trends = find_trends(request, {.progress = progress.callback()});
  if (!command.output.empty()) write_result_files(command.output, evaluation_files(trends.report));
  if (command.json) {
    fmt::print("{}", json_text(evaluation_json(trends.report)));
  } else {
    fmt::print("{}", evaluation_text(trends.report));
    if (!command.output.empty()) fmt::print("\nresults in {}\n", command.output);
  }
  return tell_outside(trends.at_state, trends.is_in_control() ? kDone : kNegative);
}

int run_export(const HistoryCommand& command) {
  const KeptCampaign kept = campaign_of_history(command.history, command.number);
  write_result_files(command.output, campaign_files(kept));
  fmt::print("{} of {} in {}\n", kept.campaign.name, date_text(kept.measured), command.output);
  return kDone;
}

using HistoryRun = int (*)(const HistoryCommand&);

Subcommand* add_part(Subcommand& history, CommandLine& line, const std::shared_ptr<HistoryCommand>& command,
                     const char* name, const char* description, const char* example, HistoryRun run) {
  Subcommand* app = history.add_subcommand(name, description);
  app->footer(std::string("Example:\n") + example);
  app->add_option("history", command->history, "File of the history, such as mill.history")->required();
  app->callback([&line, command, run] { line.run = [command, run] { return run(*command); }; });
  return app;
}

}  // namespace

void add_history_command(CommandLine& line) {
  auto command = std::make_shared<HistoryCommand>();
  Subcommand* history = line.add(
      "history", "Keep the campaigns of a machine over the years: trends, control limits, when to measure again",
      "  abbe history add mill.history examples/compare/march.errors.toml examples/compare/june.errors.toml "
      "examples/compare/october.errors.toml --date 2026-03-02 --date 2026-06-01 --date 2026-10-05 --machine "
      "examples/machines/three-axis-mill.machine.toml\n"
      "  abbe history trends mill.history --limit-um 20 -o results/trends\n\n"
      "A history is one file. Several programs may add to it at a time. Method: docs/history.md.");
  history->require_subcommand(1);

  Subcommand* add =
      add_part(*history, line, command, "add", "Add campaigns to a history, all or none",
               "  abbe history add mill.history examples/compare/march.errors.toml examples/compare/june.errors.toml "
               "examples/compare/october.errors.toml --date 2026-03-02 --date 2026-06-01 --date 2026-10-05 --machine "
               "examples/machines/three-axis-mill.machine.toml",
               run_add);
  add->add_input_file("campaigns", command->campaigns,
                      "Results folders of abbe run, or errors files (*.errors.toml) with --machine")
      ->required();
  add->add_option("--date", command->dates,
                  "Date of the measurement, such as 2026-03-02; one for each campaign, in their order")
      ->expected(1)
      ->take_all()
      ->required();
  add_machine(*add, command->machine, "Machine file of all campaigns (default: machine.toml of each results folder)");

  Subcommand* list = add_part(*history, line, command, "list", "List the campaigns in chronological order",
                              "  abbe history list mill.history", run_list);
  list->add_flag("--json", command->json, "Print JSON for programs");

  Subcommand* trends = add_part(
      *history, line, command, "trends",
      "Follow every error: drift with uncertainty, unexpected values, when to measure again",
      "  abbe history trends mill.history\n"
      "  abbe history trends mill.history --limit-um 20 -o results/trends\n\n"
      "Exit code 1: an error of the last campaign is outside what the earlier campaigns predict, or the readings of a\n"
      "campaign do not cover the state at which errors are followed.",
      run_trends);
  add_number(
      trends, "--limit-um", Quantity::length, "um", {0, 1e6}, command->trends.limit_mm,
      "Tolerated change at the tool by one error since the last campaign: the output says when to measure again");
  trends->add_option("--last", command->trends.last, "Only the newest campaigns (default 26, the most)")
      ->check(in_range(2, 26));
  trends->add_output_folder("-o,--output", command->output,
                            "Results folder to write: evaluation.json, a plot per error, report.html");
  add_states(*trends, command->trends.states);
  trends->add_flag("--json", command->json, "Print JSON for programs");

  Subcommand* back = add_part(*history, line, command, "export", "Write a campaign as a results folder",
                              "  abbe history export mill.history --campaign 2 -o results/june", run_export);
  back->add_option("--campaign", command->number, "Number of the campaign, as abbe history list shows it")->required();
  back->add_output_folder("-o,--output", command->output,
                          "Results folder to write: machine.toml, errors.toml, its covariance, summary.json")
      ->required();
}

}  // namespace abbe
