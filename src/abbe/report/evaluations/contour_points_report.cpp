// Measured points against a commanded curve.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/drawings/thinned.h"
#include "abbe/report/evaluations/contour_report.h"
#include "abbe/report/pages/contour_page.h"

namespace abbe {
namespace {

nlohmann::ordered_json deviation_json(const ContourDeviation& d, std::size_t pieces) {
  nlohmann::ordered_json json;
  if (pieces > 1) json["piece"] = d.piece + 1;
  json["along_mm"] = d.along;
  if (d.across) json["across_um"] = 1e3 * *d.across;
  if (d.off) json["out_of_surface_um"] = 1e3 * *d.off;
  json["distance_um"] = 1e3 * d.distance;
  if (d.beyond_end) json["beyond_end"] = true;
  return json;
}

std::string points_that(std::size_t count, const char* one, const char* many) {
  return count == 1 ? std::string("1 point ") + one : fmt::format("{} points {}", count, many);
}

}  // namespace

EvaluationFigure contour_figure(std::string symbol, std::string name, double value, double uncertainty) {
  EvaluationFigure result;
  result.symbol = std::move(symbol);
  result.name = std::move(name);
  result.value = value;
  if (uncertainty > 0) result.uncertainty = 2 * uncertainty;
  return result;
}

/// Mean, largest and standard deviation of one kind of amount, or the reason why there are none.
void add_contour_figures(EvaluationReport& report, const std::string& symbol, const std::string& name,
                         const ContourFigures& figures, const std::string& missing) {
  report.figures.push_back(
      contour_figure(symbol + "_mean", name + ", mean amount", figures.amounts.mean, figures.mean_uncertainty));
  report.figures.push_back(
      contour_figure(symbol + "_max", name + ", largest amount", figures.amounts.maximum, figures.largest_uncertainty));
  report.figures.push_back(contour_figure(symbol + "_s", name + ", standard deviation of the amounts",
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

EvaluationReport contour_points_report(const std::string& title, const std::vector<CommandPiece>& pieces,
                                       const ContourPointsEvaluation& evaluated) {
  const std::vector<ContourDeviation>& deviations = evaluated.deviations;
  EvaluationReport report;
  report.kind = "contour";
  report.title = title;
  report.standard = "Distances of measured points from the commanded curve";
  for (const ContourDeviation& d : deviations) {
    report.details["points"].push_back(deviation_json(d, pieces.size()));
  }
  Eigen::Index curve_points = 0;
  double length = 0;
  for (const CommandPiece& piece : pieces) {
    curve_points += piece.curve.size();
    length += piece.curve.length();
  }
  const bool closed = pieces.size() == 1 && pieces[0].curve.closed();
  report.facts = {
      {"points", fmt::format("{}", deviations.size())},
      {"commanded curve", fmt::format("{} points, {:.3f} mm{}{}", curve_points, length, closed ? ", closed" : "",
                                      pieces.size() > 1 ? fmt::format(", in {} pieces", pieces.size()) : "")}};
  const std::string missing = evaluated.counted.empty() ? "no point lies beside the curve" : "";
  add_contour_figures(report, "contour", "contour error across the curve", evaluated.across, missing);
  add_contour_figures(report, "height", "deviation out of the surface", evaluated.off, missing);
  add_contour_figures(report, "distance", "distance in space", evaluated.distance,
                      deviations.size() == evaluated.beyond ? "no point lies beside the curve" : "");
  if (evaluated.beyond > 0) {
    report.notes.push_back(points_that(evaluated.beyond, "lies", "lie") +
                           " beyond an end of the curve, without a part in the figures.");
  }
  if (evaluated.undirected > 0) {
    report.notes.push_back(
        points_that(evaluated.undirected, "lies", "lie") +
        " where the direction of the tool is that of the curve: nothing is across it there, and only "
        "the distances count.");
  }
  report.notes.emplace_back(
      "Between its points the commanded curve is smooth (cubic pieces with the tangents of circles), except where its "
      "sides turn by more than 20 degrees.");
  if (pieces.size() > 1) {
    report.notes.emplace_back(
        "Only the pieces on which the tool works are compared, each point with the one nearest to it; the length along "
        "the curve counts them one behind the other.");
  }
  std::vector<PlotPoint> plotted, height;
  std::vector<double> across;
  for (const std::size_t i : evaluated.counted) across.push_back(deviations[i].across.value());
  for (const std::size_t i : thinned(across)) {
    const ContourDeviation& d = deviations[evaluated.counted[i]];
    plotted.push_back({d.along, 1e3 * across[i]});
    height.push_back({d.along, 1e3 * d.off.value()});
  }
  if (!plotted.empty()) {
    XyPlot plot(title, "along the curve in mm", "\xC2\xB5m");
    plot.level(0, "", {PlotColour::soft, 1});
    plot.points(plotted, Marker::circle, {PlotColour::first}, "across the curve");
    plot.points(height, Marker::cross, {PlotColour::second}, "out of the surface");
    report.plots.push_back({"plot", "", plot.picture(), true});
    report.page = {{"contour", contour_points_block(evaluated, pieces.size() == 1)}};
  }
  return report;
}

}  // namespace abbe
