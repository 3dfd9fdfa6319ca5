#include <algorithm>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/circular_report.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
namespace {

struct CircularCommand {
  EvaluationOptions options;
  std::string plane, centre = "least-squares";
  double radius_mm = 0, reading_mm = 0, length_mm = 0, feed_mm = 0, reversal_rad = 0;
  bool length_unknown = false;
};

int run(const CircularCommand& command) {
  const CircularFile file = read_circular(command.options.file, command.radius_mm);
  CircularRequest request;
  request.file = command.options.file;
  request.circular.nominal_radius = request.diagnosis.nominal_radius = command.radius_mm;
  request.circular.centre = command.centre == "instrument"     ? CircularCentre::instrument
                            : command.centre == "minimum-zone" ? CircularCentre::minimum_zone
                                                               : CircularCentre::least_squares;
  request.circular.reading_uncertainty = command.reading_mm;
  request.circular.length_uncertainty = request.diagnosis.length_uncertainty = command.length_mm;
  request.diagnosis.length_calibrated = !command.length_unknown;
  request.diagnosis.reversal_margin = command.reversal_rad;
  request.feed_mm_s = command.feed_mm / 60;
  if (!file.plane.empty() && !command.plane.empty() && file.plane != command.plane) {
    throw InputError({.file = command.options.file, .field = "--plane " + command.plane},
                     "the coordinates of the file are those of " + file.plane, "--plane only for files of a ball bar");
  }
  if (!file.plane.empty()) request.plane = file.plane;
  if (!command.plane.empty()) request.plane = command.plane;
  EvaluationReport report = circular_report(request, file.paths, circular_deviations(file.paths, request.circular),
                                            circular_diagnosis(file.paths, request.diagnosis));
  const int code = finish_evaluation(report, command.options);
  const auto misses = [](const EvaluationFigure& figure) { return !figure.value && figure.symbol.starts_with("G_"); };
  return std::any_of(report.figures.begin(), report.figures.end(), misses) ? kNegative : code;
}

}  // namespace

void add_evaluate_circular(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<CircularCommand>();
  Subcommand* app =
      add_evaluation(evaluate, "circular",
                     "Circular test (ISO 230-4) with a ball bar or grid encoder, and the causes of the deviations",
                     "  direction   cw or ccw\n"
                     "  angle_deg   with deviation_um (from the nominal radius) or radius_mm: ball bar\n"
                     "  X_mm, Y_mm  or Y_mm, Z_mm or Z_mm, X_mm, from the centre of the nominal circle: grid encoder",
                     "  abbe evaluate circular examples/evaluate/circular.csv --radius-mm 150 --u-reading-um 0.2 "
                     "--skip-reversal-deg 6 "
                     "--output results/circular --tolerance G_b_um=15",
                     command->options);
  add_number(app, "--radius-mm", Quantity::length, "mm", {0.001, 1e6}, command->radius_mm, "Nominal radius")
      ->required();
  app->add_option("--plane", command->plane,
                  "Axes of a ball bar test, angles run from the first to the second (default XY)")
      ->check(one_of({"XY", "YZ", "ZX"}));
  app->add_option("--centre", command->centre, "Centre from which radii are measured (default least-squares)")
      ->check(one_of({"least-squares", "minimum-zone", "instrument"}));
  add_number(app, "--u-reading-um", Quantity::length, "um", {0, 1e6}, command->reading_mm,
             "Standard uncertainty of one reading");
  add_number(app, "--u-length-um", Quantity::length, "um", {0, 1e6}, command->length_mm,
             "Standard uncertainty of the length that all readings share (calibration, temperature)");
  app->add_flag("--length-not-calibrated", command->length_unknown,
                "The length is not calibrated: it shows the difference of the scales, not the scales");
  add_number(app, "--skip-reversal-deg", Quantity::angle, "deg", {0, 40}, command->reversal_rad,
             "Readings nearer than this to a reversal of an axis are left out of the fit of causes (default 0)");
  add_number(app, "--feed-mm-min", Quantity::length, "mm", {0.001, 1e6}, command->feed_mm,
             "Feed along the path: also gives the servo mismatch as a time constant");
  app->callback([&line, command] { line.run = [command] { return run(*command); }; });
}

}  // namespace abbe
