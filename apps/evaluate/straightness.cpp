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

int run_straightness(const LineCommand& command) {
  return run_evaluation(command.options, [&](const std::string& file) {
    return StraightnessTest{read_straightness(file, command.options.columns.mapping()), command.line(),
                            command.squareness.reading_uncertainty};
  });
}

int run_squareness(const LineCommand& command) {
  return run_evaluation(command.options, [&](const std::string& file) {
    SquarenessTest test{read_squareness(file, command.options.columns.mapping()), command.squareness};
    test.options.reference = command.line();
    return test;
  });
}

void add_common_options(Subcommand* app, LineCommand& command) {
  add_customer_report_options(*app, command.options);
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
      "deviation_um=error",
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
      "deviation_um=error",
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
