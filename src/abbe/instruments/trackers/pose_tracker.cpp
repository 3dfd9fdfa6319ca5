#include "abbe/instruments/trackers/pose_tracker.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/trackers/pose_tracker_start.h"
#include "abbe/instruments/trackers/turned_vector.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
constexpr std::size_t kStationNumbers = 6, kTargetNumbers = 6;
// Of 1 + trace of a turn, which is 0 at half a turn.
constexpr double kNearlyHalfTurn = 1e-9;

PoseTrackerSetup true_pose_setup(PoseTrackerSetup setup) {
  if (setup.true_pose) setup.body_from_station = *setup.true_pose;
  for (PoseTrackerSetup::Target& target : setup.targets) {
    if (target.true_rotation) target.rotation = *target.true_rotation;
    for (SetupNumber& number : target.offset.coordinate) number.value = number.truth.value_or(number.value);
  }
  return setup;
}

/// The rotation of a turn 2 tan(a/2) n.
Eigen::Quaterniond quaternion_of_turn(const Vector3d& turn) {
  return Eigen::Quaterniond(1, turn[0] / 2, turn[1] / 2, turn[2] / 2).normalized();
}

}  // namespace

PoseTracker::PoseTracker(PoseTrackerSetup setup) : EquationInstrument(setup.name), given_(std::move(setup)) {
  if (given_.targets.empty()) throw std::invalid_argument(name_ + ": no target");
  if (!(given_.position_noise > 0) || !(given_.turn_noise > 0)) {
    throw std::invalid_argument(name_ + ".noise: not above zero");
  }
  for (const char* const name : {"x", "y", "z"}) components_.push_back({.name = name});
  for (const char* const name : {"turn_x", "turn_y", "turn_z"}) {
    components_.push_back({.name = name, .is_angle = true, .is_relative = true});
  }
  for (const char* const name : {"qw", "qx", "qy", "qz"}) inputs_.push_back({.name = name, .is_pure_number = true});
  const auto add_number = [this](const std::string& of, bool is_angle, bool estimated, double value) {
    return add(quantity(of, is_angle, estimated ? SetupNumber::open(value) : SetupNumber::exact(value)));
  };
  std::vector<std::size_t> station;
  for (int k = 0; k < 3; ++k) {
    station.push_back(
        add_number(name_ + "." + "xyz"[k], false, given_.estimate_pose, given_.body_from_station.translation[k]));
  }
  for (int k = 0; k < 3; ++k) {
    station.push_back(add_number(name_ + ".r" + "xyz"[k], true, given_.estimate_pose, 0));
  }
  for (const PoseTrackerSetup::Target& target : given_.targets) {
    if (target.body == given_.station_body) {
      throw std::invalid_argument(fmt::format("{}: the station is on the body of {}", name_, target.name));
    }
    InstrumentItem item{target.name, target.body, given_.station_body, station};
    for (std::size_t k = 0; k < 3; ++k) {
      item.quantities.push_back(add(quantity(target.name + ".offset_" + "xyz"[k], false, target.offset.coordinate[k])));
    }
    for (int k = 0; k < 3; ++k) {
      item.quantities.push_back(add_number(target.name + ".r" + "xyz"[k], true, target.estimate_rotation, 0));
    }
    add(std::move(item));
  }
}

PoseTrackerSetup PoseTracker::setup() const {
  PoseTrackerSetup present = given_;
  const auto vector_at = [this](std::size_t q) -> Vector3d {
    return {quantities_[q].value, quantities_[q + 1].value, quantities_[q + 2].value};
  };
  present.body_from_station = {rotation_from_vector(vector_at(kStationTurn)) * given_.body_from_station.rotation,
                               vector_at(kStation)};
  for (std::size_t i = 0; i < present.targets.size(); ++i) {
    PoseTrackerSetup::Target& target = present.targets[i];
    const std::size_t first = kStationNumbers + kTargetNumbers * i;
    for (std::size_t k = 0; k < 3; ++k) target.offset.coordinate[k].value = quantities_[first + k].value;
    target.rotation = given_.targets[i].rotation * rotation_from_vector(vector_at(first + 3));
  }
  return present;
}

