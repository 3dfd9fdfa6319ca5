#include "evaluate/contour_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/report/svg_plot.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// What one section says.
struct SectionAnswer {
  EdgeFit first, second;  ///< the edge, or the left and the right one of a groove
  bool ok = false;
  std::string reason;
  double error = 0, error_uncertainty = 0;  ///< mm, signed, across the curve
  double width = 0;                         ///< mm, of a groove
};

SectionAnswer answer_of(const ContourRequest& request, const SectionReadings& section) {
  EdgeOptions options = request.edge;
  if (section.beam_tilt) options.beam_tilt = *section.beam_tilt;
  SectionAnswer answer;
  if (request.groove) {
    const GrooveFit groove = fit_groove(section.points, options);
    answer.first = groove.left;
    answer.second = groove.right;
    answer.ok = groove.ok();
    if (groove.left.status != EdgeStatus::ok) answer.reason = "left edge: " + groove.left.reason;
    if (groove.left.status == EdgeStatus::ok) answer.reason = "right edge: " + groove.right.reason;
    answer.error = groove.middle;
    answer.error_uncertainty = groove.middle_uncertainty;
    answer.width = groove.width;
  } else {
    answer.first = fit_edge(section.points, options);
    answer.ok = answer.first.status == EdgeStatus::ok;
    answer.reason = answer.first.reason;
    answer.error = answer.first.corner.x();
    answer.error_uncertainty = answer.first.corner_uncertainty();
  }
  return answer;
}

nlohmann::ordered_json edge_json(const EdgeFit& fit) {
  nlohmann::ordered_json json = {{"P1_mm", {fit.onset.x(), fit.onset.y()}},
                                 {"P2_mm", {fit.corner.x(), fit.corner.y()}},
                                 {"u_P2_across_um", 1e3 * fit.corner_uncertainty()},
                                 {"radius_um", 1e3 * fit.radius},
                                 {"u_radius_um", 1e3 * std::sqrt(fit.covariance(3, 3))},
                                 {"P1_P2_um", 1e3 * fit.rounding},
                                 {"u_P1_P2_um", 1e3 * fit.rounding_uncertainty},
                                 {"surface_slope_deg", fit.surface_slope / kDegree},
                                 {"wall_tilt_deg", fit.wall_tilt / kDegree},
                                 {"noise_um", 1e3 * fit.noise},
                                 {"turn_seen_deg", fit.turn_seen / kDegree},
                                 {"points_on_surface", fit.on_surface},
                                 {"points_on_rounding", fit.on_rounding},
                                 {"points_on_wall", fit.on_wall},
                                 {"rejected", fit.rejected}};
  json["circle_alone_meets_surface"] = fit.printed.circle_meets_surface;
  if (fit.printed.circle_meets_surface) json["circle_alone_P1_P2_um"] = 1e3 * fit.printed.distance;
  return json;
}

/// The fitted curve from the surface through the rounding down the wall.
std::vector<PlotPoint> curve_of(const EdgeFit& fit, double from, double to_depth, double mirror) {
  const double slope = mirror * fit.surface_slope, tilt = mirror * fit.wall_tilt;
  const Eigen::Vector2d corner(mirror * fit.corner.x(), fit.corner.y()), along(std::cos(slope), std::sin(slope));
  const Eigen::Vector2d inwards(along.y(), -along.x()), down(-std::sin(tilt), -std::cos(tilt));
  const double turn = std::numbers::pi / 2 + slope + tilt;
  const Eigen::Vector2d onset = corner - fit.rounding * along, centre = onset + fit.radius * inwards;
  std::vector<Eigen::Vector2d> points = {corner + (mirror * from - corner.x()) / along.x() * along};
  for (int i = 0; i <= 24; ++i) {
    const double a = turn * i / 24;
    points.push_back(centre - fit.radius * (std::cos(a) * inwards - std::sin(a) * along));
  }
  points.push_back(corner + down * std::max(fit.rounding, corner.y() - to_depth));
  std::vector<PlotPoint> result;
  for (const Eigen::Vector2d& p : points) result.push_back({1e3 * mirror * p.x(), 1e3 * p.y()});
  return result;
}

