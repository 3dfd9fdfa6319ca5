// Curves of error motions of several campaigns.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/drawings/svg_plot.h"
#include "abbe/study/comparison/compared_report.h"

namespace abbe {
namespace {

constexpr std::array kCampaignColours = {PlotColour::first,  PlotColour::second, PlotColour::third,
                                         PlotColour::fourth, PlotColour::fifth,  PlotColour::sixth};
constexpr double kBandOpacity = 0.2;
// Curves of 61 points look the same as those of 121, and the page stays small.
constexpr std::size_t kDrawnStep = 2;

PlotColour campaign_colour(std::size_t campaign) { return kCampaignColours[campaign % kCampaignColours.size()]; }

/// Plots of the error motion of one name.
class MotionPlots {
 public:
  MotionPlots(const ComparedCampaigns& result, const ComparedError& error)
      : result_(result), error_(error), axis_(result.machine.axes[error.axis]), angle_(error.is_angle) {}

  EvaluationPlot curves() const {
    XyPlot plot = empty_plot(fmt::format("{}: {}", error_.name, error_.words), error_.name);
    bool first_drawn = false;
    for (const auto& [pair, error] : against_first()) {
      const ComparedCurve& curve = error->curve;
      if (!first_drawn) draw(plot, 0, curve.position, curve.first, curve.u_first, legend_of(0));
      first_drawn = true;
      draw(plot, pair->second, curve.position, curve.second, curve.u_second, legend_of(pair->second));
    }
    return {error_.name, caption_of("Campaigns with their bands of k = 2"), plot.picture(), false, true};
  }

  EvaluationPlot change() const {
    XyPlot plot = empty_plot(fmt::format("{}: change", error_.name), "change of " + error_.name);
    for (const auto& [pair, error] : against_first()) {
      const ComparedCurve& curve = error->curve;
      draw(plot, pair->second, curve.position, curve.change, curve.u_change, pair_words(*pair));
    }
    plot.level(0, "", {PlotColour::soft, 1, true, 1});
    return {error_.name + "-change", caption_of("Change with its band of k = 2"), plot.picture(), false, true};
  }

 private:
  std::vector<std::pair<const ComparedPair*, const ComparedError*>> against_first() const {
    std::vector<std::pair<const ComparedPair*, const ComparedError*>> found;
    for (const ComparedPair& pair : result_.pairs) {
      if (pair.first != 0) continue;
      for (const ComparedError& error : pair.errors) {
        if (error.name == error_.name && !error.curve.position.empty()) found.emplace_back(&pair, &error);
      }
    }
    return found;
  }

  XyPlot empty_plot(const std::string& title, const std::string& what) const {
    const bool rotary = axis_.kind == AxisKind::rotary;
    XyPlot plot(title, fmt::format("position of {} in {}", axis_.name, rotary ? "\xC2\xB0" : "mm"),
                fmt::format("{} in {}", what, angle_ ? "\xC2\xB5rad" : "\xC2\xB5m"));
    if (rotary) plot.divide_x_in_degrees();
    plot.include_y(0);
    return plot;
  }

  void draw(XyPlot& plot, std::size_t campaign, const std::vector<double>& position, const std::vector<double>& value,
            const std::vector<double>& uncertainty, const std::string& legend) const {
    const double micro = micro_per_unit(angle_);
    std::vector<PlotPoint> points;
    std::vector<double> x, low, high;
    for (std::size_t i = 0; i < position.size(); i += kDrawnStep) {
      x.push_back(position[i] / position_unit(axis_));
      points.push_back({x.back(), micro * value[i]});
      if (uncertainty.empty()) continue;
      low.push_back(micro * (value[i] - 2 * uncertainty[i]));
      high.push_back(micro * (value[i] + 2 * uncertainty[i]));
    }
    if (!uncertainty.empty()) plot.band(x, low, high, {campaign_colour(campaign), 1, false, kBandOpacity});
    plot.line(std::move(points), {campaign_colour(campaign)}, legend);
  }

  std::string legend_of(std::size_t campaign) const {
    return fmt::format("{} {}", campaign_letter(campaign), result_.names[campaign]);
  }

  std::string caption_of(const std::string& what) const {
    std::string changed;
    for (const auto& [pair, error] : against_first()) {
      if (error->verdict == ChangeVerdict::changed) changed += (changed.empty() ? "" : ", ") + pair_words(*pair);
    }
    return changed.empty() ? what : what + "; significant: " + changed;
  }

  const ComparedCampaigns& result_;
  const ComparedError& error_;
  const Axis& axis_;
  bool angle_;
};

}  // namespace

std::vector<EvaluationPlot> comparison_plots(const ComparedCampaigns& result) {
  std::vector<EvaluationPlot> plots;
  std::vector<const ComparedError*> motions;
  for (const ComparedPair& pair : result.pairs) {
    if (pair.first != 0) continue;
    for (const ComparedError& error : pair.errors) {
      const bool listed =
          std::any_of(motions.begin(), motions.end(), [&](const auto* one) { return one->name == error.name; });
      if (error.is_motion && !error.curve.position.empty() && !listed) motions.push_back(&error);
    }
  }
  for (const ComparedError* const error : motions) {
    const MotionPlots of(result, *error);
    plots.push_back(of.curves());
    plots.push_back(of.change());
  }
  return plots;
}

}  // namespace abbe