double PoseTracker::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                         std::size_t component) const {
  if (components_[component].is_angle) return given_.turn_noise;
  const Vector3d position(readings.measured[0][reading], readings.measured[1][reading], readings.measured[2][reading]);
  return given_.position_noise + given_.position_noise_per_length * position.norm();
}

StartedInstrument PoseTracker::started(const Machine& machine, const InstrumentReadings& readings) const {
  PoseTrackerStart found = find_pose_tracker_start(machine, setup(), readings);
  StartedInstrument result;
  result.fits.push_back(std::move(found.fit));
  result.instrument = std::make_shared<PoseTracker>(std::move(found.setup));
  result.warnings = std::move(found.messages);
  return result;
}

std::vector<ReadingMistake> PoseTracker::usual_mistakes() const {
  return combined_mistakes({length_unit_mistakes({0, 1, 2}, "the measured positions")});
}

std::shared_ptr<const Instrument> PoseTracker::truth(RandomStream& random) const {
  PoseTrackerSetup real = true_pose_setup(setup());
  for (PoseTrackerSetup::Target& target : real.targets) {
    for (SetupNumber& number : target.offset.coordinate) {
      const double drawn = number.standard_uncertainty * random.normal();
      if (number.knowledge == Knowledge::within && !number.truth) number.value += drawn;
    }
  }
  return std::make_shared<PoseTracker>(std::move(real));
}

std::shared_ptr<const Instrument> PoseTracker::as_planned() const {
  return std::make_shared<PoseTracker>(true_pose_setup(setup()));
}

std::optional<MissingNumber> PoseTracker::missing_for_plan() const {
  if (given_.pose_is_known || given_.true_pose) return std::nullopt;
  return MissingNumber{fmt::format("it is not said where {} will stand", name_),
                       "pose = { position_mm = [x, y, z], angles_deg = [a, b, c] }, roughly"};
}

SimulatedInstrument PoseTracker::simulate(const Machine& machine, const ErrorSet& errors,
                                          const InstrumentReadings& plan,
                                          const InstrumentSimulationOptions& options) const {
  InstrumentReadings about = plan;
  about.inputs.assign(inputs_.size(), std::vector<double>(plan.count(), 0.0));
  const std::vector<RigidTransform> seen = seen_bodies(machine, errors, *this, plan);
  const PoseTrackerSetup present = setup();
  const auto put = [](InstrumentReadings& readings, std::size_t k, const Eigen::Quaterniond& q) {
    const double sign = q.w() < 0 ? -1 : 1;
    readings.inputs[0][k] = sign * q.w();
    readings.inputs[1][k] = sign * q.x();
    readings.inputs[2][k] = sign * q.y();
    readings.inputs[3][k] = sign * q.z();
  };
  for (std::size_t k = 0; k < plan.count(); ++k) {
    const Matrix3d rotation =
        present.body_from_station.rotation.transpose() * seen[k].rotation * present.targets[plan.item[k]].rotation;
    put(about, k, Eigen::Quaterniond(rotation));
  }
  SimulatedInstrument result = simulate_instrument(machine, errors, shared_from_this(), std::move(about), options);
  // The reading is the orientation itself.
  InstrumentReadings& read = result.readings;
  for (std::size_t k = 0; k < read.count(); ++k) {
    const Eigen::Quaterniond stated(read.inputs[0][k], read.inputs[1][k], read.inputs[2][k], read.inputs[3][k]);
    put(read, k, stated * quaternion_of_turn({read.measured[3][k], read.measured[4][k], read.measured[5][k]}));
    for (std::size_t row = 3; row < components_.size(); ++row) read.measured[row][k] = 0;
  }
  return result;
}

