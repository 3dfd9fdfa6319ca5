#include "abbe/instruments/trackers/tracking_interferometer_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/best_fit_transform.h"
#include "abbe/instruments/instrument.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLargest = 2000;  // readings per station

/// Where the machine puts a point of one body, seen from another.
Vector3d seen_point(const ChainPlan& plan, const OnePose& pose, const Vector3d& point) {
  Vector3d seen = point;
  plan.transform(pose.arrays(), {&seen[0], &seen[1], &seen[2]}, {&seen[0], &seen[1], &seen[2]});
  return seen;
}

std::string text(const Vector3d& v, int digits) {
  std::string result;
  for (const double value : {v.x(), v.y(), v.z()}) {
    std::string number = fmt::format("{:.{}f}", value, digits);
    if (number.find_first_not_of("-0.") == std::string::npos && number.front() == '-') number.erase(0, 1);
    result += (result.empty() ? "" : ", ") + number;
  }
  return "(" + result + ")";
}

std::string message_of(const Trilateration& found, const TrackingInterferometerSetup::Station& station) {
  switch (found.status) {
    case TrilaterationStatus::mirrored:
      return fmt::format(
          "{}: all points lie near one plane (normal {} of the {}); {} and {} mm explain the lengths equally well, the "
          "first is taken because it is nearer to the given position",
          station.name, text(found.direction, 3), body_name(station.body), text(found.position, 1),
          text(found.other, 1));
    case TrilaterationStatus::collinear:
      return fmt::format("{}: all points lie on one line (direction {} of the {}), position not determined",
                         station.name, text(found.direction, 3), body_name(station.body));
    case TrilaterationStatus::too_few_points:
      return station.name + ": fewer lengths than unknowns, position not determined";
    case TrilaterationStatus::no_consensus:
      return station.name +
             ": no position explains half of the lengths; are stations, reflectors, runs or axes mixed up?";
    case TrilaterationStatus::ok:
    case TrilaterationStatus::not_run:
      return "";
  }
  return "";
}

/// Readings of one station, thinned out.
struct StationData {
  TrilaterationData data;
  std::vector<std::size_t> items;  ///< [runs of the data] items of the instrument
  std::size_t readings = 0;
};

class Collector {
 public:
  Collector(const Machine& machine, const ErrorSet& errors, const TrackingInterferometer& tracking,
            const InstrumentReadings& readings)
      : machine_(machine), errors_(errors), tracking_(tracking), readings_(readings), given_states_(machine, errors) {}

  StationData collect(std::size_t station) const {
    const TrackingInterferometerSetup& setup = tracking_.setup();
    StationData result;
    std::vector<std::size_t> own;
    for (std::size_t k = 0; k < readings_.count(); ++k) {
      if (setup.runs[readings_.item[k]].station == station) own.push_back(k);
    }
    result.readings = own.size();
    result.data.near = setup.stations[station].position.value();
    std::vector<ChainPlan> plans;  // [runs of the data]
    const std::size_t taken = std::min(own.size(), kLargest);
    for (std::size_t i = 0; i < taken; ++i) {
      const std::size_t k = own[i * own.size() / taken];
      const std::size_t run = run_of(readings_.item[k], result, plans);
      const std::vector<std::size_t>& used = tracking_.items()[readings_.item[k]].quantities;
      const auto value = [&](std::size_t place) { return tracking_.quantities()[used[place]].value; };
      Vector3d offset(value(0), value(1), value(2));
      if (tracking_.items()[readings_.item[k]].from == Body::tool) offset += errors_.tool_offset_error;
      const std::vector<double> positions = readings_.poses.pose(k), states = given_states_.at(readings_.poses, k);
      result.data.points.push_back(seen_point(plans[run], OnePose(positions, states), offset));
      result.data.lengths.push_back(readings_.measured[0][k] / (1 + value(7)));
      result.data.run.push_back(run);
    }
    return result;
  }

 private:
  std::size_t run_of(std::size_t item, StationData& given, std::vector<ChainPlan>& plans) const {
    const auto known = std::find(given.items.begin(), given.items.end(), item);
    if (known != given.items.end()) return static_cast<std::size_t>(known - given.items.begin());
    given.items.push_back(item);
    const InstrumentItem& of = tracking_.items()[item];
    const SetupQuantity& dead_path = tracking_.quantities()[of.quantities[6]];
    given.data.dead_path.push_back(dead_path.knowledge == Knowledge::open ? std::optional<double>() : dead_path.value);
    plans.emplace_back(machine_, errors_, of.from, of.to);
    return plans.size() - 1;
  }

  const Machine& machine_;
  const ErrorSet& errors_;
  const TrackingInterferometer& tracking_;
  const InstrumentReadings& readings_;
  const GivenStates given_states_;
};

}  // namespace

bool TrackingStart::determined() const {
  return std::all_of(stations.begin(), stations.end(), [](const TrackingStationStart& station) {
    return station.status == TrilaterationStatus::ok || station.status == TrilaterationStatus::not_run;
  });
}

TrackingStart find_tracking_start(const Machine& machine, const ErrorSet& errors,
                                  const TrackingInterferometer& tracking, const InstrumentReadings& readings,
                                  const TrilaterationOptions& options) {
  check_readings(machine, tracking, readings);
  const TrackingInterferometerSetup& setup = tracking.setup();
  const std::vector<SetupQuantity>& quantities = tracking.quantities();
  const Collector collector(machine, errors, tracking, readings);
  TrackingStart start;
  for (const SetupQuantity& quantity : quantities) start.values.push_back(quantity.value);
  for (std::size_t s = 0; s < setup.stations.size(); ++s) {
    const TrackingInterferometerSetup::Station& station = setup.stations[s];
    const StationData given = collector.collect(s);
    TrackingStationStart result;
    result.position = result.other = station.position.value();
    result.readings = given.readings;
    result.extent_mm = extent_of_points(given.data.points);
    if (given.items.empty()) {
      start.stations.push_back(result);
      continue;
    }
    const std::vector<std::size_t>& used = tracking.items()[given.items.front()].quantities;
    const bool sought = std::any_of(used.begin() + 3, used.begin() + 6,
                                    [&](std::size_t q) { return quantities[q].knowledge == Knowledge::open; });
    std::vector<double> dead_path;
    if (sought) {
      const Trilateration found = trilaterate(given.data, options);
      result.status = found.status;
      result.rms_mm = found.rms;
      result.outliers =
          static_cast<std::size_t>(std::count(found.inliers.begin(), found.inliers.end(), std::uint8_t{0}));
      const std::string message = message_of(found, station);
      if (!message.empty()) start.messages.push_back(message);
      if (found.status == TrilaterationStatus::ok || found.status == TrilaterationStatus::mirrored) {
        result.position = found.position;
        result.other = found.other;
        for (std::size_t c = 0; c < 3; ++c) start.values[used[3 + c]] = found.position[static_cast<int>(c)];
        dead_path = found.dead_path;
      }
    }
    if (dead_path.empty()) dead_path = dead_paths_at(given.data, result.position);
    for (std::size_t run = 0; run < given.items.size(); ++run) {
      const std::size_t q = tracking.items()[given.items[run]].quantities[6];
      if (quantities[q].knowledge == Knowledge::open) start.values[q] = dead_path[run];
    }
    start.stations.push_back(result);
  }
  return start;
}

}  // namespace abbe
