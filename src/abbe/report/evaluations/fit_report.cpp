#include "abbe/report/evaluations/fit_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/vector_json.h"

namespace abbe {
namespace {

std::string method_words(FitMethod method) {
  switch (method) {
    case FitMethod::least_squares:
      return "least squares (Gauss)";
    case FitMethod::minimum_zone:
      return "minimum zone (Chebyshev)";
    case FitMethod::circumscribed:
      return "minimum circumscribed";
    case FitMethod::inscribed:
      return "maximum inscribed";
    case FitMethod::robust:
      break;
  }
  return "robust";
}

std::string point_name(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::circle2:
    case ShapeKind::circle3:
    case ShapeKind::sphere:
      return "centre";
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      return "point on the axis";
    case ShapeKind::plane:
      return "point on the plane";
    case ShapeKind::line2:
    case ShapeKind::line3:
      break;
  }
  return "point on the line";
}

bool in_plane(ShapeKind kind) { return kind == ShapeKind::line2 || kind == ShapeKind::circle2; }

void add_parameters(EvaluationReport& report, const FitRequest& request, const ShapeFit& fit) {
  const ShapeKind kind = request.choice.kind;
  const Shape& shape = fit.shape;
  const char* const axes[] = {"x", "y", "z"};
  for (int k = 0; k < (in_plane(kind) ? 2 : 3); ++k) {
    report.figures.push_back(length_figure(axes[k], point_name(kind) + ", " + axes[k], shape.point[k],
                                           fit.has_covariance ? fit.covariance(k, k) : 0));
  }
  if (kind != ShapeKind::sphere && kind != ShapeKind::circle2) {
    add_direction(report, shape.direction,
                  fit.has_covariance ? Eigen::Matrix3d(fit.covariance.block<3, 3>(3, 3)) : Eigen::Matrix3d::Zero());
    if (in_plane(kind)) report.figures.pop_back();
  }
  if (kind >= ShapeKind::circle2) {
    const double variance = fit.has_covariance ? fit.covariance(6, 6) : 0;
    report.figures.push_back(
        length_figure("radius", kind == ShapeKind::cone ? "radius at that point" : "radius", shape.radius, variance));
    if (kind != ShapeKind::cone) {
      report.figures.push_back(length_figure("diameter", "diameter", 2 * shape.radius, 4 * variance));
    }
  }
  if (kind == ShapeKind::cone) {
    EvaluationFigure angle;
    angle.symbol = "half_angle";
    angle.name = "angle between axis and generator";
    angle.quantity = Quantity::angle;
    angle.unit = "deg";
    angle.decimals = 6;
    angle.value = shape.half_angle;
    if (fit.has_covariance && fit.half_angle_uncertainty() > 0) angle.uncertainty = 2 * fit.half_angle_uncertainty();
    report.figures.push_back(angle);
  }
}

void add_deviations(EvaluationReport& report, const FitRequest& request, const ShapeFit& fit) {
  const bool tube = request.choice.kind == ShapeKind::line3 || request.choice.kind == ShapeKind::circle3;
  const std::string form = form_name(request.choice.kind), what = form.empty() ? "form deviation" : form + " deviation";
  report.figures.push_back(
      deviation_figure("form", what + (tube ? ", diameter of the tube" : ", peak to valley"), fit.form));
  if (!tube) {
    report.figures.push_back(deviation_figure("peak", what + ", peak", fit.largest));
    report.figures.push_back(deviation_figure("valley", what + ", valley", -fit.smallest));
  }
  report.figures.push_back(deviation_figure(
      "rms", request.choice.method == FitMethod::robust ? "root mean square, weighted" : "root mean square", fit.rms));
}

void add_contacts(EvaluationReport& report, const FitRequest& request, const ShapeFit& fit, const FitPoints& points,
                  const std::vector<double>& deviations) {
  const bool touch = !fit.contacts.empty();
  EvaluationTable table;
  table.caption = touch ? "points that touch" : "farthest points";
  table.headers = {"number", "x in mm", "y in mm", "z in mm", "deviation in \xC2\xB5m"};
  if (touch) table.headers.emplace_back("share");
  std::vector<std::size_t> which = fit.contacts;
  if (!touch) which = {fit.largest_at, fit.smallest_at};
  if (!touch && (request.choice.kind == ShapeKind::line3 || request.choice.kind == ShapeKind::circle3)) which.resize(1);
  std::string numbers;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < which.size(); ++k) {
    const Eigen::Vector3d p = points.col(static_cast<Eigen::Index>(which[k]));
    const double d = deviations[which[k]];
    numbers += fmt::format("{}{} ({:+.3f} \xC2\xB5m)", numbers.empty() ? "" : ", ", which[k] + 1, 1e3 * d);
    table.rows.push_back({fmt::format("{}", which[k] + 1), fmt::format("{:.6f}", p.x()), fmt::format("{:.6f}", p.y()),
                          fmt::format("{:.6f}", p.z()), fmt::format("{:.3f}", 1e3 * d)});
    nlohmann::ordered_json entry = {{"number", which[k] + 1}, {"point_mm", vector_json(p)}, {"deviation_um", 1e3 * d}};
    if (touch) {
      table.rows.back().push_back(fmt::format("{:.3f}", fit.multipliers[k]));
      entry["share"] = fit.multipliers[k];
    }
    list.push_back(std::move(entry));
  }
  report.facts.emplace_back(table.caption, numbers);
  report.tables.push_back(std::move(table));
  report.details[touch ? "touching" : "farthest"] = std::move(list);
}