std::vector<InstrumentPlace> PoseTracker::places() const {
  const PoseTrackerSetup present = setup();
  std::vector<InstrumentPlace> result;
  const auto add_place = [&](const std::string& name, Body body, const RigidTransform& pose, std::size_t first) {
    InstrumentPlace place{.name = name, .body = body, .position = pose.translation, .rotation = pose.rotation};
    for (std::size_t k = 0; k < kStationNumbers; ++k) place.quantities.push_back(first + k);
    result.push_back(std::move(place));
  };
  if (given_.estimate_pose) add_place(name_, given_.station_body, present.body_from_station, 0);
  for (std::size_t i = 0; i < present.targets.size(); ++i) {
    const PoseTrackerSetup::Target& target = present.targets[i];
    if (!target.estimate_rotation) continue;
    add_place(target.name, target.body, {target.rotation, target.offset.value()}, kStationNumbers + kTargetNumbers * i);
  }
  return result;
}

template <typename S>
void PoseTracker::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double* inputs,
                           S* reading) const {
  using Vector = Eigen::Matrix<S, 3, 1>;
  const S* q = quantities;
  const Matrix3d& station = given_.body_from_station.rotation;
  const Vector turn(q[kStationTurn], q[kStationTurn + 1], q[kStationTurn + 2]);
  const Vector target_turn_back(-q[kTargetTurn], -q[kTargetTurn + 1], -q[kTargetTurn + 2]);
  const auto in_station = [&](const Vector& of_body) {
    const Vector back = turned_back(turn, of_body);
    Vector result;
    for (int i = 0; i < 3; ++i) {
      result[i] = S(station(0, i)) * back[0] + S(station(1, i)) * back[1] + S(station(2, i)) * back[2];
    }
    return result;
  };
  const Vector from_station = seen.point(Vector(q[kOffset], q[kOffset + 1], q[kOffset + 2])) -
                              Vector(q[kStation], q[kStation + 1], q[kStation + 2]);
  const Vector position = in_station(from_station);

  // Columns: the axes of the target in the frame of the instrument; M = M_given exp(v).
  std::array<Vector, 3> axes;
  const Matrix3d& given = given_.targets[item].rotation;
  for (int j = 0; j < 3; ++j) {
    const Vector turned = turned_back(target_turn_back, Vector(S(j == 0), S(j == 1), S(j == 2)));
    Vector on_body;
    for (int i = 0; i < 3; ++i) {
      on_body[i] = S(given(i, 0)) * turned[0] + S(given(i, 1)) * turned[1] + S(given(i, 2)) * turned[2];
    }
    axes[static_cast<std::size_t>(j)] = in_station(Vector(seen.rotation * on_body));
  }
  Matrix3d stated;
  const Eigen::Quaterniond measured(inputs[0], inputs[1], inputs[2], inputs[3]);
  if (measured.squaredNorm() > 0) {
    stated = measured.normalized().toRotationMatrix();
  } else {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) stated(i, j) = value_of(axes[static_cast<std::size_t>(j)][i]);
    }
  }
  // Element (i, j) of the turn from the stated orientation to the modelled one.
  const auto element = [&](int i, int j) {
    const Vector& axis = axes[static_cast<std::size_t>(j)];
    return S(stated(0, i)) * axis[0] + S(stated(1, i)) * axis[1] + S(stated(2, i)) * axis[2];
  };
  S below = S(1) + element(0, 0) + element(1, 1) + element(2, 2);
  if (value_of(below) < kNearlyHalfTurn) below = S(kNearlyHalfTurn);
  for (int i = 0; i < 3; ++i) {
    reading[i] = position[i];
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    reading[3 + i] = S(2) * (element(k, j) - element(j, k)) / below;
  }
}

template class EquationInstrument<PoseTracker, 12, 6>;

}  // namespace abbe
