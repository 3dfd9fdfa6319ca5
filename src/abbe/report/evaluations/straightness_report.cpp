#include "abbe/report/evaluations/straightness_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

/// Deviations from the reference line with the zone that holds them.
EvaluationPlot zone_plot(const LineReadings& line, const Straightness& result, const std::string& title,
                         const std::string& name) {
  XyPlot plot(title, line.name.empty() ? "position in mm" : "position on " + line.name + " in mm",
              "deviation from the reference line in \xC2\xB5m");
  std::vector<std::size_t> order(line.positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return line.positions[a] < line.positions[b]; });
  std::vector<PlotPoint> points, touching;
  for (const std::size_t i : order) {
    points.push_back({line.positions[i], 1e3 * result.deviations[i]});
    const double slack = 1e-9 * result.value;
    if (result.deviations[i] >= result.largest - slack || result.deviations[i] <= result.smallest + slack) {
      touching.push_back(points.back());
    }
  }
  plot.line(points, {PlotColour::first, 1}, "");
  plot.points(points, Marker::circle, {PlotColour::first}, "readings");
  plot.points(touching, Marker::cross, {PlotColour::second, 2}, "on the edge of the zone");
  plot.level(1e3 * result.largest, fmt::format("{:.2f}", 1e3 * result.largest), {PlotColour::soft, 1, true, 1});
  plot.level(1e3 * result.smallest, fmt::format("{:.2f}", 1e3 * result.smallest), {PlotColour::soft, 1, true, 1});
  plot.outer_dimension({line.positions[result.smallest_at], 1e3 * result.smallest},
                       {line.positions[result.largest_at], 1e3 * result.largest},
                       fmt::format("{:.2f} \xC2\xB5m", 1e3 * result.value), {PlotColour::ink, 1});
  return {name, "", plot.picture()};
}

EvaluationFigure straightness_figure(const std::string& symbol, const std::string& name, const Straightness& result,
                                     bool stated) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = name;
  figure.value = result.value;
  if (stated) figure.uncertainty = 2 * result.value_uncertainty;
  return figure;
}

EvaluationFigure angle_figure(const std::string& symbol, const std::string& name, double value, double uncertainty) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = name;
  figure.quantity = Quantity::angle;
  figure.unit = "urad";
  figure.value = value;
  figure.uncertainty = 2 * uncertainty;
  return figure;
}

void add_uncertainty_notes(bool stated, EvaluationReport& report) {
  if (!stated) {
    report.notes.push_back(
        "No uncertainty of the readings was stated (--u-reading-um): straightness has no measurement uncertainty.");
  }
  report.notes.push_back(
      "Uncertainties of slopes are taken from the scatter of the readings about their line or from the stated "
      "uncertainty, whichever is larger.");
}

}  // namespace

EvaluationReport straightness_report(const std::string& file, const LineReadings& line, const Straightness& least,
                                     const Straightness& zone, ReferenceLine shown, bool stated) {
  EvaluationReport report;
  report.kind = "straightness";
  report.title = "Straightness of " + file;
  report.standard = "ISO 230-1";
  const auto [low, high] = std::minmax_element(line.positions.begin(), line.positions.end());
  report.facts = {{"readings", fmt::format("{}", line.positions.size())},
                  {"length", fmt::format("{:.6g} to {:.6g} mm", *low, *high)}};
  report.figures = {
      straightness_figure("straightness_ls", "straightness error, least-squares line", least, stated),
      straightness_figure("straightness_mz", "straightness error, minimum zone", zone, stated),
      angle_figure("slope_ls", "slope of the least-squares line", least.line.slope, least.slope_uncertainty),
      angle_figure("slope_mz", "slope of the minimum zone", zone.line.slope, zone.slope_uncertainty)};
  add_uncertainty_notes(stated, report);
  const bool shows_zone = shown == ReferenceLine::minimum_zone;
  report.plots.push_back(zone_plot(line, shows_zone ? zone : least,
                                   report.title + (shows_zone ? ", minimum zone" : ", least-squares line"), "plot"));
  report.details = {{"scatter_um", 1e3 * least.scatter},
                    {"zone_touches_at_mm", {line.positions[zone.largest_at], line.positions[zone.smallest_at]}}};
  return report;
}

EvaluationReport squareness_report(const std::string& file, const std::array<LineReadings, 2>& lines,
                                   const Squareness& result, const SquarenessOptions& options) {
  EvaluationReport report;
  report.kind = "squareness";
  report.title = "Squareness of " + file;
  report.standard = "ISO 230-1";
  const bool zone = options.reference == ReferenceLine::minimum_zone;
  report.facts = {{"lines", lines[0].name + " and " + lines[1].name},
                  {"reference lines", zone ? "minimum-zone" : "least-squares"}};
  report.figures.push_back(
      angle_figure("squareness", fmt::format("angle between +{} and +{} less 90\xC2\xB0", lines[0].name, lines[1].name),
                   result.value, result.uncertainty));
  report.figures.back().about = {lines[0].name, lines[1].name};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string number = std::to_string(k + 1);
    report.figures.push_back(straightness_figure("straightness_" + number, "straightness error of " + lines[k].name,
                                                 result.lines[k], options.reading_uncertainty > 0));
    report.figures.back().about = {lines[k].name};
    report.figures.push_back(angle_figure("slope_" + number, "slope of " + lines[k].name + " against the square",
                                          result.lines[k].line.slope, result.lines[k].slope_uncertainty));
    report.figures.back().about = {lines[k].name};
    report.plots.push_back(
        zone_plot(lines[k], result.lines[k], lines[k].name + " against the square", "line-" + number));
  }
  report.facts.emplace_back("angle of the square less 90\xC2\xB0",
                            fmt::format("{:.3g} \xC2\xB5rad, standard uncertainty {:.3g} \xC2\xB5rad",
                                        1e6 * options.artefact, 1e6 * options.artefact_uncertainty));
  if (options.artefact_uncertainty == 0) {
    report.notes.push_back("No uncertainty of the reference square was stated (--u-square-urad): it counts as exact.");
  }
  add_uncertainty_notes(options.reading_uncertainty > 0, report);
  return report;
}

}  // namespace abbe
