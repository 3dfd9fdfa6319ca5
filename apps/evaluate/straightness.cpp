#include <filesystem>
#include <memory>
#include <string>

#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/report/evaluations/straightness_report.h"
#include "abbe/verify/evaluations/squareness.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "options.h"

namespace abbe {
namespace {

struct LineCommand {
  EvaluationOptions options;
  std::string reference = "least-squares";
  SquarenessOptions squareness;

  ReferenceLine line() const {
    return reference == "minimum-zone" ? ReferenceLine::minimum_zone : ReferenceLine::least_squares;
  }
};

std::string file_name(const LineCommand& command) {
  return std::filesystem::path(command.options.file).filename().string();
}

int run_straightness(const LineCommand& command) {
  const LineReadings line = read_straightness(command.options.file);
  const double u = command.squareness.reading_uncertainty;
  const Straightness least = straightness(line.positions, line.deviations, ReferenceLine::least_squares, u);
  const Straightness zone = straightness(line.positions, line.deviations, ReferenceLine::minimum_zone, u);
  EvaluationReport report = straightness_report(file_name(command), line, least, zone, command.line(), u > 0);
  return finish_evaluation(report, command.options);
}

int run_squareness(const LineCommand& command) {
  const auto lines = read_squareness(command.options.file);
  SquarenessOptions options = command.squareness;
  options.reference = command.line();
  const Squareness result =
      squareness({lines[0].positions, lines[0].deviations}, {lines[1].positions, lines[1].deviations}, options);
  EvaluationReport report = squareness_report(file_name(command), lines, result, options);
  return finish_evaluation(report, command.options);
}

void add_common_options(Subcommand* app, LineCommand& command) {
  app->add_option("--reference", command.reference, "Reference line (default least-squares)")
      ->check(one_of({"least-squares", "minimum-zone"}));
  add_number(app, "--u-reading-um", Quantity::length, "um", {0, 1e6}, command.squareness.reading_uncertainty,
             "Standard uncertainty of one deviation");
}

}  // namespace

void add_evaluate_straightness(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<LineCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "straightness", "Straightness error (ISO 230-1) by least squares and by the minimum zone",
      "  position_mm    along the line; may repeat\n"
      "  deviation_um   across it",
      "  abbe evaluate straightness examples/evaluate/straightness.csv --u-reading-um 0.3 --reference minimum-zone "
      "--tolerance straightness_mz_um=5",
      command->options);
  add_common_options(app, *command);
  app->callback([&line, command] { line.run = [command] { return run_straightness(*command); }; });
}

void add_evaluate_squareness(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<LineCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "squareness", "Squareness error (ISO 230-1) between two lines read against a reference square",
      "  line           name of the line, such as X and Y: two of them\n"
      "  position_mm    along the line\n"
      "  deviation_um   across it, positive along the other line",
      "  abbe evaluate squareness examples/evaluate/squareness.csv --u-reading-um 0.3 --u-square-urad 1",
      command->options);
  add_common_options(app, *command);
  add_number(app, "--square-urad", Quantity::angle, "urad", {-1e5, 1e5}, command->squareness.artefact,
             "Angle of the reference square less 90 degrees (default 0)");
  add_number(app, "--u-square-urad", Quantity::angle, "urad", {0, 1e5}, command->squareness.artefact_uncertainty,
             "Standard uncertainty of that angle");
  app->callback([&line, command] { line.run = [command] { return run_squareness(*command); }; });
}

}  // namespace abbe
