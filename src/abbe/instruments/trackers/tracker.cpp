#include "abbe/instruments/trackers/tracker.h"

#include <cmath>
#include <stdexcept>

namespace abbe {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d TrackerNoise::covariance(const Vector3d& point) const {
  const double range = point.norm();
  const double along = range_uncertainty(range), across = transverse_uncertainty(range);
  const Vector3d beam = range > 0 ? Vector3d(point / range) : Vector3d(Vector3d::UnitX());
  return across * across * Matrix3d::Identity() + (along * along - across * across) * beam * beam.transpose();
}

void TrackerReadings::reserve(std::size_t axes, std::size_t readings) {
  poses.axis.resize(axes);
  for (std::vector<double>& values : poses.axis) values.reserve(readings);
  station.reserve(readings);
  reflector.reserve(readings);
  for (std::vector<double>& values : measured) values.reserve(readings);
}

Vector3d TrackerReadings::point(std::size_t reading) const {
  const Vector3d values(measured[0][reading], measured[1][reading], measured[2][reading]);
  return measure == TrackerMeasure::cartesian ? values : point_from_range_and_angles(values);
}

Vector3d range_and_angles_from_point(const Vector3d& point) {
  const double horizontal = std::hypot(point.x(), point.y());
  return {point.norm(), horizontal > 0 ? std::atan2(point.y(), point.x()) : 0.0, std::atan2(point.z(), horizontal)};
}

Vector3d point_from_range_and_angles(const Vector3d& range_and_angles) {
  const Vector3d& v = range_and_angles;
  const double horizontal = v[0] * std::cos(v[2]);
  return {horizontal * std::cos(v[1]), horizontal * std::sin(v[1]), v[0] * std::sin(v[2])};
}

Vector3d reflector_start(const Reflector& reflector, const ErrorSet& errors) {
  if (reflector.body == Body::tool) return reflector.offset + errors.tool_offset_error;
  return reflector.offset;
}

namespace {

[[noreturn]] void refuse(std::size_t reading, const std::string& what) {
  throw std::invalid_argument("reading " + std::to_string(reading) + ": " + what);
}

void check_sizes(const Machine& machine, const TrackerReadings& readings) {
  const std::size_t n = readings.count();
  const auto check = [n](const std::string& what, std::size_t size, bool may_be_empty) {
    if (size == n || (may_be_empty && size == 0)) return;
    throw std::invalid_argument(what + ": " + std::to_string(size) + " values for " + std::to_string(n) + " readings");
  };
  if (readings.poses.axis.size() != machine.axes.size()) {
    throw std::invalid_argument("readings with " + std::to_string(readings.poses.axis.size()) + " axis columns for " +
                                std::to_string(machine.axes.size()) + " axes");
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    check("commands of axis " + machine.axes[i].name, readings.poses.axis[i].size(), false);
  }
  if (!readings.poses.approach.empty() && readings.poses.approach.size() != machine.axes.size()) {
    throw std::invalid_argument("sides of approach not one per axis");
  }
  for (const std::vector<std::int8_t>& sides : readings.poses.approach) check("side of approach", sides.size(), false);
  if (!readings.poses.state.empty() && readings.poses.state.size() != machine.states.size()) {
    throw std::invalid_argument("values of states not one column per state");
  }
  for (const std::vector<double>& values : readings.poses.state) check("value of a state", values.size(), true);
  check("reflector", readings.reflector.size(), false);
  for (const std::vector<double>& values : readings.measured) check("measured", values.size(), false);
  check("time", readings.time_s.size(), true);
  check("point", readings.point_name.size(), true);
  const std::size_t stated = readings.stated == StatedUncertainty::none       ? 0
                             : readings.stated == StatedUncertainty::standard ? 3
                                                                              : 6;
  for (std::size_t k = 0; k < stated; ++k) check("uncertainty", readings.uncertainty[k].size(), false);
}

}  // namespace

void validate(const Machine& machine, const TrackerSetup& setup, const TrackerReadings& readings) {
  check_sizes(machine, readings);
  for (std::size_t k = 0; k < readings.count(); ++k) {
    if (readings.station[k] >= setup.stations.size()) refuse(k, "no such station");
    if (readings.reflector[k] >= setup.reflectors.size()) refuse(k, "no such reflector");
    const TrackerStation& station = setup.stations[readings.station[k]];
    const Reflector& reflector = setup.reflectors[readings.reflector[k]];
    if (station.body == reflector.body) refuse(k, station.name + " and " + reflector.name + " are on the same body");
    for (const std::vector<double>& values : readings.poses.axis) {
      if (!std::isfinite(values[k])) refuse(k, "axis command is not a finite number");
    }
    for (const std::vector<double>& values : readings.measured) {
      if (!std::isfinite(values[k])) refuse(k, "measured value is not a finite number");
    }
    if (readings.measure == TrackerMeasure::range_and_angles && readings.measured[0][k] <= 0) {
      refuse(k, "range must be positive, in mm");
    }
    if (readings.stated == StatedUncertainty::none) {
      const double range =
          readings.measure == TrackerMeasure::cartesian ? readings.point(k).norm() : readings.measured[0][k];
      const double least =
          std::min(station.noise.range_uncertainty(range), station.noise.transverse_uncertainty(range));
      if (!(least > 0) || !std::isfinite(least)) {
        refuse(k, "no standard uncertainty: neither with the data nor as noise of " + station.name);
      }
    } else {
      for (std::size_t c = 0; c < 3; ++c) {
        const double u = readings.uncertainty[c][k];
        if (!(u > 0) || !std::isfinite(u)) refuse(k, "uncertainty must be a positive number");
      }
    }
  }
}

}  // namespace abbe
