#include <algorithm>
#include <filesystem>
#include <numbers>

#include "abbe/formats/curve_file.h"
#include "abbe/formats/input_error.h"
#include "evaluate/contour_report.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"

namespace abbe {
namespace {

struct ContourCommand {
  EvaluationOptions options;
  std::string feature = "edge", surface = "left", curve;
  double beam_tilt = 0, surface_radius = 0, across = 0, height = 0, origin = 0;
  bool free_wall = false, closed = false;
};

int run(const ContourCommand& command) {
  ContourRequest request;
  request.title = "Contour error of " + std::filesystem::path(command.options.file).filename().string();
  request.groove = command.feature == "groove";
  request.edge.surface = command.surface == "right" ? EdgeSide::right : EdgeSide::left;
  request.edge.beam_tilt = command.beam_tilt;
  request.edge.free_wall = command.free_wall;
  request.edge.surface_curvature = command.surface_radius == 0 ? 0 : 1 / command.surface_radius;
  request.edge.across_noise = command.across;
  request.edge.height_noise = command.height;
  request.origin_uncertainty = command.origin;
  if (!command.curve.empty()) {
    const Curve curve = read_curve(command.curve, Machine{});
    if (curve.points.size() < 2) throw InputError({.file = command.curve}, "a single point", "a curve of two or more");
    for (std::size_t i = 0; i + (command.closed ? 0 : 1) < curve.points.size(); ++i) {
      if ((curve.points[(i + 1) % curve.points.size()].point - curve.points[i].point).norm() < 1e-9) {
        throw InputError({.file = command.curve}, "point " + std::to_string(i + 1) + " and the next one coincide",
                         "neighbours apart from each other");
      }
    }
    EvaluationReport report =
        contour_points_report(request, curve, command.closed, read_contour_points(command.options.file));
    return finish_evaluation(report, command.options);
  }
  if (command.closed) throw InputError({.field = "--closed"}, "there is no curve to be closed", "with --curve");
  std::size_t refused = 0;
  EvaluationReport report = section_report(request, read_sections(command.options.file), refused);
  const int code = finish_evaluation(report, command.options);
  // A mean that some of the sections have no part in is not the one that was asked for.
  return refused > 0 ? std::max<int>(code, kNegative) : code;
}

}  // namespace

void add_evaluate_contour(CLI::App& evaluate, CommandLine& line) {
  auto command = std::make_shared<ContourCommand>();
  CLI::App* app = add_evaluation(
      evaluate, "contour", "Contour error of an engraved curve: from cross-sections of a line scanner, or from points",
      "  section                  name of the cross-section a row belongs to\n"
      "  across_mm, height_mm     point of the section: across the curve and out of the surface; origin on the\n"
      "                           commanded curve\n"
      "  along_mm                 where on the curve, optional\n"
      "  beam_tilt_deg            direction of the laser from the height towards across, optional\n"
      "With --curve: x_mm, y_mm, z_mm, points of the engraved curve in the frame of the commanded one.",
      "  abbe evaluate contour examples/laser_engraver/sections.csv --u-height-um 2 --u-across-um 1\n"
      "  abbe evaluate contour examples/laser_engraver/engraved.csv --curve examples/laser_engraver/table-a4.csv "
      "--tolerance contour_max_um=50\n\n"
      "Exit code 1: a tolerance is exceeded, or a section could not be evaluated.",
      command->options);
  app->add_option("--feature", command->feature, "edge (default), or groove: the middle between its two edges")
      ->check(CLI::IsMember({"edge", "groove"}));
  app->add_option("--surface", command->surface,
                  "Side on which the surface has remained beside an edge: left (default: "
                  "at smaller `across`) or right")
      ->check(CLI::IsMember({"left", "right"}));
  add_number(app, "--beam-tilt-deg", Quantity::angle, "deg", {-30, 30}, command->beam_tilt,
             "Direction of the laser where the file has none (default 0)");
  app->add_flag("--free-wall", command->free_wall, "The wall need not be parallel to the laser: found from the points");
  add_number(app, "--surface-radius-mm", Quantity::length, "mm", {-1e6, 1e6}, command->surface_radius,
             "Radius of the part's surface in the sections, positive if convex (default: flat)");
  add_number(app, "--u-across-um", Quantity::length, "um", {0, 1e6}, command->across,
             "Standard uncertainty of a point along `across` (default: from the scatter)");
  add_number(app, "--u-height-um", Quantity::length, "um", {0, 1e6}, command->height,
             "Standard uncertainty of a point along `height`");
  add_number(app, "--u-origin-um", Quantity::length, "um", {0, 1e6}, command->origin,
             "Standard uncertainty, common to all sections, of their origins against the commanded curve");
  app->add_option("--curve", command->curve, "Commanded curve (as for abbe path): the file holds points instead");
  app->add_flag("--closed", command->closed, "The last point of the curve is followed by the first");
  app->callback([&line, command] { line.run = [command] { return run(*command); }; });
}

}  // namespace abbe
