#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/report/drawings/fit_surface.h"
#include "abbe/report/evaluations/fit_report.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
namespace {

struct FitCommand {
  EvaluationOptions options;
  std::vector<std::string> files;
  std::string shape, method = "least-squares", loss = "tukey", direction, residuals, unit;
  std::string radii;
  double half_angle = 0, sigma = 0;
  int threads = 0;
};

const std::map<std::string, ShapeKind>& shapes() {
  static const std::map<std::string, ShapeKind> all = {
      {"line2", ShapeKind::line2},       {"line", ShapeKind::line3},     {"plane", ShapeKind::plane},
      {"circle2", ShapeKind::circle2},   {"circle", ShapeKind::circle3}, {"sphere", ShapeKind::sphere},
      {"cylinder", ShapeKind::cylinder}, {"cone", ShapeKind::cone}};
  return all;
}

const std::map<std::string, FitMethod>& methods() {
  static const std::map<std::string, FitMethod> all = {{"least-squares", FitMethod::least_squares},
                                                       {"minimum-zone", FitMethod::minimum_zone},
                                                       {"circumscribed", FitMethod::circumscribed},
                                                       {"inscribed", FitMethod::inscribed},
                                                       {"robust", FitMethod::robust}};
  return all;
}

template <class Value>
std::vector<std::string> names(const std::map<std::string, Value>& all) {
  std::vector<std::string> result;
  for (const auto& [name, value] : all) result.push_back(name);
  return result;
}

/// Numbers with commas between them. @throws InputError
std::vector<double> numbers(const std::string& text, const std::string& option, const std::string& expected) {
  std::vector<double> values;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    values.push_back(0);
    if (parse_number(part, 0, values.back()) != NumberProblem::none) {
      throw InputError({.field = option}, fmt::format("'{}' is not a number", part.substr(0, 40)), expected);
    }
  }
  return values;
}

std::optional<Eigen::Vector3d> held_direction(const FitCommand& command) {
  if (command.direction.empty()) return {};
  const char* const expected = "three numbers, not all zero: 0,0,1";
  const std::vector<double> d = numbers(command.direction, "--fixed-direction", expected);
  if (d.size() != 3 || !(Eigen::Vector3d(d[0], d[1], d[2]).norm() > 0)) {
    throw InputError({.field = "--fixed-direction"},
                     fmt::format("'{}' is not a direction", command.direction.substr(0, 60)), expected);
  }
  return Eigen::Vector3d(d[0], d[1], d[2]);
}

std::vector<double> held_radii(const FitCommand& command, std::size_t count) {
  if (command.radii.empty()) return {};
  const std::string expected = count == 1 ? std::string("a number of mm above zero")
                                          : fmt::format("{} numbers of mm above zero, one per file", count);
  std::vector<double> radii = numbers(command.radii, "--fixed-radius-mm", expected);
  const bool positive = std::all_of(radii.begin(), radii.end(), [](double r) { return r > 0; });
  if (radii.size() != count || !positive) {
    throw InputError({.field = "--fixed-radius-mm"}, fmt::format("'{}' is not valid", command.radii.substr(0, 60)),
                     expected);
  }
  return radii;
}

struct Read {
  PointCloud cloud;
  std::string format, unit;
};

Read read_points(const FitCommand& command, const std::string& file, bool in_plane = false) {
  std::optional<FileLength> unit;
  if (!command.unit.empty()) unit = file_length_named(command.unit);
  const std::string extension = std::filesystem::path(with_ending(std::filesystem::path(file))).extension().string();
  if (extension == ".stl" || extension == ".STL") {
    MeshFile mesh = read_mesh(file, {unit, command.threads});
    return {{std::move(mesh.mesh.vertices), Eigen::Matrix3Xd(3, 0)}, mesh.format + ", corners", unit_words(mesh.unit)};
  }
  PointCloudFile read = read_point_cloud(file, {unit, {}, command.threads, in_plane});
  return {std::move(read.cloud), read.format, unit_words(read.unit)};
}

int run_coaxial(const FitCommand& command, FitRequest request) {
  if (command.method != "least-squares") {
    throw InputError({.field = "--method " + command.method}, "coaxial circles are fitted by least squares only",
                     "--method least-squares");
  }
  if (!command.residuals.empty()) {
    throw InputError({.field = "--residuals"}, "coaxial circles have none", "one shape");
  }
  std::vector<Eigen::Matrix3Xd> circles;
  std::vector<std::string> circle_names;
  for (const std::string& file : command.files) {
    Read read = read_points(command, file);
    circle_names.push_back(std::filesystem::path(file).filename().string());
    request.facts.emplace_back(circle_names.back(), read.format + ", " + read.unit);
    circles.push_back(std::move(read.cloud.points));
  }
  CoaxialOptions options;
  options.direction = held_direction(command);
  options.radii = held_radii(command, command.files.size());
  options.sigma = command.sigma;
  request.title = "Coaxial circles";
  const CoaxialCircles fit = coaxial_circles_fit(circles, options);
  EvaluationReport report = coaxial_report(request, fit, options, circle_names);
  const int code = finish_evaluation(report, command.options);
  return fit.ok() ? code : static_cast<int>(kNegative);
}

