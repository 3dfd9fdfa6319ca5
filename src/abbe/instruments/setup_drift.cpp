#include "abbe/instruments/setup_drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/tracker_residual.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
constexpr double kSecondsPerHour = 3600;

}  // namespace

const char* drift_component_name(int component) {
  static constexpr const char* kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  return kNames[component];
}

std::size_t SetupDrift::unknown_count() const {
  std::size_t count = 0;
  for (const DriftingPlace& place : places) count += place.components.size() * place.functions();
  return count;
}

std::size_t SetupDrift::first_unknown(std::size_t place, std::size_t component) const {
  std::size_t first = 0;
  for (std::size_t p = 0; p < place; ++p) first += places[p].components.size() * places[p].functions();
  return first + component * places[place].functions();
}

std::vector<SetupUnknown> SetupDrift::unknowns() const {
  std::vector<SetupUnknown> result;
  for (const DriftingPlace& place : places) {
    for (const int component : place.components) {
      const bool is_angle = component >= 3;
      const std::string start = fmt::format("{}.drift_{}", place.name, drift_component_name(component));
      const auto add = [&](std::string name) { result.push_back({std::move(name), is_angle, is_angle ? 1e-5 : 1e-2}); };
      for (int k = 1; k <= place.degree; ++k) add(fmt::format("{}[P{}]", start, k));
      for (std::size_t i = 1; i < place.knots_s.size(); ++i) {
        add(fmt::format("{}({:.6g} h)", start, (place.knots_s[i] - place.start_s) / kSecondsPerHour));
      }
    }
  }
  return result;
}

void drift_functions(const DriftingPlace& place, double time_s, double* weights) {
  const double time = std::clamp(time_s, place.start_s, place.end_s);
  const double s = (time - place.start_s) / (place.end_s - place.start_s);
  double power = 1;
  for (int k = 0; k < place.degree; ++k) *weights++ = power *= s;
  if (place.knots_s.empty()) return;
  const std::vector<double>& knots = place.knots_s;
  std::fill_n(weights, knots.size() - 1, 0.0);
  const auto behind = std::upper_bound(knots.begin() + 1, knots.end() - 1, time);
  const auto right = static_cast<std::size_t>(behind - knots.begin());
  const double share = (time - knots[right - 1]) / (knots[right] - knots[right - 1]);
  weights[right - 1] = share;
  if (right >= 2) weights[right - 2] = 1 - share;
}

ReadingDrift::ReadingDrift(std::shared_ptr<const SetupDrift> drift, std::span<const double> time_s,
                           std::vector<std::uint16_t> place)
    : drift_(std::move(drift)), place_(std::move(place)) {
  if (drift_ == nullptr) return;
  if (time_s.size() != place_.size()) throw std::invalid_argument("a set-up drifts, and its readings have no times");
  for (std::size_t p = 0; p < drift_->places.size(); ++p) {
    const DriftingPlace& of = drift_->places[p];
    for (const int component : of.components) {
      for (std::size_t f = 0; f < of.functions(); ++f) {
        component_.push_back(component);
        place_of_.push_back(p);
        function_.push_back(f);
      }
    }
  }
  for (std::size_t k = 0; k < place_.size(); ++k) {
    const DriftingPlace& of = drift_->places.at(place_[k]);
    first_weight_.push_back(weights_.size());
    weights_.resize(weights_.size() + of.functions());
    drift_functions(of, time_s[k], weights_.data() + first_weight_.back());
  }
  set(drift_->values);
}

void ReadingDrift::set(std::span<const double> values) {
  if (!acts()) return;
  assert(values.size() == component_.size());
  motion_.assign(place_.size(), Eigen::Matrix<double, 6, 1>::Zero());
  for (std::size_t k = 0; k < place_.size(); ++k) {
    const DriftingPlace& of = drift_->places[place_[k]];
    const double* weights = weights_.data() + first_weight_[k];
    std::size_t u = drift_->first_unknown(place_[k], 0);
    for (const int component : of.components) {
      for (std::size_t f = 0; f < of.functions(); ++f) motion_[k][component] += weights[f] * values[u++];
    }
  }
}

Eigen::Matrix3d ReadingDrift::turn(std::size_t reading) const {
  return rotation_from_vector(motion_[reading].tail<3>());
}

Vector3d ReadingDrift::seen(std::size_t reading, const Vector3d& point) const {
  const Vector3d& pivot = drift_->places[place_[reading]].pivot;
  return turn(reading).transpose() * (point - pivot - motion_[reading].head<3>()) + pivot;
}

Eigen::Matrix<double, 6, 1> ReadingDrift::slopes(std::size_t reading, const Vector3d& seen, const Vector3d& force,
                                                 const Vector3d& moment) const {
  // The turn grows by dE = [a_j] E dw_j: the body turns by -E'a_j and shifts by -E'(a_j x E(seen - c)).
  const Eigen::Matrix3d e = turn(reading);
  const Vector3d f = e * force;
  const Vector3d turning = (e * (seen - drift_->places[place_[reading]].pivot)).cross(f) + e * moment;
  Eigen::Matrix<double, 6, 1> result;
  result << -f, -(rotation_vector_axes(motion_[reading].tail<3>()).transpose() * turning);
  return result;
}

double ReadingDrift::weight(std::size_t unknown, std::size_t reading) const {
  return place_of_[unknown] == place_[reading] ? weights_[first_weight_[reading] + function_[unknown]] : 0.0;
}

}  // namespace abbe
