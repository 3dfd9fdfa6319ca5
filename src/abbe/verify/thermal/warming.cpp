#include "abbe/verify/thermal/warming.h"

#include <algorithm>
#include <utility>

namespace abbe {

WarmingSensor warming_of(ThermalSensor sensor, const WarmingRun& run) {
  const TimeSeries& series = sensor.series;
  const double start = std::clamp(run.start, series.from(), series.to());
  const double stop = std::clamp(run.stop, start, series.to());
  WarmingSensor one;
  one.value_at_start = value_at(series, start);
  one.first_hour = first_hour_figure(sensor, start, stop);
  one.running = range_figure(sensor, start, stop);
  one.change_at_stop = value_at(series, stop) - one.value_at_start;
  one.change_at_end = series.values.back() - one.value_at_start;
  one.warming = first_order_response(series, start, stop, sensor.reading_uncertainty);
  if (run.has_cooling() && series.to() > stop) {
    one.cooling = range_figure(sensor, stop, series.to());
    one.recovery = first_order_response(series, stop, series.to(), sensor.reading_uncertainty);
  }
  one.sensor = std::move(sensor);
  return one;
}

}  // namespace abbe
