#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "options.h"

namespace abbe {
namespace {

struct CircularCommand {
  EvaluationOptions options;
  CircularTest test;
  std::string centre = "least-squares";
  double feed_mm = 0;
  bool length_unknown = false;
};

/// The same test with the readings of a file.
CircularTest circular_test(const CircularCommand& command, const std::string& file) {
  CircularTest test = command.test;
  test.readings = read_circular(file, test.nominal_radius, command.options.columns.mapping());
  test.centre = command.centre == "instrument"     ? CircularCentre::instrument
                : command.centre == "minimum-zone" ? CircularCentre::minimum_zone
                                                   : CircularCentre::least_squares;
  test.length_calibrated = !command.length_unknown;
  test.feed = command.feed_mm / 60;
  return test;
}

int run(const CircularCommand& command) {
  return run_evaluation(command.options, [&](const std::string& file) { return circular_test(command, file); });
}

}  // namespace

void add_evaluate_circular(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<CircularCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "circular",
      "Circular test (ISO 230-4) with a ball bar or grid encoder, and the causes of the deviations",
      "  direction   cw or ccw\n"
      "  angle_deg   with deviation_um (from the nominal radius) or radius_mm: ball bar\n"
      "  X_mm, Y_mm  or Y_mm, Z_mm or Z_mm, X_mm, from the centre of the nominal circle: grid encoder",
      "deviation_um=radial",
      "  abbe evaluate circular examples/evaluate/circular.csv --radius-mm 150 --u-reading-um 0.2 "
      "--skip-reversal-deg 6 "
      "--output results/circular --tolerance G_b_um=15\n"
      "  abbe evaluate circular examples/evaluate/circular.csv --radius-mm 150 --machine-temperature-degC "
      "23 --machine-expansion-um-per-m-K 10 --u-machine-temperature-K 0.3",
      command->options);
  add_customer_report_options(*app, command->options);
  add_number(app, "--radius-mm", Quantity::length, "mm", {0.001, 1e6}, command->test.nominal_radius, "Nominal radius")
      ->required();
  app->add_option("--plane", command->test.plane,
                  "Axes of a ball bar test, angles run from the first to the second (default XY)")
      ->check(one_of({"XY", "YZ", "ZX"}));
  app->add_option("--centre", command->centre, "Centre from which radii are measured (default least-squares)")
      ->check(one_of({"least-squares", "minimum-zone", "instrument"}));
  add_number(app, "--u-reading-um", Quantity::length, "um", {0, 1e6}, command->test.reading_uncertainty,
             "Standard uncertainty of one reading");
  add_number(app, "--u-length-um", Quantity::length, "um", {0, 1e6}, command->test.length_uncertainty,
             "Standard uncertainty of the length that all readings share (calibration, temperature)");
  app->add_flag("--length-not-calibrated", command->length_unknown,
                "The length is not calibrated: it shows the difference of the scales, not the scales");
  add_number(app, "--skip-reversal-deg", Quantity::angle, "deg", {0, 40}, command->test.reversal_margin,
             "Readings nearer than this to a reversal of an axis are left out of the fit of causes (default 0)");
  add_number(app, "--feed-mm-min", Quantity::length, "mm", {0.001, 1e6}, command->feed_mm,
             "Feed along the path: also gives the servo mismatch as a time constant");
  add_expansion(*app, circular_expansion_numbers(), command->test.expansion);
  app->callback([&line, command] { line.run = [command] { return run(*command); }; });
}

}  // namespace abbe