void check_request(const FitCommand& command, const FitRequest& request) {
  const ShapeKind kind = request.choice.kind;
  const FitConstraints& held = request.choice.options.constraints;
  const bool has_radius = kind >= ShapeKind::circle2 && kind != ShapeKind::cone;
  const std::string words = " of " + command.shape;
  if (held.radius && !has_radius) {
    throw InputError({.field = "--fixed-radius-mm"}, "there is no radius" + words + " to hold",
                     "it with a circle, sphere or cylinder");
  }
  if (held.direction && (kind == ShapeKind::sphere || kind == ShapeKind::circle2)) {
    throw InputError({.field = "--fixed-direction"}, "there is no direction" + words + " to hold",
                     "it with a line, plane, circle in space, cylinder or cone");
  }
  if (held.direction && kind == ShapeKind::line2 && held.direction->head<2>().norm() == 0) {
    throw InputError({.field = "--fixed-direction"}, "it has no part in x, y", "a direction in the plane");
  }
  if (held.half_angle && kind != ShapeKind::cone) {
    throw InputError({.field = "--fixed-half-angle-deg"}, "there is no half angle" + words + " to hold",
                     "it with a cone");
  }
  const bool one_sided =
      request.choice.method == FitMethod::circumscribed || request.choice.method == FitMethod::inscribed;
  const bool encloses = kind == ShapeKind::circle2 || kind == ShapeKind::sphere || kind == ShapeKind::cylinder;
  if (one_sided && (!encloses || held.radius)) {
    throw InputError({.field = "--method " + command.method},
                     "there is none" + words + (held.radius ? " with its radius held" : ""),
                     "circle2, sphere or cylinder with a free radius");
  }
}

int run_fit(const FitCommand& command) {
  FitRequest request;
  request.choice.options.sigma = command.sigma;
  request.choice.options.threads = command.threads;
  if (command.shape == "coaxial-circles") return run_coaxial(command, request);
  if (command.files.size() != 1) {
    throw InputError({.field = "FILE"}, fmt::format("there are {} files", command.files.size()),
                     "one; several are for --shape coaxial-circles");
  }
  request.choice.kind = shapes().at(command.shape);
  request.choice.method = methods().at(command.method);
  request.choice.robust.kind = command.loss == "huber"    ? RobustKind::huber
                               : command.loss == "welsch" ? RobustKind::welsch
                                                          : RobustKind::tukey;
  request.choice.options.constraints.direction = held_direction(command);
  const std::vector<double> radii = held_radii(command, 1);
  if (!radii.empty()) request.choice.options.constraints.radius = radii[0];
  if (command.half_angle > 0) request.choice.options.constraints.half_angle = command.half_angle;
  check_request(command, request);
  const std::string& file = command.files[0];
  const bool in_plane = request.choice.kind == ShapeKind::line2 || request.choice.kind == ShapeKind::circle2;
  Read read = read_points(command, file, in_plane);
  request.title = "Fit of " + std::filesystem::path(file).filename().string();
  request.facts = {{"file", read.format + ", " + read.unit}};
  Eigen::Matrix3Xd flat;
  std::string note;
  if (in_plane) {
    flat = read.cloud.points;
    const double low = flat.row(2).minCoeff(), high = flat.row(2).maxCoeff();
    if (low < high) note = fmt::format("Fitted in x and y: z, from {:g} to {:g} mm, was left out.", low, high);
    flat.row(2).setZero();
  }
  const Eigen::Matrix3Xd& points = in_plane ? flat : read.cloud.points;
  const ShapeFit fit = fit_shape(request.choice, points);
  std::vector<double> deviations;
  if (fit.ok()) {
    deviations.resize(fit.points);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      deviations[static_cast<std::size_t>(i)] = distance(fit.shape, points.col(i));
    }
  }
  EvaluationReport report = fit_report(request, fit, points, deviations);
  if (!note.empty()) report.notes.push_back(note);
  if (fit.ok() && !command.options.output.empty()) {
    std::vector<std::uint8_t> counted(deviations.size(), 1);
    for (std::size_t i = 0; i < fit.weights.size(); ++i) counted[i] = fit.weights[i] < 1e-3 ? 0 : 1;
    const nlohmann::json page = fit_page(fit.shape, points, deviations, counted, command.threads);
    if (!page.empty()) report.page = page;
  }
  const int code = finish_evaluation(report, command.options);
  if (fit.ok() && !command.residuals.empty()) {
    write_file_atomically(command.residuals, point_cloud_csv(read.cloud, deviations));
  }
  return fit.ok() ? code : static_cast<int>(kNegative);
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
      "Files: csv (x_mm,y_mm,z_mm), xyz, ply, obj, stl (corners). docs/fits.md says what the figures mean.");
  std::vector<std::string> known = names(shapes());
  known.emplace_back("coaxial-circles");
  app->add_input_file("file", command->files, "Points; one file per circle for coaxial circles")->required();
  app->add_option("--shape", command->shape,
                  "line2, circle2 (in x, y), line, plane, circle, sphere, cylinder, cone, coaxial-circles")
      ->required()
      ->check(one_of(known));
  app->add_option("--method", command->method,
                  "least-squares (default), minimum-zone, circumscribed, inscribed, robust (up to 30 % wrong points)")
      ->check(one_of(names(methods())));
  app->add_option("--loss", command->loss, "Loss of the robust method: tukey (default), huber, welsch")
      ->check(one_of({"tukey", "huber", "welsch"}));
  app->add_option("--fixed-radius-mm", command->radii, "Radius to hold fixed; one per file for coaxial circles: 12,30");
  app->add_option("--fixed-direction", command->direction, "Direction to hold fixed, of any length: 0,0,1");
  add_number(app, "--fixed-half-angle-deg", Quantity::angle, "deg", {0.001, 89.9}, command->half_angle,
             "Angle between axis and generator of a cone, to hold fixed");
  add_number(app, "--u-point-um", Quantity::length, "um", {0, 1e6}, command->sigma,
             "Standard uncertainty of a point across the shape; default: from the residuals");
  app->add_option("--unit", command->unit, "Unit of files that state none: mm (default), m, inch")
      ->check(one_of({"mm", "m", "inch"}));
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