EvaluationPlot section_plot(const ContourRequest& request, const SectionReadings& section,
                            const SectionAnswer& answer) {
  XyPlot plot("Section " + section.name, "across the curve in \xC2\xB5m", "out of the surface in \xC2\xB5m");
  plot.keep_the_same_scale();
  const double lowest = section.points.row(1).minCoeff();
  // Around the corners: of the surface as much as the corner is wide.
  double from = answer.first.corner.x(), to = from;
  std::vector<const EdgeFit*> edges = {&answer.first};
  if (request.groove) edges.push_back(&answer.second);
  for (const EdgeFit* edge : edges) {
    const double reach = 4 * std::max(edge->rounding, 0.25 * (edge->corner.y() - lowest));
    from = std::min(from, edge->corner.x() - reach);
    to = std::max(to, edge->corner.x() + reach);
  }
  std::vector<PlotPoint> points;
  for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
    const double u = section.points(0, i);
    if (u >= from && u <= to) points.push_back({1e3 * u, 1e3 * section.points(1, i)});
  }
  plot.points(points, Marker::circle, {PlotColour::first, 1, false, 0.6}, "scanned");
  for (const EdgeFit* edge : edges) {
    const bool left = request.groove ? edge == edges.front() : request.edge.surface == EdgeSide::left;
    plot.line(curve_of(*edge, left ? from : to, lowest, left ? 1 : -1), {PlotColour::second, 2},
              edge == edges.front() ? "surface, rounding, wall" : "");
    plot.points({{1e3 * edge->onset.x(), 1e3 * edge->onset.y()}}, Marker::up, {PlotColour::third, 2},
                edge == edges.front() ? "P1" : "");
    plot.points({{1e3 * edge->corner.x(), 1e3 * edge->corner.y()}}, Marker::cross, {PlotColour::limit, 2},
                edge == edges.front() ? "P2" : "");
  }
  plot.points({{0, 0}}, Marker::circle, {PlotColour::ink, 2}, "commanded curve");
  return {"section", "The section with the largest contour error.", plot.svg()};
}

}  // namespace

