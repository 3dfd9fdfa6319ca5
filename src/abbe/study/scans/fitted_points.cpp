#include "abbe/study/scans/fitted_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/file_name.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/fit_surface.h"
#include "abbe/report/evaluations/fit_report.h"
#include "abbe/report/words/evaluation_text.h"

namespace abbe {
namespace {

template <class Value>
std::string name_among(const std::map<std::string, Value>& all, Value wanted) {
  return std::find_if(all.begin(), all.end(), [wanted](const auto& one) { return one.second == wanted; })->first;
}

void check_held_direction(const std::optional<Eigen::Vector3d>& direction) {
  if (!direction || (direction->allFinite() && direction->norm() > 0)) return;
  throw InputError({.field = "--fixed-direction"},
                   fmt::format("'{},{},{}' is not a direction", direction->x(), direction->y(), direction->z()),
                   "three numbers, not all zero: 0,0,1");
}

/// @param count  how many there have to be
void check_held_radii(const std::vector<double>& radii, std::size_t count) {
  const auto is_valid = [](double radius) { return radius > 0 && std::isfinite(radius); };
  if (radii.size() == count && std::all_of(radii.begin(), radii.end(), is_valid)) return;
  throw InputError({.field = "--fixed-radius-mm"}, fmt::format("'{}' is not valid", fmt::join(radii, ",")),
                   count == 1 ? std::string("a number of mm above zero")
                              : fmt::format("{} numbers of mm above zero, one per file", count));
}

void check_choice(const FitChoice& choice) {
  const ShapeKind kind = choice.kind;
  const FitConstraints& held = choice.options.constraints;
  const bool has_radius = kind >= ShapeKind::circle2 && kind != ShapeKind::cone;
  const std::string words = " of " + name_among(shapes_by_name(), kind);
  if (held.radius && !has_radius) {
    throw InputError({.field = "--fixed-radius-mm"}, "there is no radius" + words + " to hold",
                     "it with a circle, sphere or cylinder");
  }
  if (held.radius) check_held_radii({*held.radius}, 1);
  if (held.direction && (kind == ShapeKind::sphere || kind == ShapeKind::circle2)) {
    throw InputError({.field = "--fixed-direction"}, "there is no direction" + words + " to hold",
                     "it with a line, plane, circle in space, cylinder or cone");
  }
  check_held_direction(held.direction);
  if (held.direction && kind == ShapeKind::line2 && held.direction->head<2>().norm() == 0) {
    throw InputError({.field = "--fixed-direction"}, "it has no part in x, y", "a direction in the plane");
  }
  if (held.half_angle && kind != ShapeKind::cone) {
    throw InputError({.field = "--fixed-half-angle-deg"}, "there is no half angle" + words + " to hold",
                     "it with a cone");
  }
  if (held.half_angle && !(*held.half_angle > 0 && *held.half_angle < 90 * kDegree)) {
    throw InputError({.field = "--fixed-half-angle-deg"}, fmt::format("{:g} is not valid", *held.half_angle / kDegree),
                     "more than 0 and less than 90 degrees");
  }
  const bool one_sided = choice.method == FitMethod::circumscribed || choice.method == FitMethod::inscribed;
  const bool encloses = kind == ShapeKind::circle2 || kind == ShapeKind::sphere || kind == ShapeKind::cylinder;
  if (one_sided && (!encloses || held.radius)) {
    throw InputError({.field = "--method " + name_among(fit_methods_by_name(), choice.method)},
                     "there is none" + words + (held.radius ? " with its radius held" : ""),
                     "circle2, sphere or cylinder with a free radius");
  }
}

}  // namespace

bool is_plane_shape(ShapeKind kind) { return kind == ShapeKind::line2 || kind == ShapeKind::circle2; }

const std::map<std::string, ShapeKind>& shapes_by_name() {
  static const std::map<std::string, ShapeKind> all = {
      {"line2", ShapeKind::line2},       {"line", ShapeKind::line3},     {"plane", ShapeKind::plane},
      {"circle2", ShapeKind::circle2},   {"circle", ShapeKind::circle3}, {"sphere", ShapeKind::sphere},
      {"cylinder", ShapeKind::cylinder}, {"cone", ShapeKind::cone}};
  return all;
}

const std::map<std::string, FitMethod>& fit_methods_by_name() {
  static const std::map<std::string, FitMethod> all = {{"least-squares", FitMethod::least_squares},
                                                       {"minimum-zone", FitMethod::minimum_zone},
                                                       {"circumscribed", FitMethod::circumscribed},
                                                       {"inscribed", FitMethod::inscribed},
                                                       {"robust", FitMethod::robust}};
  return all;
}

PointsToFit read_points_to_fit(const std::string& file, const PointCloudOptions& options) {
  if (file_extension(without_gz(with_ending(std::filesystem::path(file)))) == ".stl") {
    MeshFile mesh = read_mesh(file, {options.unit, options.threads});
    return {file,
            {std::move(mesh.mesh.vertices), Eigen::Matrix3Xd(3, 0)},
            mesh.format + ", corners, " + unit_words(mesh.unit)};
  }
  PointCloudFile read = read_point_cloud(file, options);
  std::string fact = cloud_words(read);
  return {file, std::move(read.cloud), std::move(fact), std::move(read.names)};
}

FittedShape fit_points(ShapeFitRequest request) {
  const FitChoice& choice = request.choice;
  check_choice(choice);
  FitRequest asked;
  asked.title = "Fit of " + file_name(request.points.file);
  asked.choice = choice;
  if (!request.points.fact.empty()) asked.facts = {{"file", request.points.fact}};
  FittedShape result;
  result.points = std::move(request.points.cloud);
  result.names = std::move(request.points.names);
  Eigen::Matrix3Xd flat;
  std::string note;
  if (is_plane_shape(choice.kind) && result.points.size() > 0) {
    flat = result.points.points;
    const double low = flat.row(2).minCoeff(), high = flat.row(2).maxCoeff();
    if (low < high) note = fmt::format("Fitted in x and y: z, from {:g} to {:g} mm, was left out.", low, high);
    flat.row(2).setZero();
  }
  const Eigen::Matrix3Xd& points = flat.cols() > 0 ? flat : result.points.points;
  result.fit = fit_shape(choice, points);
  if (result.is_ok()) {
    result.deviations.resize(result.fit.points);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      result.deviations[static_cast<std::size_t>(i)] = distance(result.fit.shape, points.col(i));
    }
  }
  result.report = fit_report(asked, result.fit, points, result.deviations);
  if (!note.empty()) result.report.notes.push_back(note);
  apply_tolerances(request.tolerances, result.report);
  if (result.is_ok() && request.page) {
    std::vector<std::uint8_t> counted(result.deviations.size(), 1);
    for (std::size_t i = 0; i < result.fit.weights.size(); ++i) counted[i] = result.fit.weights[i] < 1e-3 ? 0 : 1;
    const nlohmann::json page = fit_page(result.fit.shape, points, result.deviations, counted, choice.options.threads);
    if (!page.empty()) result.report.page = page;
  }
  return result;
}

std::string fitted_points_csv(const FittedShape& fitted) {
  return point_cloud_csv(fitted.points, fitted.deviations, fitted.names);
}

FittedCircles fit_circles(CirclesFitRequest request) {
  check_held_direction(request.options.direction);
  if (!request.options.radii.empty()) check_held_radii(request.options.radii, request.circles.size());
  FitRequest asked;
  asked.title = "Coaxial circles";
  asked.choice.options.sigma = request.options.sigma;
  std::vector<Eigen::Matrix3Xd> circles;
  std::vector<std::string> names;
  for (PointsToFit& circle : request.circles) {
    names.push_back(file_name(circle.file));
    if (!circle.fact.empty()) asked.facts.emplace_back(names.back(), circle.fact);
    circles.push_back(std::move(circle.cloud.points));
  }
  FittedCircles result;
  result.fit = coaxial_circles_fit(circles, request.options);
  result.report = coaxial_report(asked, result.fit, request.options, names);
  apply_tolerances(request.tolerances, result.report);
  return result;
}

}  // namespace abbe
