#include <algorithm>
#include <numbers>

#include "abbe/instruments/measurement_plan.h"
#include "abbe/report/drawings/svg_map_plot.h"
#include "abbe/report/drawings/svg_plot.h"
#include "aguado/tables.h"

namespace abbe {
namespace {

constexpr std::size_t kHistogramClasses = 24, kMapX = 29, kMapZ = 13, kMapC = 12;

/// Outline of a histogram in um over the middle of its classes.
void add_histogram(XyPlot& plot, std::span<const double> distances, double largest, const PlotStyle& style,
                   const std::string& legend) {
  const Histogram counts = histogram(distances, 0, largest, kHistogramClasses);
  std::vector<double> x, zero, share;
  for (std::size_t i = 0; i < counts.counts.size(); ++i) {
    const double percent = 100.0 * static_cast<double>(counts.counts[i]) / static_cast<double>(distances.size());
    for (const std::size_t edge : {i, i + 1}) {
      x.push_back(1e3 * (counts.from + counts.width * static_cast<double>(edge)));
      zero.push_back(0);
      share.push_back(percent);
    }
  }
  PlotStyle area = style;
  area.opacity = 0.18;
  plot.band(x, zero, share, area);
  std::vector<PlotPoint> outline;
  for (std::size_t i = 0; i < x.size(); ++i) outline.push_back({x[i], share[i]});
  plot.line(outline, style, legend);
}

XyPlot histogram_plot(const char* title) {
  XyPlot plot(title, "volumetric error in \xC2\xB5m", "share of the poses in %");
  plot.include_y(0);
  return plot;
}

/// Mean over C at every place of X and Z, um.
std::vector<double> map_over_xz(const AguadoTruth& truth, const ErrorSet& errors, const TrackerSetup& setup) {
  const double step = 2 * std::numbers::pi / kMapC;
  std::vector<double> mean(kMapX * kMapZ);
  for (std::size_t c = 0; c < kMapC; ++c) {
    PoseList poses;
    for (std::size_t j = 0; j < kMapZ; ++j) {
      for (std::size_t i = 0; i < kMapX; ++i) {
        poses.append(std::vector<double>{step * static_cast<double>(c), 1400.0 * static_cast<double>(i) / (kMapX - 1),
                                         600.0 * static_cast<double>(j) / (kMapZ - 1)});
      }
    }
    const std::vector<double> distances = aguado_distances(truth, errors, setup, poses);
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += 1e3 * distances[k] / kMapC;
  }
  return mean;
}

}  // namespace

AguadoFigures aguado_figures(const AguadoTruth& truth, const std::vector<AguadoRow>& rows) {
  const auto find = [&](auto&& is_it) {
    return std::find_if(rows.begin(), rows.end(), [&](const AguadoRow& row) {
      return row.experiment == AguadoExperiment::table_3 && is_it(row);
    });
  };
  const AguadoFit& as_paper = find([](const AguadoRow& row) { return row.as_paper; })->fit;
  const AguadoFit& complete = find([](const AguadoRow& row) { return row.order == 4; })->fit;
  const PoseList poses = random_plan(aguado_machine(), full_ranges(aguado_machine(), 2), 2000, 6);
  const std::vector<double> before = aguado_distances(truth, {}, truth.setup, poses);
  const std::vector<double> third = aguado_distances(truth, as_paper.identification.errors, as_paper.setup, poses);
  const std::vector<double> fourth = aguado_distances(truth, complete.identification.errors, complete.setup, poses);
  AguadoFigures figures;
  figures.before = sample_statistics(before);
  figures.as_paper = sample_statistics(third);
  figures.complete = sample_statistics(fourth);

  const std::string third_words = "order 3, C by (15) as printed", fourth_words = "order 4, 4 harmonics and a constant";
  XyPlot uncompensated = histogram_plot("Figure 6, left: uncompensated errors");
  add_histogram(uncompensated, before, figures.before.maximum, {PlotColour::limit}, "nominal machine");
  XyPlot compensated = histogram_plot("Figure 6, right: compensated errors");
  const double largest = std::max(figures.as_paper.maximum, figures.complete.maximum);
  add_histogram(compensated, third, largest, {PlotColour::second}, third_words);
  add_histogram(compensated, fourth, largest, {PlotColour::first}, fourth_words);
  MapPlot map("Figure 7: volumetric error over the workspace, mean over C", {"X in mm", 0, 1400, kMapX},
              {"Z in mm", 0, 600, kMapZ}, "\xC2\xB5m");
  map.add({"uncompensated", map_over_xz(truth, {}, truth.setup)});
  map.add({"compensated: " + third_words, map_over_xz(truth, as_paper.identification.errors, as_paper.setup)});
  map.add({"compensated: " + fourth_words, map_over_xz(truth, complete.identification.errors, complete.setup)});
  figures.plots = {
      {"figure-6-before", "2,000 random poses that were not measured, first reflector.", uncompensated.picture()},
      {"figure-6-after", "The same poses after the joint characterisation of Table 3.", compensated.picture()},
      {"figure-7", "Every map has a scale of its own. The paper prints no numbers with its figures.", map.picture()}};
  return figures;
}

}  // namespace abbe
