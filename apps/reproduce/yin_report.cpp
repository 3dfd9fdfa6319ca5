#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/svg_plot.h"
#include "evaluate/contour_page.h"
#include "reproduce/yin_constants.h"
#include "reproduce/yin_results.h"

namespace abbe {
namespace {

EvaluationFigure micrometre_figure(const std::string& symbol, const std::string& name, double value_um) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  result.value = 1e-3 * value_um;
  return result;
}

void add_figures(EvaluationReport& report, const std::string& symbol, const std::string& name, const YinFigures& f) {
  report.figures.push_back(micrometre_figure(symbol + "_mean", name + ", mean", f.mean));
  report.figures.push_back(micrometre_figure(symbol + "_max", name + ", largest", f.largest));
  report.figures.push_back(micrometre_figure(symbol + "_s", name + ", standard deviation", f.deviation));
}

EvaluationTable linkage_table(const YinResults& r) {
  EvaluationTable table{"Linkage parameters by the five steps, and by one fit of marks at many poses",
                        {"parameter", "corrected in mm", "printed, U in mm", "printed, P in mm",
                         "u by five steps in \xC2\xB5m", "u by joint fit in \xC2\xB5m"},
                        {}};
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    table.rows.push_back({linkage_name(i), fmt::format("{:.3f}", r.table_moves.found.linkage.values()[i]),
                          fmt::format("{:.3f}", r.table_moves.found.printed.values()[i]),
                          fmt::format("{:.3f}", r.head_moves.found.printed.values()[i]),
                          fmt::format("{:.1f}", 1e3 * r.table_moves.found.standard_uncertainty(i)),
                          r.joint.converged ? fmt::format("{:.1f}", 1e3 * r.joint.standard_uncertainty(i)) : "-"});
  }
  return table;
}

EvaluationTable positioning_table(const YinResults& r) {
  EvaluationTable table{
      "Positioning parameters in both readings of Table 3, with standard uncertainties",
      {"", "x in mm", "y in mm", "z in mm", "alpha in \xC2\xB0", "beta in \xC2\xB0", "gamma in \xC2\xB0"},
      {}};
  const auto add = [&](const char* words, const YinPositioning& positioning, bool to_workpiece) {
    std::vector<std::string> row = {words};
    if (!positioning.failure.empty()) {
      row.resize(table.headers.size(), "-");
      table.rows.push_back(std::move(row));
      return;
    }
    const PositioningParameters& p = to_workpiece ? positioning.table_to_workpiece : positioning.workpiece_to_table;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double value = i < 3 ? p.translation[i] : p.angles[i - 3] / kDegree;
      row.push_back(
          fmt::format("{:.4f} \xC2\xB1 {:.4f}", value, std::sqrt(p.covariance(i, i)) / (i < 3 ? 1 : kDegree)));
    }
    table.rows.push_back(std::move(row));
  };
  add("p_workpiece = D p_table", r.positioning, true);
  add("p_table = D p_workpiece", r.positioning, false);
  add("simulated scanner with occlusion, first reading", r.located.positioning, true);
  return table;
}

EvaluationTable equations_table(const std::vector<YinEquation>& equations) {
  EvaluationTable table{"Equations (1) to (8), each put to a test that does not use it",
                        {"equation", "", "printed fails by", "right fails by", "printed", "right", "test"},
                        {}};
  for (const YinEquation& e : equations) {
    table.rows.push_back({e.number, e.is_right ? "right" : "wrong", fmt::format("{:.3g} {}", e.printed_off, e.unit),
                          fmt::format("{:.1g} {}", e.right_off, e.unit), e.printed, e.right, e.test});
  }
  return table;
}

