#include "abbe/report/evaluations/contour_report.h"

#include <fmt/format.h>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/pages/contour_page.h"
#include "abbe/report/pages/contour_sections.h"

namespace abbe {

EvaluationReport section_report(const std::string& title, const SectionOptions& options,
                                const std::vector<SectionReadings>& sections, const SectionsEvaluation& evaluated) {
  EvaluationReport report;
  report.kind = "contour";
  report.title = title;
  report.standard = "Contour error from cross-sections, after Yin et al., Machines 9 (2021) 237";
  const bool stated_along = along_is_stated(sections);
  std::vector<PlotPoint> along_error, along_rounding;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const SectionAnswer& answer = evaluated.answers[i];
    report.details["sections"].push_back(section_json(sections[i], answer));
    if (!answer.ok) {
      report.notes.push_back("Section " + sections[i].name + " is not evaluated: " + answer.reason + ".");
      continue;
    }
    const double along = stated_along ? *sections[i].along : static_cast<double>(i + 1);
    along_error.push_back({along, 1e3 * answer.error});
    for (const EdgeFit* const edge : answer.edges()) along_rounding.push_back({along, 1e3 * edge->rounding});
  }
  const bool any = evaluated.evaluated() > 0;
  report.facts = {{"feature", options.groove ? "groove: middle between its edges" : "edge"},
                  {"sections", fmt::format("{} of {} evaluated", evaluated.evaluated(), sections.size())}};
  const std::string missing = any ? "" : "no section could be evaluated";
  const ContourFigures& figures = evaluated.contour;
  add_contour_figures(report, "contour", "contour error", figures, missing);
  if (any) {
    report.figures.push_back(
        contour_figure("bias", "mean of the signed contour errors", figures.bias, figures.bias_uncertainty));
  }
  add_contour_figures(report, "rounding", "rounding P1 P2", evaluated.rounding, missing);
  if (any) report.figures.push_back(contour_figure("radius", "mean radius of the edge", evaluated.radius, 0));
  report.tables.push_back(section_table(sections, evaluated.answers, options.groove));
  report.notes.emplace_back(
      "Contour error: from the commanded curve (origin of each section) to P2, where surface and wall would meet. The "
      "distance P1 P2, which Yin et al. call the contour error, is the rounding of the edge: it does not depend on "
      "where the edge is.");
  if (options.origin_uncertainty > 0) {
    report.notes.push_back(fmt::format("The origins of the sections share a standard uncertainty of {:.3g} \xC2\xB5m.",
                                       1e3 * options.origin_uncertainty));
  } else {
    report.notes.emplace_back(
        "No uncertainty of the sections' origins was stated (--u-origin-um): the figures hold only the scatter of the "
        "points.");
  }
  if (any) {
    XyPlot plot(title, stated_along ? "along the curve in mm" : "section", "\xC2\xB5m");
    plot.level(0, "", {PlotColour::soft, 1});
    plot.line(along_error, {PlotColour::first, 1}, "");
    plot.points(along_error, Marker::circle, {PlotColour::first}, "contour error, across the curve");
    plot.points(along_rounding, Marker::cross, {PlotColour::second}, "rounding P1 P2");
    report.plots.push_back({"plot", "", plot.picture(), true});
    report.plots.push_back(section_plot(options, sections[evaluated.largest], evaluated.answers[evaluated.largest]));
  }
  report.page = {{"contour", contour_sections_block(options, sections, evaluated.answers)}};
  return report;
}

}  // namespace abbe
