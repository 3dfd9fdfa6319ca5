#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/report/drawings/thinned.h"
#include "abbe/report/evaluations/fit_report.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Number of each point along the plot, ascending: angle about the axis (rad) or distance along the points (mm).
std::vector<double> angles(const Shape& shape, const FitPoints& points) {
  const Vector3d d = shape.kind == ShapeKind::circle2 ? Vector3d(Vector3d::UnitZ()) : shape.direction;
  // 0 degrees is the direction across the axis that is nearest to x, or to y for an axis along x.
  const Vector3d towards = std::abs(d.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d first = (towards - towards.dot(d) * d).normalized(), second = d.cross(first);
  std::vector<double> result(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    const Vector3d q = points.col(i) - shape.point;
    result[static_cast<std::size_t>(i)] = std::atan2(q.dot(second), q.dot(first));
  }
  return result;
}

std::vector<double> along(const Shape& shape, const FitPoints& points, std::string& label) {
  Vector3d direction = shape.direction;
  label = "along the line in mm";
  if (shape.kind != ShapeKind::line2 && shape.kind != ShapeKind::line3) {
    const Vector3d extent = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
    int longest = 0;
    extent.maxCoeff(&longest);
    direction = Vector3d::Unit(longest);
    label = std::string(1, "xyz"[longest]) + " from the shape's point in mm";
  }
  std::vector<double> result(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    result[static_cast<std::size_t>(i)] = (points.col(i) - shape.point).dot(direction);
  }
  return result;
}

}  // namespace

EvaluationPlot fit_plot(const FitRequest& request, const ShapeFit& fit, const FitPoints& points,
                        const std::vector<double>& deviations, const std::vector<std::size_t>& contacts) {
  const Shape& shape = fit.shape;
  const bool round = shape.kind == ShapeKind::circle2 || shape.kind == ShapeKind::circle3 ||
                     shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone;
  const char* const value_label = "deviation in \xC2\xB5m";
  std::string label;
  const std::vector<double> place = round ? angles(shape, points) : along(shape, points, label);
  std::vector<std::size_t> order(place.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place[a] < place[b]; });
  std::vector<double> values;
  values.reserve(order.size());
  for (const std::size_t i : order) values.push_back(1e3 * deviations[i]);
  // A point that a robust fit left out would hide all others.
  const double slack = 1e-9 * (1 + 1e3 * fit.form);
  const double low = 1e3 * fit.smallest - slack, high = 1e3 * fit.largest + slack;
  const auto is_drawn = [&](double value) {
    return request.choice.method != FitMethod::robust || (value >= low && value <= high);
  };
  // `all`: no points yet, of the type that the plot takes; `line`: draws one at a deviation.
  const auto drawn = [&](auto& plot, auto all, const auto& line) {
    auto touching = all;
    for (const std::size_t k : thinned(values)) {
      if (is_drawn(values[k])) all.push_back({place[order[k]], values[k]});
    }
    for (const std::size_t k : contacts) touching.push_back({place[k], 1e3 * deviations[k]});
    plot.points(all, Marker::circle, {PlotColour::first}, "points");
    if (!touching.empty()) plot.points(touching, Marker::cross, {PlotColour::second, 2}, "touching");
    for (const double end : {fit.largest, fit.smallest}) line(1e3 * end, PlotStyle{PlotColour::soft, 1, true, 1});
    return EvaluationPlot{"plot", "", plot.picture()};
  };
  if (round) {
    PolarPlot plot(request.title, value_label);
    return drawn(plot, std::vector<PolarPoint>(),
                 [&](double value, const PlotStyle& style) { plot.circle(value, "", style); });
  }
  XyPlot plot(request.title, label, value_label);
  return drawn(plot, std::vector<PlotPoint>(),
               [&](double value, const PlotStyle& style) { plot.level(value, "", style); });
}

}  // namespace abbe
