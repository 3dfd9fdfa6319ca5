#include <fmt/format.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/file_unit.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_list.h"
#include "abbe/study/scans/fitted_points.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
namespace {

constexpr const char* kOneRadius = "a number of mm above zero";

struct FitCommand {
  EvaluationOptions options;
  std::vector<std::string> files;
  std::string shape, method = "least-squares", loss = "tukey", direction, residuals, unit;
  std::string radii;
  double half_angle = 0, sigma = 0;
  int threads = 0;
};

template <class Value>
std::vector<std::string> names(const std::map<std::string, Value>& all) {
  std::vector<std::string> result;
  for (const auto& [name, value] : all) result.push_back(name);
  return result;
}

std::optional<Eigen::Vector3d> held_direction(const FitCommand& command) {
  if (command.direction.empty()) return {};
  return parse_direction(command.direction, "--fixed-direction");
}

std::vector<double> held_radii(const FitCommand& command, std::size_t count) {
  return parse_number_list(
      command.radii, "--fixed-radius-mm",
      count == 1 ? std::string(kOneRadius) : fmt::format("{} numbers of mm above zero, one per file", count));
}

PointCloudOptions reading_options(const FitCommand& command) {
  PointCloudOptions options;
  options.unit = file_length_named(command.unit);
  options.mapping = command.options.columns.mapping();
  options.threads = command.threads;
  return options;
}

int run_coaxial(const FitCommand& command) {
  if (command.method != "least-squares") {
    throw InputError({.field = "--method " + command.method}, "coaxial circles are fitted by least squares only",
                     "--method least-squares");
  }
  if (!command.residuals.empty()) {
    throw InputError({.field = "--residuals"}, "coaxial circles have none", "one shape");
  }
  CirclesFitRequest request;
  for (const std::string& file : command.files) {
    request.circles.push_back(read_points_to_fit(file, reading_options(command)));
  }
  request.options.direction = held_direction(command);
  request.options.radii = held_radii(command, command.files.size());
  request.options.sigma = command.sigma;
  request.tolerances = command.options.tolerances;
  const FittedCircles fitted = fit_circles(std::move(request));
  const int code = finish_evaluation(fitted.report, command.options);
  return fitted.is_ok() ? code : static_cast<int>(kNegative);
}

FitChoice choice_of(const FitCommand& command) {
  FitChoice choice;
  choice.kind = shapes_by_name().at(command.shape);
  choice.method = fit_methods_by_name().at(command.method);
  choice.robust.kind = command.loss == "huber"    ? RobustKind::huber
                       : command.loss == "welsch" ? RobustKind::welsch
                                                  : RobustKind::tukey;
  choice.options.sigma = command.sigma;
  choice.options.threads = command.threads;
  choice.options.constraints.direction = held_direction(command);
  const std::vector<double> radii = held_radii(command, 1);
  if (radii.size() > 1) {
    throw InputError({.field = "--fixed-radius-mm"}, fmt::format("'{}' is not valid", command.radii.substr(0, 60)),
                     kOneRadius);
  }
  if (!radii.empty()) choice.options.constraints.radius = radii[0];
  if (command.half_angle > 0) choice.options.constraints.half_angle = command.half_angle;
  return choice;
}

int run_fit(const FitCommand& command) {
  if (command.shape == "coaxial-circles") return run_coaxial(command);
  if (command.files.size() != 1) {
    throw InputError({.field = "FILE"}, fmt::format("there are {} files", command.files.size()),
                     "one; several are for --shape coaxial-circles");
  }
  ShapeFitRequest request;
  request.choice = choice_of(command);
  PointCloudOptions reading = reading_options(command);
  reading.in_plane = is_plane_shape(request.choice.kind);
  request.points = read_points_to_fit(command.files[0], reading);
  request.tolerances = command.options.tolerances;
  request.page = !command.options.output.empty();
  const FittedShape fitted = fit_points(std::move(request));
  const int code = finish_evaluation(fitted.report, command.options);
  if (!fitted.is_ok()) return kNegative;
  if (!command.residuals.empty()) write_file_atomically(command.residuals, fitted_points_csv(fitted));
  return code;
}

}  // namespace

void add_fit_command(CommandLine& line) {
  auto command = std::make_shared<FitCommand>();
  Subcommand* app = line.add(
      "fit", "Fit lines, planes, circles, spheres, cylinders and cones to points",
      "  abbe fit examples/fit/bore.csv --shape cylinder --method minimum-zone --u-point-um 0.5\n"
      "  abbe fit examples/fit/bore.csv --shape cylinder --method inscribed --tolerance form_um=20\n"
      "  abbe fit examples/fit/ring.csv --shape circle2 --residuals ring-residuals.csv -o results/ring\n"
      "  abbe fit examples/fit/scanned-ball.xyz --shape sphere --method robust --unit mm --json\n"
      "  abbe fit examples/fit/scanned-ball.xyz --shape sphere --method robust --fixed-radius-mm 12.7 --unit mm\n"
      "  abbe fit examples/fit/step-1.csv examples/fit/step-2.csv --shape coaxial-circles\n\n"
      "Files: csv (x_mm,y_mm,z_mm), xyz, ply, pcd, e57, obj, stl (corners). docs/fits.md says what the figures mean.");
  std::vector<std::string> known = names(shapes_by_name());
  known.emplace_back("coaxial-circles");
  app->add_input_file("file", command->files, "Points; one file per circle for coaxial circles")->required();
  app->add_option("--shape", command->shape,
                  "line2, circle2 (in x, y), line, plane, circle, sphere, cylinder, cone, coaxial-circles")
      ->required()
      ->check(one_of(known));
  app->add_option("--method", command->method,
                  "least-squares (default), minimum-zone, circumscribed, inscribed, robust (up to 30 % wrong points)")
      ->check(one_of(names(fit_methods_by_name())));
  app->add_option("--loss", command->loss, "Loss of the robust method: tukey (default), huber, welsch")
      ->check(one_of({"tukey", "huber", "welsch"}));
  app->add_option("--fixed-radius-mm", command->radii, "Radius to hold fixed; one per file for coaxial circles: 12,30");
  app->add_option("--fixed-direction", command->direction, "Direction to hold fixed, of any length: 0,0,1");
  add_number(app, "--fixed-half-angle-deg", Quantity::angle, "deg", {0.001, 89.9}, command->half_angle,
             "Angle between axis and generator of a cone, to hold fixed");
  add_number(app, "--u-point-um", Quantity::length, "um", {0, 1e6}, command->sigma,
             "Standard uncertainty of a point across the shape; default: from the residuals");
  app->add_option("--unit", command->unit, "Unit of files that state none: mm (default), m, inch")
      ->check(one_of(file_length_names()));
  add_columns(app, command->options.columns, "x_mm=East");
  app->add_output_file("--residuals", command->residuals, "CSV file to write: the points with their deviation_mm");
  app->add_output_folder("-o,--output", command->options.output,
                         "Results folder to write: evaluation.json, plot.svg, report.html; default: print only");
  app->add_option("--tolerance", command->options.tolerances,
                  "Largest permitted value of a figure, such as form_um=10; repeatable. Exit code 1 if exceeded")
      ->allow_extra_args(false);
  app->add_option("--threads", command->threads, "Number of threads; 0: all (default). Does not change the result")
      ->check(in_range(0, 256));
  app->add_flag("--json", command->options.json, "Print JSON for programs");
  app->callback([&line, command] { line.run = [command] { return run_fit(*command); }; });
}

}  // namespace abbe