void add_details(EvaluationReport& report, const FitRequest& request, const ShapeFit& fit) {
  nlohmann::ordered_json& d = report.details;
  d["points"] = fit.points;
  d["free_parameters"] = fit.parameters;
  d["degrees_of_freedom"] = fit.degrees_of_freedom;
  d["iterations"] = fit.iterations;
  d["point_mm"] = vector_json(fit.shape.point);
  d["direction"] = vector_json(fit.shape.direction);
  if (request.choice.kind >= ShapeKind::circle2) d["radius_mm"] = fit.shape.radius;
  if (request.choice.kind == ShapeKind::cone) {
    d["half_angle_rad"] = fit.shape.half_angle;
    d["apex_mm"] = vector_json(fit.shape.apex());
  }
  if (request.choice.method == FitMethod::robust) d["rejected"] = fit.rejected;
  if (!fit.has_covariance) return;
  d["sigma_um"] = 1e3 * fit.sigma;
  d["direction_uncertainty_urad"] = 1e6 * fit.direction_uncertainty();
  d["covariance_of"] = {"x_mm",        "y_mm",        "z_mm",      "direction_x",
                        "direction_y", "direction_z", "radius_mm", "half_angle_rad"};
  for (int i = 0; i < 8; ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (int j = 0; j < 8; ++j) row.push_back(fit.covariance(i, j));
    d["covariance"].push_back(std::move(row));
  }
}

