#pragma once

// Internal to report: what sensors of a thermal test read, over time.
#include <optional>
#include <string>
#include <vector>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/verify/thermal/first_order_response.h"

namespace abbe {

/// Unit in which times of a test are shown: hours from three hours on, else minutes.
struct ShownTime {
  double from = 0;   ///< s: shown as 0
  double unit = 60;  ///< s
  const char* name = "min";
  double number(double time) const { return (time - from) / unit; }
};
ShownTime shown_time(double from, double to);

/// A line of the plot: (value - origin) * factor.
struct ThermalCurve {
  const TimeSeries* series = nullptr;
  double origin = 0, factor = 1;
  std::string name{};                           ///< in the legend
  std::vector<FirstOrderResponse> responses{};  ///< fits to draw, those that are done
};

struct ThermalPlotWords {
  std::string title, time, value;  ///< of the axes with their units
  std::string fit{};               ///< legend of the fits
  std::string mark{};              ///< legend of the mark
};

/// @param mark  a time, s, at which a line stands; nothing: none
XyPlot thermal_plot(const std::vector<ThermalCurve>& curves, const ShownTime& time, const ThermalPlotWords& words,
                    const std::optional<double>& mark = std::nullopt);

}  // namespace abbe