EvaluationTable commands_table(const std::vector<YinAxisCommands>& commands) {
  EvaluationTable table{
      "Table A4 (paper, workpiece frame) and the axis commands for it: Tables 2 and 3, convention U, C2 = 0, A > 0",
      {"No.", "paper x in mm", "paper y in mm", "paper z in mm", "X in mm", "Y in mm", "Z in mm", "A in \xC2\xB0",
       "C1 in \xC2\xB0", "beam by (6) as printed off by"},
      {}};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const YinAxisCommands& c = commands[i];
    std::vector<std::string> row = {fmt::format("{}", i + 1)};
    for (const double v : {c.point.x(), c.point.y(), c.point.z()}) row.push_back(fmt::format("{:.3f}", v));
    for (const double v : {c.positive.x, c.positive.y, c.positive.z, c.positive.a / kDegree, c.positive.c1 / kDegree}) {
      row.push_back(fmt::format("{:.4f}", v));
    }
    row.push_back(fmt::format("{:.2f}\xC2\xB0", c.printed_beam_off / kDegree));
    table.rows.push_back(std::move(row));
  }
  return table;
}

EvaluationTable budget_table(const UncertaintyBudget& budget) {
  EvaluationTable table{"Uncertainty budget: standard uncertainty in \xC2\xB5m, root mean square over the points",
                        {"cause", "inputs", "across, by sensitivity", "across, by Monte Carlo", "along, by sensitivity",
                         "along, by Monte Carlo", "share"},
                        {}};
  const auto add = [&](const std::string& cause, std::size_t inputs, const std::vector<BudgetFigure>& kinds,
                       double share) {
    std::vector<std::string> row = {cause, fmt::format("{}", inputs)};
    for (const BudgetFigure& f : kinds) {
      row.push_back(fmt::format("{:.2f}", 1e3 * f.by_sensitivity));
      row.push_back(fmt::format("{:.2f} \xC2\xB1 {:.2f}", 1e3 * f.by_monte_carlo, 1e3 * f.monte_carlo_uncertainty));
    }
    row.push_back(fmt::format("{:.1f} %", 100 * share));
    table.rows.push_back(std::move(row));
  };
  for (const BudgetLine& line : budget.lines) add(line.cause, line.inputs, line.kinds, line.share);
  add("all", budget.inputs, budget.total, 1);
  return table;
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
          plot.svg()};
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
  return {"budget", "In the order of the table below.", plot.svg()};
}

/// The sections of the simulated part, as `abbe evaluate contour` shows its own.
nlohmann::json contour_block(const YinSections& sections) {
  ContourRequest request;
  request.edge = sections.options;
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
  nlohmann::json block = contour_sections_block(request, sections.sections, answers);
  block["title"] = "From the sections of one simulated part";
  return block;
}

}  // namespace

EvaluationReport yin_report(const YinResults& r) {
  EvaluationReport report;
  report.kind = "reproduce yin";
  report.title = "Multi-axis laser engraver: linkage, workpiece, contour error";
  report.standard = "Yin, Liu, Sun, Ding, Machines 9 (2021) 237, recomputed";
  report.facts = {{"reference (golden/yin)", r.agrees ? "met to 1e-9 mm" : "NOT met"},
                  {"simulated campaigns", fmt::format("{}", r.contour.budget.runs)},
                  {"inputs", fmt::format("{}", r.contour.budget.inputs)}};
  for (const std::string& failure : r.failures) report.notes.push_back("Not found: " + failure + ".");
  add_figures(report, "paper", "contour error as the paper measured it", kYinMeasured);
  report.tables = {linkage_table(r), positioning_table(r), equations_table(r.equations)};
  if (!r.positioning.failure.empty()) return report;
  add_figures(report, "predicted", "predicted contour error across the curve", r.contour.across);
  add_figures(report, "below95", "95 % of machines stay below", r.contour.upper);
  add_figures(report, "sections", "contour error from the sections of one simulated part", r.sections.found);
  add_figures(report, "P1P2", "P1 P2 of the same sections", r.sections.rounding);
  report.plots = {contour_plot(r), budget_plot(r.contour.budget)};
  report.page = {{"contour", contour_block(r.sections)}};
  report.tables.insert(report.tables.begin(), budget_table(r.contour.budget));
  report.tables.push_back(commands_table(r.commands));
  report.notes.emplace_back(
      "P1 P2, which the paper calls the contour error, is the rounding of the edge and does not depend on where the "
      "edge is; the contour error is the distance of P2 from the commanded curve.");
  report.notes.push_back(fmt::format("Both budgets differ by at most {:.1f} standard uncertainties of Monte Carlo.",
                                     r.contour.budget.largest_disagreement()));
  return report;
}

}  // namespace abbe
