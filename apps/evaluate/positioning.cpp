#include "command.h"
#include "evaluate/evaluate.h"
#include "options.h"

namespace abbe {
namespace {

struct PositioningCommand {
  EvaluationOptions options;
  PositioningTest stated;  ///< contributions in the units of their options
  std::string temperatures;
};

/// The same test with the readings of a file.
PositioningTest positioning_test(const PositioningCommand& command, const std::string& file) {
  PositioningTest test = command.stated;
  test.readings = read_positioning(file, command.options.columns.mapping());
  if (!command.temperatures.empty()) test.temperatures = read_temperature_record(command.temperatures);
  for (const auto& contribution : positioning_contributions())
    (test.*contribution.axis).*contribution.value *= contribution.unit;
  return test;
}

int run(const PositioningCommand& command) {
  return run_evaluation(command.options, [&](const std::string& file) { return positioning_test(command, file); });
}

}  // namespace

void add_evaluate_positioning(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<PositioningCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "positioning", "Accuracy and repeatability of positioning of a linear or rotary axis (ISO 230-2)",
      "  direction       + or -: side from which the target was approached\n"
      "  target_mm       target position; target_deg for a rotary axis\n"
      "  deviation_um    actual minus target; or actual_mm. deviation_arcsec or actual_deg for a rotary axis\n"
      "  run             optional: number or name of the run\n"
      "  machine_degC, instrument_degC, time_min  optional: temperatures for a correction to 20 degC, and when",
      "deviation_um=error",
      "  abbe evaluate positioning examples/evaluate/linear.csv\n"
      "  abbe evaluate positioning examples/evaluate/rotary.csv --tolerance A_arcsec=20 -o results/c\n"
      "  abbe evaluate positioning examples/evaluate/linear.csv --instrument-um-per-m 0.6 --misalignment-mm 1 "
      "--environment-um 1.2\n"
      "  abbe evaluate positioning examples/evaluate/linear.csv --machine-temperature-degC 23.5 "
      "--machine-expansion-um-per-m-K 11.5 --u-machine-temperature-K 0.3 --u-machine-expansion-um-per-m-K 1\n"
      "  abbe evaluate positioning examples/customer_report/after.csv --before examples/customer_report/before.csv "
      "--instrument-um-per-m 0.4 --environment-um 0.3 --facts examples/customer_report/facts.toml --customer-report "
      "report.pdf",
      command->options);
  add_customer_report_options(*app, command->options);
  for (const auto& [option, axis, value, unit, words] : positioning_contributions())
    app->add_option(option, (command->stated.*axis).*value, words)
        ->check(in_range(0.0, 1e6))
        ->group("Measurement uncertainty");
  add_expansion(*app, positioning_expansion_numbers(), command->stated.expansion);
  app->add_input_file("--temperatures", command->temperatures, "CSV of machine_degC, instrument_degC over time_min")
      ->group("Correction to 20 degC");
  app->callback([&line, command] { line.run = [command] { return run(*command); }; });
}

}  // namespace abbe