EvaluationReport section_report(const ContourRequest& request, const std::vector<SectionReadings>& sections,
                                std::size_t& refused) {
  EvaluationReport report;
  report.kind = "contour";
  report.title = request.title;
  report.standard = "Contour error from cross-sections, after Yin et al., Machines 9 (2021) 237";
  EvaluationTable table{"Sections",
                        {"section", "along in mm", "contour error in \xC2\xB5m", "u", "radius in \xC2\xB5m",
                         "P1 P2 in \xC2\xB5m", "u", ""},
                        {}};
  std::vector<double> errors, uncertainties, roundings, rounding_uncertainties, radii;
  std::vector<PlotPoint> along_error, along_rounding;
  std::vector<SectionAnswer> answers;
  refused = 0;
  double last_along = 0;
  bool stated_along = true;
  std::size_t largest = sections.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const SectionReadings& section = sections[i];
    answers.push_back(answer_of(request, section));
    const SectionAnswer& answer = answers.back();
    stated_along = stated_along && section.along;
    last_along = section.along.value_or(static_cast<double>(i + 1));
    nlohmann::ordered_json json = {{"section", section.name}, {"points", section.points.cols()}};
    if (section.along) json["along_mm"] = *section.along;
    std::vector<std::string> row = {section.name, section.along ? fmt::format("{:.3f}", *section.along) : ""};
    if (answer.ok) {
      json["contour_error_um"] = 1e3 * answer.error;
      json["u_contour_error_um"] = 1e3 * answer.error_uncertainty;
      if (request.groove) {
        json["width_um"] = 1e3 * answer.width;
        json["left"] = edge_json(answer.first);
        json["right"] = edge_json(answer.second);
      } else {
        json.update(edge_json(answer.first));
      }
      errors.push_back(answer.error);
      uncertainties.push_back(answer.error_uncertainty);
      along_error.push_back({last_along, 1e3 * answer.error});
      if (largest == sections.size() || std::abs(answer.error) > std::abs(answers[largest].error)) largest = i;
      for (const EdgeFit* edge : {&answer.first, &answer.second}) {
        if (edge->status != EdgeStatus::ok) continue;
        roundings.push_back(edge->rounding);
        rounding_uncertainties.push_back(edge->rounding_uncertainty);
        radii.push_back(edge->radius);
        along_rounding.push_back({last_along, 1e3 * edge->rounding});
      }
      row.insert(row.end(),
                 {fmt::format("{:.2f}", 1e3 * answer.error), fmt::format("{:.2f}", 1e3 * answer.error_uncertainty),
                  fmt::format("{:.2f}", 1e3 * radii.back()), fmt::format("{:.2f}", 1e3 * roundings.back()),
                  fmt::format("{:.2f}", 1e3 * rounding_uncertainties.back()), ""});
    } else {
      ++refused;
      json["not_evaluated"] = answer.reason;
      row.insert(row.end(), {"", "", "", "", "", "not evaluated: " + answer.reason});
      report.notes.push_back("Section " + section.name + " is not evaluated: " + answer.reason + ".");
    }
    report.details["sections"].push_back(std::move(json));
    table.rows.push_back(std::move(row));
  }
  report.facts = {{"feature", request.groove ? "groove: middle between its edges" : "edge"},
                  {"sections", fmt::format("{} of {} evaluated", errors.size(), sections.size())}};
  const std::string missing = errors.empty() ? "no section could be evaluated" : "";
  const ContourFigures figures = contour_figures(errors, uncertainties, request.origin_uncertainty);
  add_contour_figures(report, "contour", "contour error", figures, missing);
  if (!errors.empty()) {
    report.figures.push_back(
        contour_figure("bias", "mean of the signed contour errors", figures.bias, figures.bias_uncertainty));
  }
  add_contour_figures(report, "rounding", "rounding P1 P2", contour_figures(roundings, rounding_uncertainties),
                      missing);
  if (!radii.empty()) {
    report.figures.push_back(contour_figure("radius", "mean radius of the edge", sample_statistics(radii).mean, 0));
  }
  report.tables.push_back(std::move(table));
  report.notes.emplace_back(
      "Contour error: from the commanded curve (origin of each section) to P2, where surface and wall would meet. The "
      "distance P1 P2, which Yin et al. call the contour error, is the rounding of the edge: it does not depend on "
      "where the edge is.");
  if (request.origin_uncertainty > 0) {
    report.notes.push_back(fmt::format("The origins of the sections share a standard uncertainty of {:.3g} \xC2\xB5m.",
                                       1e3 * request.origin_uncertainty));
  } else {
    report.notes.emplace_back(
        "No uncertainty of the sections' origins was stated (--u-origin-um): the figures hold only the scatter of the "
        "points.");
  }
  if (!errors.empty()) {
    XyPlot plot(request.title, stated_along ? "along the curve in mm" : "section", "\xC2\xB5m");
    plot.level(0, "", {PlotColour::soft, 1});
    plot.line(along_error, {PlotColour::first, 1}, "");
    plot.points(along_error, Marker::circle, {PlotColour::first}, "contour error, across the curve");
    plot.points(along_rounding, Marker::cross, {PlotColour::second}, "rounding P1 P2");
    report.plots.push_back({"plot", "", plot.svg()});
    report.plots.push_back(section_plot(request, sections[largest], answers[largest]));
  }
  return report;
}

}  // namespace abbe
