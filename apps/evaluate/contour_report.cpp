#include "evaluate/contour_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/report/svg_plot.h"
#include "evaluate/contour_page.h"
#include "evaluate/contour_sections.h"

namespace abbe {

EvaluationReport section_report(const ContourRequest& request, const std::vector<SectionReadings>& sections,
                                std::size_t& refused) {
  EvaluationReport report;
  report.kind = "contour";
  report.title = request.title;
  report.standard = "Contour error from cross-sections, after Yin et al., Machines 9 (2021) 237";
  const bool stated_along = along_is_stated(sections);
  std::vector<double> errors, uncertainties, roundings, rounding_uncertainties, radii;
  std::vector<PlotPoint> along_error, along_rounding;
  std::vector<SectionAnswer> answers;
  refused = 0;
  std::size_t largest = sections.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    answers.push_back(answer_of(request, sections[i]));
    const SectionAnswer& answer = answers.back();
    report.details["sections"].push_back(section_json(sections[i], answer));
    if (!answer.ok) {
      ++refused;
      report.notes.push_back("Section " + sections[i].name + " is not evaluated: " + answer.reason + ".");
      continue;
    }
    const double along = stated_along ? *sections[i].along : static_cast<double>(i + 1);
    errors.push_back(answer.error);
    uncertainties.push_back(answer.error_uncertainty);
    along_error.push_back({along, 1e3 * answer.error});
    if (largest == sections.size() || std::abs(answer.error) > std::abs(answers[largest].error)) largest = i;
    for (const EdgeFit* const edge : answer.edges()) {
      roundings.push_back(edge->rounding);
      rounding_uncertainties.push_back(edge->rounding_uncertainty);
      radii.push_back(edge->radius);
      along_rounding.push_back({along, 1e3 * edge->rounding});
    }
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
  report.tables.push_back(section_table(sections, answers, request.groove));
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
    report.plots.push_back({"plot", "", plot.svg(), true});
    report.plots.push_back(section_plot(request, sections[largest], answers[largest]));
  }
  report.page = {{"contour", contour_sections_block(request, sections, answers)}};
  return report;
}

}  // namespace abbe
