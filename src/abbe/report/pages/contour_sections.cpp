#include "abbe/report/pages/contour_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

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
  const double turn = kTurn / 4 + slope + tilt;
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

std::string micrometres(double mm) { return fmt::format("{:.2f}", 1e3 * mm); }

}  // namespace

nlohmann::ordered_json section_json(const SectionReadings& section, const SectionAnswer& answer) {
  nlohmann::ordered_json json = {{"section", section.name}, {"points", section.points.cols()}};
  if (section.along) json["along_mm"] = *section.along;
  if (!answer.ok) {
    json["not_evaluated"] = answer.reason;
    return json;
  }
  json["contour_error_um"] = 1e3 * answer.error;
  json["u_contour_error_um"] = 1e3 * answer.error_uncertainty;
  if (answer.groove) {
    json["width_um"] = 1e3 * answer.width;
    json["left"] = edge_json(answer.first);
    json["right"] = edge_json(answer.second);
  } else {
    json.update(edge_json(answer.first));
  }
  return json;
}

EvaluationTable section_table(const std::vector<SectionReadings>& sections, const std::vector<SectionAnswer>& answers,
                              bool groove) {
  EvaluationTable table{"Sections", {"section", "along in mm", "contour error in \xC2\xB5m", "u"}, {}};
  for (const char* const side : {groove ? ", left edge" : "", ", right edge"}) {
    const std::string of = side;
    table.headers.insert(table.headers.end(), {"radius in \xC2\xB5m" + of, "P1 P2 in \xC2\xB5m" + of, "u" + of});
    if (!groove) break;
  }
  table.headers.emplace_back("");
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const SectionAnswer& answer = answers[i];
    std::vector<std::string> row = {sections[i].name,
                                    sections[i].along ? fmt::format("{:.3f}", *sections[i].along) : ""};
    if (answer.ok) {
      row.insert(row.end(), {micrometres(answer.error), micrometres(answer.error_uncertainty)});
      for (const EdgeFit* const edge : answer.edges()) {
        row.insert(row.end(),
                   {micrometres(edge->radius), micrometres(edge->rounding), micrometres(edge->rounding_uncertainty)});
      }
      row.emplace_back("");
    } else {
      row.resize(table.headers.size() - 1);
      row.push_back("not evaluated: " + answer.reason);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

SectionPicture section_picture(const SectionOptions& options, const SectionReadings& section,
                               const SectionAnswer& answer) {
  SectionPicture picture;
  double from = -HUGE_VAL, to = HUGE_VAL;
  if (answer.ok) {
    const double lowest = section.points.row(1).minCoeff();
    // Around the corners: of the surface as much as the corner is wide.
    from = to = answer.first.corner.x();
    for (const EdgeFit* const edge : answer.edges()) {
      const double reach = 4 * std::max(edge->rounding, 0.25 * (edge->corner.y() - lowest));
      from = std::min(from, edge->corner.x() - reach);
      to = std::max(to, edge->corner.x() + reach);
    }
    for (const EdgeFit* const edge : answer.edges()) {
      const bool left = options.groove ? edge == &answer.first : options.edge.surface == EdgeSide::left;
      picture.edges.push_back({curve_of(*edge, left ? from : to, lowest, left ? 1 : -1),
                               {1e3 * edge->onset.x(), 1e3 * edge->onset.y()},
                               {1e3 * edge->corner.x(), 1e3 * edge->corner.y()}});
    }
  }
  for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
    const double u = section.points(0, i);
    if (u >= from && u <= to) picture.scanned.push_back({1e3 * u, 1e3 * section.points(1, i)});
  }
  return picture;
}

EvaluationPlot section_plot(const SectionOptions& options, const SectionReadings& section,
                            const SectionAnswer& answer) {
  XyPlot plot("Section " + section.name, "across the curve in \xC2\xB5m", "out of the surface in \xC2\xB5m");
  plot.keep_the_same_scale();
  const SectionPicture picture = section_picture(options, section, answer);
  plot.points(picture.scanned, Marker::circle, {PlotColour::first, 1, false, 0.6}, "scanned");
  for (const SectionPicture::Edge& edge : picture.edges) {
    const bool first = &edge == picture.edges.data();
    plot.line(edge.curve, {PlotColour::second, 2}, first ? "surface, rounding, wall" : "");
    plot.points({edge.onset}, Marker::up, {PlotColour::third, 2}, first ? "P1" : "");
    plot.points({edge.corner}, Marker::cross, {PlotColour::limit, 2}, first ? "P2" : "");
  }
  plot.points({{0, 0}}, Marker::circle, {PlotColour::ink, 2}, "commanded curve");
  return {"section", "The section with the largest contour error.", plot.picture(), true};
}

}  // namespace abbe
