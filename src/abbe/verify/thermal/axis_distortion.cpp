#include "abbe/verify/thermal/axis_distortion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

namespace abbe {
namespace {

/// The deviation at the last target less that at the first, less its first value, at all times at which one was read.
TimeSeries distance_between(const TimeSeries& first, const TimeSeries& last, double from, double to) {
  std::set<double> times = {from, to};
  for (const TimeSeries* const series : {&first, &last}) {
    for (const double time : series->time) {
      if (time > from && time < to) times.insert(time);
    }
  }
  TimeSeries distance{"distance", {}, {}};
  for (const double time : times) {
    distance.time.push_back(time);
    distance.values.push_back(value_at(last, time) - value_at(first, time));
  }
  const double start = distance.values.front();
  for (double& value : distance.values) value -= start;
  return distance;
}

/// Nothing if no time lies between the readings of all targets.
std::optional<AxisExpansion> expansion_of(const std::vector<const AxisTargetReadings*>& targets, double u) {
  double from = -std::numeric_limits<double>::infinity(), to = -from, mean = 0;
  const double n = static_cast<double>(targets.size());
  for (const AxisTargetReadings* const one : targets) {
    from = std::max(from, one->deviation.from());
    to = std::min(to, one->deviation.to());
    mean += one->target / n;
  }
  if (!(to > from)) return std::nullopt;
  AxisExpansion result;
  result.approach = targets.front()->approach;
  result.length = targets.back()->target - targets.front()->target;
  result.distance = distance_between(targets.front()->deviation, targets.back()->deviation, from, to);
  // Each value of the distance is a difference of two readings.
  const double u_distance = std::numbers::sqrt2 * u;
  result.range = range_figure({result.distance, false, u_distance}, from, to);
  double squares = 0;
  for (const AxisTargetReadings* const one : targets) squares += (one->target - mean) * (one->target - mean);
  for (const AxisTargetReadings* const one : targets) {
    const double change = value_at(one->deviation, to) - value_at(one->deviation, from);
    result.expansion += (one->target - mean) / squares * change;
  }
  result.expansion_uncertainty = u_distance / std::sqrt(squares);
  result.response = first_order_response(result.distance, from, to, u_distance);
  return result;
}

}  // namespace

AxisDistortion evaluate_axis_distortion(const AxisDistortionReadings& readings, const ThermalUncertainty& uncertainty) {
  AxisDistortion result;
  result.temperatures = readings.temperatures;
  result.from = std::numeric_limits<double>::infinity();
  result.to = -result.from;
  std::size_t number = 0;
  std::vector<std::string> approaches;
  for (const AxisTargetReadings& one : readings.targets) {
    if (result.targets.empty() || result.targets.back().target != one.target) ++number;
    AxisTarget target{one.target, number, one.approach, {}};
    const auto add = [&](const TimeSeries& series, bool is_angle, bool is_deviation) {
      result.from = std::min(result.from, series.from());
      result.to = std::max(result.to, series.to());
      AxisTargetSensor sensor{
          {series, is_angle, is_angle ? uncertainty.angle : uncertainty.displacement}, is_deviation, {}, 0};
      sensor.change = range_figure(sensor.sensor, series.from(), series.to());
      sensor.change_at_end = series.values.back() - series.values.front();
      target.sensors.push_back(std::move(sensor));
    };
    add(one.deviation, false, true);
    for (const TimeSeries& series : one.displacements) add(series, false, false);
    for (const TimeSeries& series : one.angles) add(series, true, false);
    result.targets.push_back(std::move(target));
    if (std::find(approaches.begin(), approaches.end(), one.approach) == approaches.end()) {
      approaches.push_back(one.approach);
    }
  }
  for (const std::string& approach : approaches) {
    std::vector<const AxisTargetReadings*> targets;
    for (const AxisTargetReadings& one : readings.targets) {
      if (one.approach == approach) targets.push_back(&one);
    }
    if (targets.size() < 2) continue;
    if (auto expansion = expansion_of(targets, uncertainty.displacement)) result.expansions.push_back(*expansion);
  }
  return result;
}

}  // namespace abbe
