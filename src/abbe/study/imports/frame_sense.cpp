#include "abbe/study/imports/frame_sense.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "abbe/geometry/best_fit_transform.h"
#include "abbe/geometry/even_choice.h"

namespace abbe {
namespace {

constexpr Eigen::Index kMostReadings = 300;  // about
constexpr int kMostSteps = 200;
constexpr double kSettled = 1e-7;  // of the distance, from step to step

/// Readings of one station: the point, its reflector, and the pose of the tool in the body of the tracker.
struct SensedReading {
  Eigen::Vector3d point;
  std::size_t reflector = 0;
  RigidTransform body_from_tool;
};

std::vector<std::size_t> chosen_readings(const TrackerReadings& readings) {
  std::vector<std::size_t> of_station;
  for (std::size_t i = 0; i < readings.count(); ++i) {
    if (readings.station[i] == readings.station[0]) of_station.push_back(i);
  }
  // Reflectors may take turns: every n-th reading could be of the same one.
  const EvenChoice some(static_cast<Eigen::Index>(of_station.size()), kMostReadings);
  std::vector<std::size_t> chosen;
  for (Eigen::Index k = 0; k < some.size(); ++k) chosen.push_back(of_station[static_cast<std::size_t>(some[k])]);
  return chosen;
}

/// Root mean square distance of the best fit, or nothing where the points do not determine it. The pose of the tracker
/// and the offsets of the reflectors take turns: each is a linear problem while the other stands.
std::optional<double> distance_of_fit(const std::vector<SensedReading>& readings, std::size_t reflectors) {
  std::vector<Eigen::Vector3d> offsets(reflectors, Eigen::Vector3d::Zero()), source, target(readings.size());
  for (const SensedReading& reading : readings) source.push_back(reading.point);
  double earlier = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    for (std::size_t i = 0; i < readings.size(); ++i) {
      target[i] = readings[i].body_from_tool * offsets[readings[i].reflector];
    }
    const BestFitTransform fit = best_fit_transform(source, target);
    if (fit.status != BestFitStatus::ok) return std::nullopt;
    if (step > 0 && std::abs(fit.rms - earlier) <= kSettled * earlier) return fit.rms;
    earlier = fit.rms;
    std::vector<Eigen::Vector3d> sums(reflectors, Eigen::Vector3d::Zero());
    std::vector<double> counts(reflectors, 0);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const SensedReading& reading = readings[i];
      sums[reading.reflector] += reading.body_from_tool.inverse() * (fit.target_from_source * source[i]);
      counts[reading.reflector] += 1;
    }
    for (std::size_t k = 0; k < reflectors; ++k) {
      if (counts[k] > 0) offsets[k] = sums[k] / counts[k];
    }
  }
  return earlier;
}

double extent_of(const std::vector<SensedReading>& readings) {
  std::vector<Eigen::Vector3d> points;
  for (const SensedReading& reading : readings) points.push_back(reading.point);
  return extent_of_points(points);
}

}  // namespace

FrameSense frame_sense(const Machine& machine, const MeasurementTable& table) {
  const TrackerReadings& readings = table.readings;
  if (readings.count() == 0) return {};
  std::optional<double> right, left;
  double extent = 0;
  std::size_t count = 0;
  for (const bool from_workpiece : {true, false}) {
    std::vector<SensedReading> seen;
    for (const std::size_t i : chosen_readings(readings)) {
      const std::vector<double> pose = readings.poses.pose(i);
      seen.push_back(
          {readings.point(i), readings.reflector[i],
           from_workpiece ? nominal_workpiece_from_tool(machine, pose) : nominal_bed_from_tool(machine, pose)});
    }
    extent = extent_of(seen);
    count = seen.size();
    const std::optional<double> as_read = distance_of_fit(seen, table.reflectors.size());
    for (SensedReading& reading : seen) reading.point.y() = -reading.point.y();
    const std::optional<double> mirrored = distance_of_fit(seen, table.reflectors.size());
    if (as_read && mirrored) {
      right = std::min(right.value_or(*as_read), *as_read);
      left = std::min(left.value_or(*mirrored), *mirrored);
    }
  }
  return right ? FrameSense{*right, *left, extent, count} : FrameSense{};
}

}  // namespace abbe
