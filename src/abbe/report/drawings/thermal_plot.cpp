#include "abbe/report/drawings/thermal_plot.h"

#include <algorithm>
#include <array>
#include <utility>

#include "abbe/report/drawings/thinned.h"

namespace abbe {
namespace {

constexpr std::array<PlotColour, 6> kCurveColours = {PlotColour::first,  PlotColour::second, PlotColour::third,
                                                     PlotColour::fourth, PlotColour::fifth,  PlotColour::sixth};
constexpr int kFitSteps = 100;

}  // namespace

ShownTime shown_time(double from, double to) {
  return to - from >= 3 * 3600 ? ShownTime{from, 3600, "h"} : ShownTime{from, 60, "min"};
}

XyPlot thermal_plot(const std::vector<ThermalCurve>& curves, const ShownTime& time, const ThermalPlotWords& words,
                    const std::optional<double>& mark) {
  XyPlot plot(words.title, words.time, words.value);
  double low = 0, high = 0;
  bool has_fit = false;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ThermalCurve& curve = curves[i];
    std::vector<PlotPoint> points;
    for (const std::size_t k : thinned(curve.series->values)) {
      const double value = (curve.series->values[k] - curve.origin) * curve.factor;
      points.push_back({time.number(curve.series->time[k]), value});
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const PlotColour colour = kCurveColours[i % kCurveColours.size()];
    plot.line(std::move(points), {colour, 1.6, i >= kCurveColours.size()}, curve.name);
    for (const FirstOrderResponse& response : curve.responses) {
      if (response.status != ResponseStatus::done) continue;
      std::vector<PlotPoint> fit;
      for (int k = 0; k <= kFitSteps; ++k) {
        const double at = response.from + (response.to - response.from) * k / kFitSteps;
        fit.push_back({time.number(at), (response.at(at) - curve.origin) * curve.factor});
      }
      plot.line(std::move(fit), {PlotColour::ink, 1, true}, has_fit ? "" : words.fit);
      has_fit = true;
    }
  }
  if (mark && high > low) {
    const double at = time.number(*mark);
    plot.line({{at, low}, {at, high}}, {PlotColour::soft, 1, true}, words.mark);
  }
  return plot;
}

}  // namespace abbe