void add_notes(EvaluationReport& report, const FitRequest& request, const ShapeFit& fit) {
  const FitConstraints& held = request.choice.options.constraints;
  const bool extreme = request.choice.method != FitMethod::least_squares && request.choice.method != FitMethod::robust;
  if (held.radius || held.direction || held.half_angle) {
    std::string text;
    const auto add = [&text](const char* what) { text += (text.empty() ? "" : ", ") + std::string(what); };
    if (held.radius) add("radius");
    if (held.direction) add("direction");
    if (held.half_angle) add("half angle");
    report.notes.push_back("Held at the value given: " + text + ".");
  }
  if (!fit.ok()) return;
  if (!fit.has_covariance) {
    report.notes.emplace_back(extreme ? "No uncertainty of a point was stated (--u-point-um): the parameters have none."
                                      : "As many points as parameters and no uncertainty of a point stated "
                                        "(--u-point-um): the parameters have none.");
  } else if (request.choice.options.sigma > 0) {
    report.notes.push_back(fmt::format(
        "Uncertainties from {:.3g} \xC2\xB5m of each point, errors of the points independent of each other{}.",
        1e3 * fit.sigma, extreme ? "; to first order, the points that touch staying the same" : ""));
  } else {
    report.notes.push_back(
        fmt::format("Uncertainties from the scatter of the points, {:.3g} \xC2\xB5m, as if their errors were "
                    "independent of each other: form deviation, and errors common to many points, do not average out.",
                    1e3 * fit.sigma));
  }
  if (extreme && fit.contacts.empty()) {
    report.notes.emplace_back(
        "The points lie on the shape to rounding: no point decides it, the least-squares shape is given.");
  }
  if (!fit.rivals.empty()) {
    const ShapeRival& next = fit.rivals.front();
    const std::string what = request.choice.method == FitMethod::robust
                                 ? fmt::format("with {:.0f} % of the points near it", 100 * next.share)
                             : request.choice.method == FitMethod::minimum_zone
                                 ? fmt::format("with a form deviation of {:.6g} \xC2\xB5m", 1e3 * next.form)
                                 : fmt::format("of radius {:.6f} mm", next.shape.radius);
    const Eigen::Vector3d& at = next.shape.point;
    report.notes.push_back(
        fmt::format("{} other shape{} the best among {} neighbours; the next one, {}, has its point at ({:.4f}, "
                    "{:.4f}, {:.4f}) mm.",
                    fit.rivals.size(), fit.rivals.size() == 1 ? " is" : "s are",
                    fit.rivals.size() == 1 ? "its" : "their", what, at.x(), at.y(), at.z()));
  }
  if (request.choice.method == FitMethod::robust) {
    report.notes.push_back(
        fmt::format("{} of {} points were left out (weight below 0.001); form, peak and valley are "
                    "those of the others.",
                    fit.rejected, fit.points));
  }
}

}  // namespace

std::string form_name(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::line2:
    case ShapeKind::line3:
      return "straightness";
    case ShapeKind::plane:
      return "flatness";
    case ShapeKind::circle2:
      return "roundness";
    case ShapeKind::cylinder:
      return "cylindricity";
    default:
      return "";
  }
}

EvaluationFigure length_figure(const std::string& symbol, const std::string& name, double value, double variance) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = name;
  figure.unit = "mm";
  figure.decimals = 6;
  figure.value = value;
  if (variance > 0) figure.uncertainty = 2 * std::sqrt(variance);
  return figure;
}

EvaluationFigure deviation_figure(const std::string& symbol, const std::string& name, double value) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = name;
  figure.decimals = 3;
  figure.value = value;
  return figure;
}

void add_direction(EvaluationReport& report, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance) {
  const char* const axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    EvaluationFigure figure;
    figure.symbol = std::string("direction_") + axes[k];
    figure.name = std::string("direction, ") + axes[k];
    figure.quantity = Quantity::dimensionless;
    figure.unit = "";
    figure.decimals = 9;
    figure.value = direction[k];
    if (covariance(k, k) > 0) figure.uncertainty = 2 * std::sqrt(covariance(k, k));
    report.figures.push_back(figure);
  }
}

EvaluationReport fit_report(const FitRequest& request, const ShapeFit& fit, const FitPoints& points,
                            const std::vector<double>& deviations) {
  EvaluationReport report;
  report.kind = "fit";
  report.title = request.title;
  report.standard = method_words(request.choice.method);
  report.facts = request.facts;
  report.facts.insert(report.facts.begin(), {"shape", shape_name(request.choice.kind)});
  report.facts.emplace_back("points", fmt::format("{}", fit.points));
  report.facts.emplace_back("free parameters", fmt::format("{}", fit.parameters));
  report.facts.emplace_back("status", fit_status_name(fit.status));
  report.details = {{"shape", shape_name(request.choice.kind)}, {"status", fit_status_name(fit.status)}};
  add_parameters(report, request, fit);
  add_deviations(report, request, fit);
  add_notes(report, request, fit);
  if (!fit.ok()) {
    // What was reached counts for nothing.
    for (EvaluationFigure& figure : report.figures) {
      figure.value.reset();
      figure.uncertainty.reset();
      figure.missing = fit_status_name(fit.status);
    }
    report.details["reason"] = fit.reason;
    report.notes.push_back(std::string("There is no answer, ") + fit_status_name(fit.status) + ": " + fit.reason + ".");
    return report;
  }
  add_details(report, request, fit);
  add_contacts(report, request, fit, points, deviations);
  report.plots.push_back(fit_plot(request, fit, points, deviations, fit.contacts));
  return report;
}

