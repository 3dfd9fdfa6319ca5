#include "abbe/report/evaluations/linkage_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

constexpr const char* kLinkageWords[SwingHeadLinkage::kCount] = {
    "from the axis of A to the focus, along the beam",
    "from the axis of C1 to the beam, along the axis of A",
    "offset of the beam from the axis of A",
    "offset of the axis of A from that of C1",
    "X at which the axes of C1 and C2 coincide",
    "Y at which the axes of C1 and C2 coincide",
    "Z at which the axis of A is level with the table",
};

void add_parameters(EvaluationReport& report, const LinkageEvaluation& found, bool stated) {
  const auto values = found.linkage.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    EvaluationFigure figure;
    figure.symbol = linkage_name(i);
    figure.name = kLinkageWords[i];
    figure.unit = "mm";
    figure.decimals = 4;
    figure.value = values[i];
    if (stated) figure.uncertainty = 2 * found.standard_uncertainty(i);
    report.figures.push_back(figure);
  }
}

/// Errors of the machine whose nominal linkage the readings were taken with.
void add_errors(EvaluationReport& report, const Machine& machine, const LinkageErrors& errors, bool stated) {
  const std::vector<std::string> names = parameter_names(machine, errors.errors);
  const std::vector<double> values = errors.errors.parameters();
  for (std::size_t i = 0; i < values.size(); ++i) {
    EvaluationFigure figure;
    figure.symbol = names[i];
    figure.name = names[i].starts_with("tool") ? "tool offset error" : "location error";
    figure.decimals = 1;
    figure.value = values[i];
    const auto k = static_cast<Eigen::Index>(i);
    if (stated) figure.uncertainty = 2 * std::sqrt(std::max(0.0, errors.covariance(k, k)));
    report.figures.push_back(figure);
  }
}

EvaluationPlot focus_plot(const LinkageReadings& readings, const LinkageEvaluation& found) {
  XyPlot plot("Widths of the lines of step 2", "Z in mm", "width in \xC2\xB5m");
  std::vector<PlotPoint> widths, fitted;
  for (std::size_t i = 0; i < readings.focus_z.size(); ++i) {
    widths.push_back({readings.focus_z[i], 1e3 * readings.focus_width[i]});
  }
  const auto [low, high] = std::minmax_element(readings.focus_z.begin(), readings.focus_z.end());
  constexpr int kSteps = 80;
  for (int i = 0; i <= kSteps; ++i) {
    const double z = *low + (*high - *low) * i / kSteps;
    fitted.push_back({z, 1e3 * std::hypot(found.waist, found.divergence * (z - found.focus_z))});
  }
  plot.include_y(0);
  plot.line(fitted, {PlotColour::first, 1.6}, "fitted beam");
  plot.points(widths, Marker::circle, {PlotColour::second, 1.4}, "readings");
  plot.points({{found.focus_z, 1e3 * found.waist}}, Marker::cross, {PlotColour::ink, 2}, "focus z2");
  return {"plot", "The lowest point of the parabola through the squared widths is the focus, not the thinnest line.",
          plot.picture()};
}

EvaluationTable printed_table(const LinkageEvaluation& found) {
  EvaluationTable table{"The same readings by the printed equations (9) to (12) and step 3",
                        {"parameter", "corrected in mm", "printed in mm", "difference in \xC2\xB5m"},
                        {}};
  const auto right = found.linkage.values(), printed = found.printed.values();
  for (std::size_t i = 0; i < right.size(); ++i) {
    table.rows.push_back({linkage_name(i), fmt::format("{:.4f}", right[i]), fmt::format("{:.4f}", printed[i]),
                          fmt::format("{:.1f}", 1e3 * (printed[i] - right[i]))});
  }
  return table;
}

EvaluationTable cause_table(const LinkageEvaluation& found) {
  EvaluationTable table{"Standard uncertainties by cause in \xC2\xB5m", {"cause"}, {}};
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) table.headers.emplace_back(linkage_name(i));
  for (const LinkageShare& share : found.shares) {
    std::vector<std::string> row = {share.cause};
    for (Eigen::Index i = 0; i < share.variance.size(); ++i) {
      row.push_back(fmt::format("{:.2f}", 1e3 * std::sqrt(share.variance[i])));
    }
    table.rows.push_back(std::move(row));
  }
  std::vector<std::string> all = {"all"};
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    all.push_back(fmt::format("{:.2f}", 1e3 * found.standard_uncertainty(i)));
  }
  table.rows.push_back(std::move(all));
  return table;
}

}  // namespace

EvaluationReport linkage_report(const std::string& title, const LinkageReadings& readings,
                                const LinkageEvaluation& found, bool stated, const Machine* machine,
                                const LinkageErrors* errors) {
  EvaluationReport report;
  report.kind = "linkage";
  report.title = title;
  report.standard = "Yin et al., Machines 9 (2021) 237, section 3.1, corrected";
  const bool table_moves = readings.convention == LinkageConvention::table_moves;
  report.facts = {
      {"axes", table_moves ? "X and Y carry the table, Z the head" : "X, Y and Z carry the head"},
      {"widths",
       fmt::format("{}; focus at Z = {:.4f} mm, waist {:.1f} \xC2\xB5m, divergence {:.2f} mrad, thinnest line "
                   "at Z = {:.4f} mm",
                   readings.focus_z.size(), found.focus_z, 1e3 * found.waist, 1e3 * found.divergence,
                   found.thinnest_z)},
      {"marks of the circle",
       readings.circle_marks.empty()
           ? "none, brought to a point"
           : fmt::format("{}; radius {:.4f} mm", readings.circle_marks.size(), found.circle_arm.norm())}};
  add_parameters(report, found, stated);
  if (errors != nullptr) {
    report.facts.emplace_back("machine", machine->name);
    add_errors(report, *machine, *errors, stated);
  }
  if (stated) report.tables.push_back(cause_table(found));
  report.tables.push_back(printed_table(found));
  report.plots.push_back(focus_plot(readings, found));
  report.notes.push_back(fmt::format(
      "A zero error of A cannot be told from L_tA and R_A: an arcsecond of it looks like {:.2f} \xC2\xB5m of "
      "L_tA.",
      1e3 * found.linkage.focus_to_a * kArcsec));
  return report;
}

}  // namespace abbe
