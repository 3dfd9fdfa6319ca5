#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/pages/contour_page.h"
#include "yin/constants.h"
#include "yin/results.h"

namespace abbe {
namespace {

EvaluationFigure micrometre_figure(const std::string& symbol, const std::string& name, double value_um) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  result.value = 1e-3 * value_um;
  return result;
}

void add_figures(std::vector<EvaluationFigure>& figures, const std::string& symbol, const std::string& name,
                 const YinFigures& f) {
  figures.push_back(micrometre_figure(symbol + "_mean", name + ", mean", f.mean));
  figures.push_back(micrometre_figure(symbol + "_max", name + ", largest", f.largest));
  figures.push_back(micrometre_figure(symbol + "_s", name + ", standard deviation", f.deviation));
}

EvaluationPlot contour_plot(const YinResults& r) {
  XyPlot plot("Contour error along the curve of Table A4", "along the curve in mm", "\xC2\xB5m");
  std::vector<PlotPoint> truth, found, rounding;
  for (std::size_t i = 0; i < r.sections.fits.size(); ++i) {
    const double along = *r.sections.sections[i].along;
    truth.push_back({along, 1e3 * r.sections.edge[i]});
    if (r.sections.fits[i].status != EdgeStatus::ok) continue;
    found.push_back({along, 1e3 * r.sections.fits[i].corner.x()});
    rounding.push_back({along, 1e3 * r.sections.fits[i].rounding});
  }
  const double u = 1e3 * r.contour.budget.total[0].by_sensitivity;
  plot.level(0, "", {PlotColour::soft, 1});
  plot.level(2 * u, "two standard uncertainties", {PlotColour::limit, 1, true, 1});
  plot.level(-2 * u, "", {PlotColour::limit, 1, true, 1});
  plot.line(truth, {PlotColour::first, 1.6}, "edge of one simulated part");
  plot.points(found, Marker::circle, {PlotColour::first}, "found from its sections (P2)");
  plot.points(rounding, Marker::cross, {PlotColour::second}, "P1 P2: the rounding");
  return {"contour", "One part, engraved by a machine with errors drawn from the budget, and what its sections show.",
          plot.picture()};
}

EvaluationPlot budget_plot(const UncertaintyBudget& budget) {
  XyPlot plot("Causes of the contour error across the curve", "rank", "standard uncertainty in \xC2\xB5m");
  std::vector<PlotPoint> linear, drawn;
  for (std::size_t i = 0; i < budget.lines.size(); ++i) {
    const BudgetFigure& f = budget.lines[i].kinds[0];
    const auto rank = static_cast<double>(i + 1);
    linear.push_back({rank, 1e3 * f.by_sensitivity});
    drawn.push_back({rank, 1e3 * f.by_monte_carlo});
  }
  plot.include_y(0);
  plot.points(linear, Marker::circle, {PlotColour::first, 1.6}, "by sensitivity");
  plot.points(drawn, Marker::cross, {PlotColour::second, 1.6}, "by Monte Carlo");
  return {"budget", "In the order of the budget table.", plot.picture()};
}

/// The sections of the simulated part, as `abbe evaluate contour` shows its own.
nlohmann::json contour_block(const YinSections& sections) {
  SectionOptions options;
  options.edge = sections.options;
  std::vector<SectionAnswer> answers;
  for (const EdgeFit& fit : sections.fits) {
    SectionAnswer answer;
    answer.first = fit;
    answer.ok = fit.status == EdgeStatus::ok;
    answer.reason = fit.reason;
    answer.error = fit.corner.x();
    answer.error_uncertainty = std::hypot(fit.corner_uncertainty(), yin::kSectionPlace);
    answers.push_back(std::move(answer));
  }
  nlohmann::json block = contour_sections_block(options, sections.sections, answers);
  block["title"] = "From the sections of one simulated part";
  return block;
}

}  // namespace

std::vector<EvaluationPlot> yin_plots(const YinResults& r) {
  if (!r.positioning.failure.empty()) return {};
  return {contour_plot(r), budget_plot(r.contour.budget)};
}

std::vector<EvaluationFigure> yin_headline(const YinResults& r) {
  std::vector<EvaluationFigure> figures;
  add_figures(figures, "paper", "contour error as the paper measured it", kYinMeasured);
  if (!r.positioning.failure.empty()) return figures;
  add_figures(figures, "predicted", "predicted contour error across the curve", r.contour.across);
  add_figures(figures, "below95", "contour error that 95 % of machines stay below", r.contour.upper);
  add_figures(figures, "sections", "contour error from the sections of one simulated part", r.sections.found);
  add_figures(figures, "P1P2", "P1 P2 of the same sections", r.sections.rounding);
  return figures;
}

nlohmann::json yin_page(const YinResults& r) {
  if (!r.positioning.failure.empty()) return nullptr;
  return {{"contour", contour_block(r.sections)}};
}

}  // namespace abbe
