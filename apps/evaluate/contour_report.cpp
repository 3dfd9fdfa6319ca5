#include "evaluate/contour_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/report/svg_plot.h"
#include "evaluate/thinned.h"

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

EvaluationFigure figure(std::string symbol, std::string name, double value, double uncertainty) {
  EvaluationFigure result;
  result.symbol = std::move(symbol);
  result.name = std::move(name);
  result.value = value;
  if (uncertainty > 0) result.uncertainty = 2 * uncertainty;
  return result;
}

/// Mean, largest and standard deviation of one kind of amount, or the reason why there are none.
void add_figures(EvaluationReport& report, const std::string& symbol, const std::string& name,
                 const ContourFigures& figures, const std::string& missing) {
  report.figures.push_back(
      figure(symbol + "_mean", name + ", mean amount", figures.amounts.mean, figures.mean_uncertainty));
  report.figures.push_back(
      figure(symbol + "_max", name + ", largest amount", figures.amounts.maximum, figures.largest_uncertainty));
  report.figures.push_back(figure(symbol + "_s", name + ", standard deviation of the amounts",
                                  figures.amounts.deviation, figures.deviation_uncertainty));
  if (figures.amounts.count < 2) {
    report.figures.back().value.reset();
    report.figures.back().uncertainty.reset();
    report.figures.back().missing = "one section";
  }
  if (missing.empty()) return;
  for (std::size_t i = report.figures.size() - 3; i < report.figures.size(); ++i) {
    report.figures[i].value.reset();
    report.figures[i].uncertainty.reset();
    report.figures[i].missing = missing;
  }
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
  add_figures(report, "contour", "contour error", contour_figures(errors, uncertainties, request.origin_uncertainty),
              missing);
  if (!errors.empty()) {
    double bias = 0, square = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      bias += errors[i] / static_cast<double>(errors.size());
      square += uncertainties[i] * uncertainties[i];
    }
    report.figures.push_back(
        figure("bias", "mean of the signed contour errors", bias,
               std::hypot(std::sqrt(square) / static_cast<double>(errors.size()), request.origin_uncertainty)));
  }
  add_figures(report, "rounding", "rounding P1 P2", contour_figures(roundings, rounding_uncertainties), missing);
  if (!radii.empty()) {
    report.figures.push_back(figure("radius", "mean radius of the edge", sample_statistics(radii).mean, 0));
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

EvaluationReport contour_points_report(const ContourRequest& request, const Curve& curve, bool closed,
                                       const Eigen::Matrix3Xd& points) {
  const auto n = static_cast<Eigen::Index>(curve.points.size());
  Eigen::Matrix3Xd commanded(3, n);
  for (Eigen::Index i = 0; i < n; ++i) commanded.col(i) = curve.points[static_cast<std::size_t>(i)].point;
  const CommandCurve command(commanded, closed);
  Eigen::Matrix3Xd normals(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::Index nearest = 0;
    (commanded.colwise() - points.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    normals.col(i) = curve.points[static_cast<std::size_t>(nearest)].direction;
  }
  const std::vector<ContourDeviation> deviations = contour_deviations(command, points, normals);
  EvaluationReport report;
  report.kind = "contour";
  report.title = request.title;
  report.standard = "Distances of measured points from the commanded curve";
  std::vector<double> distances, across, off;
  std::vector<PlotPoint> plotted, height;
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const ContourDeviation& d = deviations[i];
    nlohmann::ordered_json json = {{"along_mm", d.along},
                                   {"across_um", 1e3 * d.across},
                                   {"out_of_surface_um", 1e3 * d.off},
                                   {"distance_um", 1e3 * d.distance}};
    if (d.beyond_end) json["beyond_end"] = true;
    report.details["points"].push_back(std::move(json));
    beyond += d.beyond_end ? 1 : 0;
    if (d.beyond_end) continue;  // no distance across the curve
    distances.push_back(d.distance);
    across.push_back(d.across);
    off.push_back(d.off);
  }
  std::vector<double> amounts;
  for (const ContourDeviation& d : deviations) amounts.push_back(d.across);
  for (const std::size_t i : thinned(amounts)) {
    if (deviations[i].beyond_end) continue;
    plotted.push_back({deviations[i].along, 1e3 * deviations[i].across});
    height.push_back({deviations[i].along, 1e3 * deviations[i].off});
  }
  report.facts = {
      {"points", fmt::format("{}", deviations.size())},
      {"commanded curve", fmt::format("{} points, {:.3f} mm{}", n, command.length(), closed ? ", closed" : "")}};
  const std::string missing = across.empty() ? "no point lies beside the curve" : "";
  add_figures(report, "contour", "contour error across the curve",
              contour_figures(across, {}, request.origin_uncertainty), missing);
  add_figures(report, "height", "deviation out of the surface", contour_figures(off), missing);
  add_figures(report, "distance", "distance in space", contour_figures(distances, {}, request.origin_uncertainty),
              missing);
  if (beyond > 0) {
    report.notes.push_back(
        fmt::format("{} beyond an end of the curve, without a part in the figures.",
                    beyond == 1 ? std::string("1 point lies") : fmt::format("{} points lie", beyond)));
  }
  report.notes.emplace_back(
      "Between its points the commanded curve is smooth (cubic pieces with the tangents of circles), except where its "
      "sides turn by more than 20 degrees.");
  if (!plotted.empty()) {
    XyPlot plot(request.title, "along the curve in mm", "\xC2\xB5m");
    plot.level(0, "", {PlotColour::soft, 1});
    plot.points(plotted, Marker::circle, {PlotColour::first}, "across the curve");
    plot.points(height, Marker::cross, {PlotColour::second}, "out of the surface");
    report.plots.push_back({"plot", "", plot.svg()});
  }
  return report;
}

}  // namespace abbe
