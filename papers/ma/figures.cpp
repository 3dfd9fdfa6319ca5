#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"
#include "ma/results.h"

namespace abbe {
namespace {

constexpr PlotColour kMaColours[3] = {PlotColour::first, PlotColour::second, PlotColour::third};

/// What the caption of Figure 3 says of the formulas as printed: the angle and the displacement that they miss most.
std::string printed_words(const MaInversions& paper) {
  const SixMotions printed = in_ma_units(paper.printed), exact = in_ma_units(paper.simultaneous);
  const auto largest = [](const SixMotions& motions, std::size_t first) {
    const auto begin = motions.begin() + static_cast<std::ptrdiff_t>(first);
    return static_cast<std::size_t>(std::max_element(begin, begin + 3) - motions.begin());
  };
  const std::size_t angle = largest(printed, 0), length = largest(printed, 3);
  return fmt::format(
      "The formulas as printed miss {} by up to {:.0f} arcsec and {} by up to {:.0f} um; the exact inversion is right "
      "to within {:.0e} arcsec and {:.0e} um",
      kMaMotionNames[angle], printed[angle], kMaMotionNames[length], printed[length], exact[largest(exact, 0)],
      exact[largest(exact, 3)]);
}

/// Angles (first = 0) or displacements (first = 3) over the positions.
EvaluationPlot draw_figure_3(const MaResults& r, std::size_t first) {
  XyPlot plot(first == 0 ? "Figure 3a: angles found minus set" : "Figure 3b: displacements found minus set",
              "position of the table in \xC2\xB0", first == 0 ? "arcsec" : "\xC2\xB5m");
  plot.divide_x_in_degrees();
  plot.level(0, "", {PlotColour::soft, 1});
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<PlotPoint> points;
    for (std::size_t k = 0; k < r.positions.size(); ++k) {
      points.push_back({r.positions[k].angle / kDegree, in_ma_units(r.inversions[0].corrected_at[k])[first + i]});
    }
    plot.points(points, i == 0 ? Marker::circle : (i == 1 ? Marker::up : Marker::cross), {kMaColours[i]});
    plot.line(points, {kMaColours[i]}, kMaMotionNames[first + i]);
  }
  return {first == 0 ? "figure-3a" : "figure-3b",
          "Corrected formulas, paper order. " + printed_words(r.inversions[0]) + " (tables/figure-3.csv).",
          plot.picture()};
}

EvaluationPlot draw_figure_5(const MaTable& t, std::size_t motion) {
  const std::string name = kMaMotionNames[motion];
  XyPlot plot("Figure 5: " + name + " after the trigonometric fit", "position of the table in \xC2\xB0",
              motion < 3 ? "arcsec" : "\xC2\xB5m");
  plot.divide_x_in_degrees();
  std::vector<double> x, low, high;
  std::vector<PlotPoint> mean, truth;
  for (std::size_t k = 0; k < t.angles.size(); ++k) {
    const double angle = t.angles[k] / kDegree, value = in_ma_units(t.courses_fitted.mean[k])[motion],
                 half = in_ma_units(t.courses_fitted.half_range[k])[motion];
    x.push_back(angle);
    low.push_back(value - half);
    high.push_back(value + half);
    mean.push_back({angle, value});
    truth.push_back({angle, in_ma_units(t.courses_truth.mean[k])[motion]});
  }
  plot.level(0, "", {PlotColour::soft, 1});
  plot.band(x, low, high, {PlotColour::first, 0, false, 0.2}, "repeatability of the runs");
  plot.line(mean, {PlotColour::first, 1.8}, "mean of the runs");
  plot.points(mean, Marker::circle, {PlotColour::first});
  plot.line(truth, {PlotColour::second, 1.4, true}, "what the simulated table did");
  return {fmt::format("figure-5-{}", name), "", plot.picture()};
}

}  // namespace

std::vector<EvaluationPlot> ma_figures(const MaResults& r) {
  std::vector<EvaluationPlot> plots = {draw_figure_3(r, 0), draw_figure_3(r, 3)};
  for (std::size_t motion = 0; motion < 6; ++motion) plots.push_back(draw_figure_5(r.table, motion));
  plots[2].caption =
      fmt::format("{} runs of a simulated table: the measurements of the paper are not published.", kMaRuns);
  return plots;
}

}  // namespace abbe
