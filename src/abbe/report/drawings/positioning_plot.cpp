#include "abbe/report/drawings/positioning_plot.h"

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

/// From inside units to those drawn.
struct Scale {
  double position = 1, deviation = 1e3;
  explicit Scale(bool rotary) : position(rotary ? 1 / kDegree : 1), deviation(rotary ? 1 / kArcsec : 1e3) {}
};

std::vector<PlotPoint> means(const PositioningEvaluation& evaluation, std::size_t side, const Scale& scale) {
  std::vector<PlotPoint> points;
  for (const PositioningTarget& target : evaluation.targets) {
    if (target.runs[side] == 0) continue;
    points.push_back({target.position * scale.position, target.mean[side] * scale.deviation});
  }
  return points;
}

void draw_side(XyPlot& plot, const PositioningEvaluation& evaluation, std::size_t side, const Scale& scale,
               const PositioningPlotWords& words) {
  const PlotColour colour = side == 0 ? PlotColour::first : PlotColour::second;
  if (evaluation.unidirectional_repeatability[side].is_evaluated()) {
    std::vector<double> x, low, high;
    for (const PositioningTarget& target : evaluation.targets) {
      x.push_back(target.position * scale.position);
      low.push_back((target.mean[side] - 2 * target.deviation[side]) * scale.deviation);
      high.push_back((target.mean[side] + 2 * target.deviation[side]) * scale.deviation);
    }
    plot.band(x, low, high, {colour, 0, false, 0.16}, words.band);
  }
  const std::vector<PlotPoint> points = means(evaluation, side, scale);
  if (points.empty()) return;
  plot.line(points, {colour, 1.8}, words.means[side]);
  plot.points(points, side == 0 ? Marker::up : Marker::down, {colour});
}

}  // namespace

PositioningPlotWords english_plot_words(bool rotary) {
  return {.position = rotary ? "target position in \xC2\xB0" : "target position in mm",
          .deviation = rotary ? "deviation in arcsec" : "deviation in \xC2\xB5m",
          .means = {"mean, positive approach", "mean, negative approach"},
          .band = "mean \xC2\xB1 2s",
          .bidirectional_mean = "bidirectional mean"};
}

SvgPicture positioning_plot(const PositioningEvaluation& evaluation, bool rotary, const std::string& title) {
  return positioning_plot(evaluation, rotary, title, english_plot_words(rotary));
}

SvgPicture positioning_plot(const PositioningEvaluation& evaluation, bool rotary, const std::string& title,
                            const PositioningPlotWords& words) {
  const Scale scale(rotary);
  XyPlot plot(title, words.position, words.deviation);
  if (rotary) plot.divide_x_in_degrees();
  for (const std::size_t side : {0U, 1U}) draw_side(plot, evaluation, side, scale, words);
  if (evaluation.mean_bidirectional.figure.is_evaluated()) {
    std::vector<PlotPoint> points;
    for (const PositioningTarget& target : evaluation.targets) {
      points.push_back({target.position * scale.position, target.mean_bidirectional.value * scale.deviation});
    }
    plot.line(points, {PlotColour::soft, 1.2, true}, words.bidirectional_mean);
  }
  const auto at = [&](std::size_t target, double deviation) {
    return PlotPoint{evaluation.targets[target].position * scale.position, deviation * scale.deviation};
  };
  const PlotStyle ink{PlotColour::ink, 1.2};
  const auto outer = [&](const PositioningEvaluation::Span& span, const char* name) {
    if (!span.figure.is_evaluated()) return;
    plot.outer_dimension(at(span.low_at, span.low), at(span.high_at, span.high), name, ink);
  };
  outer(evaluation.systematic, "E");
  outer(evaluation.accuracy, "A");
  const auto& repeatability = evaluation.repeatability;
  if (repeatability.figure.is_evaluated()) {
    const PlotPoint low = at(repeatability.low_at, repeatability.low);
    plot.dimension(low.x, low.y, repeatability.high * scale.deviation, "R", ink);
  }
  if (evaluation.reversal.is_evaluated()) {
    const PositioningTarget& target = evaluation.targets[evaluation.reversal_at];
    const PlotPoint first = at(evaluation.reversal_at, target.mean[0]);
    // Beside R, which often stands at the same target, and away from its name.
    const double middle = evaluation.targets.front().position + evaluation.span() / 2;
    plot.dimension(first.x, first.y, target.mean[1] * scale.deviation, "B", ink, target.position > middle ? -22 : 22);
  }
  return plot.picture();
}

SvgPicture diagonals_plot(const DiagonalsEvaluation& evaluation, const std::string& title) {
  constexpr PlotColour kColours[] = {PlotColour::first,  PlotColour::second, PlotColour::third,
                                     PlotColour::fourth, PlotColour::fifth,  PlotColour::sixth};
  const Scale scale(false);
  XyPlot plot(title, "distance along the diagonal in mm", "deviation in \xC2\xB5m");
  for (std::size_t i = 0; i < evaluation.diagonals.size(); ++i) {
    const PlotColour colour = kColours[i % std::size(kColours)];
    for (const std::size_t side : {0U, 1U}) {
      const std::vector<PlotPoint> points = means(evaluation.diagonals[i].positioning, side, scale);
      if (points.empty()) continue;
      plot.line(points, {colour, 1.6, side == 1}, evaluation.diagonals[i].name + (side == 0 ? ", there" : ", back"));
      plot.points(points, side == 0 ? Marker::up : Marker::down, {colour});
    }
  }
  return plot.picture();
}

}  // namespace abbe
