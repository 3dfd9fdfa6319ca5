#include <fmt/format.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_map_plot.h"
#include "abbe/report/drawings/svg_plot.h"
#include "liu/results.h"

namespace abbe {
namespace {

constexpr PlotColour kLiuColours[6] = {PlotColour::first,  PlotColour::second, PlotColour::third,
                                       PlotColour::fourth, PlotColour::fifth,  PlotColour::sixth};
constexpr const char* kMicrometres = "\xC2\xB5m";

EvaluationPlot draw_figure_4b(const LiuFigureStudy& study) {
  XyPlot plot("Figure 4b: section of a cylinder clamped wrongly", "position of C in \xC2\xB0",
              std::string("distance from the axis of C less 10 mm in ") + kMicrometres);
  plot.divide_x_in_degrees();
  plot.level(0, "", {PlotColour::soft, 1});
  for (std::size_t i = 0; i < study.clamped.size(); ++i) {
    const LiuSection& s = study.clamped[i].sections.front();
    std::vector<PlotPoint> points;
    for (std::size_t k = 0; k < s.angle.size(); ++k) {
      points.push_back({s.angle[k] / kDegree, 1e3 * (s.distance[k] - kLiuRadius)});
    }
    plot.line(points, {kLiuColours[i]}, study.clamped[i].words);
  }
  return {"figure-4b", fmt::format("Perfect machine, section {:.0f} mm above the middle.", kLiuClampingHeight),
          plot.picture()};
}

/// The line along the cylinder in the middle of each patch.
EvaluationPlot draw_figure_6(const LiuPlaces& places, const std::string& stage) {
  XyPlot plot("Figure 6: patches of the cylinder on stage " + stage, "along the cylinder in mm",
              "height of the surface in mm");
  for (std::size_t q = 0; q < kLiuQuarters; ++q) {
    std::vector<PlotPoint> measured, found, nominal;
    for (std::size_t i = 0; i < kLiuAlong; ++i) {
      const double x = 2.0 * (static_cast<double>(i) - 6);
      const std::size_t k = i * kLiuAcross + kLiuAcross / 2;
      measured.push_back({x, places.measured[q][k]});
      found.push_back({x, places.found[q][k]});
      nominal.push_back({x, places.nominal[q][k]});
    }
    plot.line(nominal, {kLiuColours[q], 1.2, true});
    plot.line(found, {kLiuColours[q]}, fmt::format("{} degrees", 90 * q));
    plot.points(measured, Marker::circle, {kLiuColours[q]});
  }
  return {
      "figure-6-" + stage,
      "Middle line of each patch, shifts of Table 3 in um. Circles: measured; lines: virtual, turned about the axis "
      "found; dashed: about the nominal axis.",
      plot.picture()};
}

EvaluationPlot draw_remaining(const LiuPlaces& places, const std::string& name, const std::string& title,
                              const std::string& along, const std::string& caption) {
  // Across to the right, along upwards, as in the XOY plane of stage C.
  MapPlot map(title, {"across in mm", -4, 4, kLiuAcross}, {along + " in mm", -12, 12, kLiuAlong}, kMicrometres);
  for (std::size_t q = 0; q < kLiuQuarters; ++q) {
    std::vector<double> values = places.remaining(q);
    for (double& value : values) value *= 1e3;
    map.add({fmt::format("{} degrees", 90 * q), std::move(values)});
  }
  return {name, caption, map.picture()};
}

EvaluationPlot draw_figure_9(const LiuFigureStudy& study, bool corrected) {
  XyPlot plot(corrected ? "Figure 9, after compensation: profile of the cylinder"
                        : "Figure 9, before compensation: profile of the cylinder",
              std::string("generator less its nominal place, along x, in ") + kMicrometres, "height in mm");
  std::size_t colour = 0;
  for (const LiuProfile& p : study.corrected) {
    if (p.words.starts_with("compensated") != corrected) continue;
    std::vector<PlotPoint> right, left;
    for (const LiuSection& section : p.sections) {
      right.push_back({1e3 * (section.x + section.radius - kLiuRadius), section.height});
      left.push_back({1e3 * (section.x - section.radius + kLiuRadius), section.height});
    }
    plot.line(right, {kLiuColours[colour]}, p.words);
    plot.line(left, {kLiuColours[colour], 1.6, true});
    plot.points(right, Marker::circle, {kLiuColours[colour]});
    plot.points(left, Marker::cross, {kLiuColours[colour]});
    ++colour;
  }
  const std::string caption =
      "Generators at +x (lines) and at -x (dashed), shifts of Table 3 in um: both lean alike on an oblique cylinder, "
      "against each other on a cone.";
  return {corrected ? "figure-9-after" : "figure-9-before", caption, plot.picture()};
}

EvaluationPlot draw_figure_11b(const LiuRepeats& repeats, const std::string& name) {
  XyPlot plot("Figure 11b: four measurements, " + repeats.words, "position of C in \xC2\xB0",
              std::string("distance from the axis less the radius in ") + kMicrometres);
  plot.divide_x_in_degrees();
  plot.level(0, "", {PlotColour::soft, 1});
  constexpr std::size_t kMiddle = LiuRepeats::kLines / 2;
  for (std::size_t run = 0; run < LiuRepeats::kRuns; ++run) {
    std::vector<PlotPoint> points;
    for (std::size_t k = 0; k < LiuRepeats::kSteps; ++k) {
      points.push_back({5.0 * static_cast<double>(k), 1e3 * repeats.deviations[run][kMiddle * LiuRepeats::kSteps + k]});
    }
    plot.line(points, {kLiuColours[run], 1.2}, fmt::format("run {}", run + 1));
  }
  return {name, fmt::format("Line in the middle of the cylinder; correlation of the runs {:.3f}.", repeats.correlation),
          plot.picture()};
}

}  // namespace

std::vector<EvaluationPlot> liu_figures(const LiuFigureStudy& study) {
  if (!study.complete()) return {};
  const LiuClampingStudy& s = study.micrometres();
  const std::string caption =
      fmt::format("Virtual minus measured with the noise of Table 2; from exact readings {:.0e} um are left at most.",
                  1e3 * liu_exact_remainder(study, true));
  return {
      draw_figure_4b(study),
      draw_figure_6(s.exact.a.places, "A"),
      draw_figure_6(s.exact.c.places, "C"),
      draw_remaining(s.noisy.a.places, "figure-7-A", "Figure 7: what the calibration of stage A leaves", "X", caption),
      draw_remaining(s.noisy.c.places, "figure-7-C", "Figure 7: what the calibration of stage C leaves", "Y", caption),
      draw_remaining(s.noisy.clamping.places, "figure-8", "Figure 8: what the calibration of the clamping leaves", "Y",
                     fmt::format("Virtual minus measured with the noise of Table 2; from exact readings {:.0e} um "
                                 "are left at most.",
                                 1e3 * liu_exact_remainder(study, false))),
      draw_figure_9(study, false),
      draw_figure_9(study, true),
      draw_figure_11b(study.repeats[0], "figure-11b-exact"),
      draw_figure_11b(study.repeats[1], "figure-11b-taper"),
      draw_figure_11b(study.repeats[2], "figure-11b-lobes")};
}

}  // namespace abbe
