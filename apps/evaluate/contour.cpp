#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <regex>
#include <string>
#include <vector>

#include "abbe/formats/evaluations/section_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/shapes/curve_pieces.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/contour_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "machine_options.h"
#include "options.h"

namespace abbe {
namespace {

struct ContourCommand {
  EvaluationOptions options;
  std::string feature = "edge", surface = "left", curve, machine;
  SectionOptions sections;
  double surface_radius = 0;
  bool closed = false;
  std::vector<std::string> given;  ///< options of the command line: "--curve"

  bool has(const std::string& option) const { return std::find(given.begin(), given.end(), option) != given.end(); }
  /// @throws InputError if one of them was given
  void refuse(std::initializer_list<const char*> names, const std::string& why, const std::string& expected) const {
    for (const char* const name : names) {
      if (has(name)) throw InputError({.field = name}, why, expected);
    }
  }
};

/// "C2=12", "C30", "C2_deg": a command of an axis in a program or a column of one.
bool names_axis(const std::string& field) {
  static const std::regex axis("[A-EQ-RU-W][0-9]*([=_.+-].*)?");
  return std::regex_match(field, axis);
}

Curve commanded_curve(const ContourCommand& command) {
  if (!command.machine.empty()) return read_curve(command.curve, read_machine(command.machine));
  try {
    return read_curve(command.curve, Machine{});
  } catch (const InputError& error) {
    if (!names_axis(error.place().field)) throw;
    throw InputError(error.place(), "the command of an axis, and no machine is given",
                     "--machine with the machine file");
  }
}

void refuse_without_effect(const ContourCommand& command) {
  if (command.has("--curve")) {
    command.refuse({"--feature", "--surface", "--beam-tilt-deg", "--free-wall", "--surface-radius-mm", "--u-across-um",
                    "--u-height-um"},
                   "has no effect on points against a curve", "sections, without --curve");
    return;
  }
  command.refuse({"--closed", "--machine"}, "there is no curve to which it could apply", "with --curve");
  if (command.feature == "groove") {
    command.refuse({"--surface"}, "has no effect on a groove, which has both sides", "--feature edge, or without it");
  }
}

std::vector<SectionReadings> stated_sections(const ContourCommand& command) {
  std::vector<SectionReadings> sections = read_sections(command.options.file);
  if (std::all_of(sections.begin(), sections.end(), [](const SectionReadings& s) { return s.beam_tilt.has_value(); })) {
    command.refuse({"--beam-tilt-deg"}, "has no effect: the file states the beam's tilt of every section",
                   "a file without the column beam_tilt");
  }
  return sections;
}

/// The tolerance of the largest contour error as lines in the page's drawing.
void add_limits(EvaluationReport& report, const EvaluationOptions& options) {
  if (!report.page.is_object()) return;
  EvaluationReport judged = report;
  apply_tolerances(options.tolerances, judged);
  for (const EvaluationFigure& figure : judged.figures) {
    if (figure.symbol != "contour_max" || !figure.tolerance) continue;
    const double limit = 1e3 * *figure.tolerance;
    report.page["contour"]["limits_um"] = {-limit, limit};
  }
}

int run(const ContourCommand& command) {
  refuse_without_effect(command);
  const std::string title = "Contour error of " + std::filesystem::path(command.options.file).filename().string();
  if (command.has("--curve")) {
    const std::vector<CommandPiece> pieces =
        commanded_pieces(commanded_curve(command), command.curve, command.closed ? "--closed" : "");
    const PointCloudFile measured = read_point_cloud(command.options.file);
    EvaluationReport report = contour_points_report(
        title, pieces, evaluate_contour_points(pieces, measured.cloud.points, command.sections.origin_uncertainty));
    report.facts.front().second += fmt::format(", {}, {}", measured.format, unit_words(measured.unit));
    add_limits(report, command.options);
    return finish_evaluation(report, command.options);
  }
  SectionOptions options = command.sections;
  options.groove = command.feature == "groove";
  options.edge.surface = command.surface == "right" ? EdgeSide::right : EdgeSide::left;
  options.edge.surface_curvature = command.surface_radius == 0 ? 0 : 1 / command.surface_radius;
  const std::vector<SectionReadings> sections = stated_sections(command);
  const SectionsEvaluation evaluated = evaluate_sections(sections, options);
  EvaluationReport report = section_report(title, options, sections, evaluated);
  add_limits(report, command.options);
  const int code = finish_evaluation(report, command.options);
  // A mean that some of the sections have no part in is not the one that was asked for.
  return evaluated.refused > 0 ? std::max<int>(code, kNegative) : code;
}

}  // namespace

void add_evaluate_contour(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<ContourCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "contour", "Contour error of an engraved curve: from cross-sections of a line scanner, or from points",
      "  section                  name of the cross-section a row belongs to\n"
      "  across_mm, height_mm     point of the section: across the curve and out of the surface; origin on the\n"
      "                           commanded curve\n"
      "  along_mm                 where on the curve, optional\n"
      "  beam_tilt_deg            direction of the laser from the height towards across, optional\n"
      "With --curve: x_mm, y_mm, z_mm, points of the engraved curve in the frame of the commanded one; or a .ply,\n"
      ".obj or .xyz file. Moves on which the tool does not work are not part of that curve.",
      "  abbe evaluate contour examples/laser_engraver/sections.csv --u-height-um 2 --u-across-um 1\n"
      "  abbe evaluate contour examples/laser_engraver/engraved.csv --curve examples/laser_engraver/table-a4.csv "
      "--tolerance contour_max_um=50\n"
      "  abbe evaluate contour examples/laser_engraver/engraved.csv --curve examples/laser_engraver/regions.ngc "
      "--machine examples/machines/yin-engraver-u.machine.toml\n\n"
      "Exit code 1: a tolerance is exceeded, or a section could not be evaluated.",
      command->options);
  app->add_option("--feature", command->feature, "edge (default), or groove: the middle between its two edges")
      ->check(one_of({"edge", "groove"}));
  app->add_option("--surface", command->surface,
                  "Side of an edge on which the surface remains: left (default, at smaller `across`) or right")
      ->check(one_of({"left", "right"}));
  add_number(app, "--beam-tilt-deg", Quantity::angle, "deg", {-30, 30}, command->sections.edge.beam_tilt,
             "Direction of the laser where the file has none (default 0)");
  app->add_flag("--free-wall", command->sections.edge.free_wall,
                "The wall need not be parallel to the laser: found from the points");
  add_number(app, "--surface-radius-mm", Quantity::length, "mm", {-1e6, 1e6}, command->surface_radius,
             "Radius of the part's surface in the sections, positive if convex (default: flat)");
  add_number(app, "--u-across-um", Quantity::length, "um", {0, 1e6}, command->sections.edge.across_noise,
             "Standard uncertainty of a point along `across` (default: from the scatter)");
  add_number(app, "--u-height-um", Quantity::length, "um", {0, 1e6}, command->sections.edge.height_noise,
             "Standard uncertainty of a point along `height`");
  add_number(app, "--u-origin-um", Quantity::length, "um", {0, 1e6}, command->sections.origin_uncertainty,
             "Standard uncertainty of the position relative to the commanded curve, common to all sections or points");
  app->add_input_file("--curve", command->curve, "Commanded curve (as for abbe path): the file holds points instead");
  app->add_flag("--closed", command->closed, "The last point of the curve is followed by the first");
  add_machine(*app, command->machine,
              "Machine file (*.machine.toml) whose axes the curve sets beforehand; needed where it names them");
  app->callback([&line, app, command] {
    command->given = app->given_options();
    line.run = [command] { return run(*command); };
  });
}

}  // namespace abbe