EvaluationReport coaxial_report(const FitRequest& request, const CoaxialCircles& fit, const CoaxialOptions& options,
                                const std::vector<std::string>& names) {
  EvaluationReport report;
  report.kind = "fit";
  report.title = request.title;
  report.standard = method_words(FitMethod::least_squares);
  report.facts = request.facts;
  report.facts.insert(report.facts.begin(), {"shape", "coaxial circles"});
  report.facts.emplace_back("points", fmt::format("{}", fit.points));
  report.facts.emplace_back("status", fit_status_name(fit.status));
  report.details = {{"shape", "coaxial-circles"}, {"status", fit_status_name(fit.status)}};
  if (!fit.ok()) {
    EvaluationFigure figure = length_figure("x", "point on the axis, x", 0, 0);
    figure.value.reset();
    figure.missing = fit_status_name(fit.status);
    report.figures.push_back(figure);
    report.details["reason"] = fit.reason;
    report.notes.push_back(std::string("There is no answer, ") + fit_status_name(fit.status) + ": " + fit.reason + ".");
    return report;
  }
  const auto variance = [&fit](std::size_t k) {
    const auto i = static_cast<Eigen::Index>(k);
    return fit.has_covariance ? fit.covariance(i, i) : 0;
  };
  const char* const axes[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    report.figures.push_back(length_figure(axes[k], std::string("point on the axis, ") + axes[k],
                                           fit.point[static_cast<Eigen::Index>(k)], variance(k)));
  }
  add_direction(report, fit.direction,
                fit.has_covariance ? Eigen::Matrix3d(fit.covariance.block<3, 3>(3, 3)) : Eigen::Matrix3d::Zero());
  const std::size_t m = names.size();
  for (std::size_t c = 0; c < m; ++c) {
    const std::string number = std::to_string(c + 1);
    report.figures.push_back(
        length_figure("height_" + number, "height of " + names[c], fit.heights[c], variance(6 + c)));
    report.figures.push_back(
        length_figure("radius_" + number, "radius of " + names[c], fit.radii[c], variance(6 + m + c)));
    report.figures.push_back(deviation_figure("form_" + number, "tube about " + names[c] + ", diameter", fit.form[c]));
    nlohmann::ordered_json circle = {{"name", names[c]},
                                     {"centre_mm", vector_json(fit.centre(c))},
                                     {"height_mm", fit.heights[c]},
                                     {"radius_mm", fit.radii[c]}};
    report.details["circles"].push_back(std::move(circle));
  }
  report.figures.push_back(deviation_figure("rms", "root mean square", fit.rms));
  report.details["point_mm"] = vector_json(fit.point);
  report.details["direction"] = vector_json(fit.direction);
  report.details["degrees_of_freedom"] = fit.degrees_of_freedom;
  if (fit.has_covariance) {
    report.details["sigma_um"] = 1e3 * fit.sigma;
    for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i) {
      nlohmann::ordered_json row = nlohmann::ordered_json::array();
      for (Eigen::Index j = 0; j < fit.covariance.cols(); ++j) row.push_back(fit.covariance(i, j));
      report.details["covariance"].push_back(std::move(row));
    }
    report.notes.push_back(fmt::format("Uncertainties from {}, {:.3g} \xC2\xB5m, errors of the points independent.",
                                       options.sigma > 0 ? "each point's" : "the scatter of the points",
                                       1e3 * fit.sigma));
  }
  return report;
}

}  // namespace abbe
