#include <algorithm>
#include <initializer_list>

#include "abbe/formats/text/input_error.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "machine_options.h"
#include "options.h"

namespace abbe {
namespace {

struct ContourCommand {
  EvaluationOptions options;
  std::string feature = "edge", surface = "left", curve, machine;
  SectionOptions sections;
  double beam_tilt = 0, surface_radius = 0;
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

ContourPointsTest points_test(const ContourCommand& command, const std::string& file) {
  ContourPointsTest test;
  test.pieces = read_commanded_pieces(command.curve, command.machine, command.closed);
  PointCloudOptions reading;
  reading.mapping = command.options.columns.mapping();
  test.readings = read_point_cloud(file, reading);
  test.origin_uncertainty = command.sections.origin_uncertainty;
  return test;
}

SectionsTest sections_test(const ContourCommand& command, const std::string& file) {
  SectionsTest test;
  test.options = command.sections;
  test.options.groove = command.feature == "groove";
  test.options.edge.surface = command.surface == "right" ? EdgeSide::right : EdgeSide::left;
  test.options.edge.surface_curvature = command.surface_radius == 0 ? 0 : 1 / command.surface_radius;
  if (command.has("--beam-tilt-deg")) test.beam_tilt = command.beam_tilt;
  test.readings = read_sections(file, command.options.columns.mapping());
  return test;
}

int run(const ContourCommand& command) {
  refuse_without_effect(command);
  return run_evaluation(command.options, [&](const std::string& file) -> TestToEvaluate {
    if (command.has("--curve")) return points_test(command, file);
    return sections_test(command, file);
  });
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
      "height_mm=z",
      "  abbe evaluate contour examples/laser_engraver/sections.csv --u-height-um 2 --u-across-um 1\n"
      "  abbe evaluate contour examples/laser_engraver/engraved.csv --curve examples/laser_engraver/table-a4.csv "
      "--tolerance contour_max_um=50\n"
      "  abbe evaluate contour examples/laser_engraver/engraved.csv --curve examples/laser_engraver/regions.ngc "
      "--machine examples/machines/yin-engraver-u.machine.toml\n\n"
      "Exit code 1: a tolerance is exceeded, or a section could not be evaluated.",
      command->options);
  add_customer_report_options(*app, command->options);
  app->add_option("--feature", command->feature, "edge (default), or groove: the middle between its two edges")
      ->check(one_of({"edge", "groove"}));
  app->add_option("--surface", command->surface,
                  "Side of an edge on which the surface remains: left (default, at smaller `across`) or right")
      ->check(one_of({"left", "right"}));
  add_number(app, "--beam-tilt-deg", Quantity::angle, "deg", {-30, 30}, command->beam_tilt,
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
