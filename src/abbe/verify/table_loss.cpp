#include "abbe/verify/table_loss.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/point_correction.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/best_fit_transform.h"

namespace abbe {
namespace {

constexpr int kSamples = 201;  // places along an axis where its error motion is looked at

void add_deviation(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                   const std::vector<double>& corrected, PoseDeviations& deviations) {
  const RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
  const RigidTransform actual = actual_workpiece_from_tool(machine, errors, corrected);
  deviations.position.push_back((actual.translation - wanted.translation).norm());
  const Eigen::Vector3d a = actual.rotation * machine.tool_direction, b = wanted.rotation * machine.tool_direction;
  deviations.orientation.push_back(std::atan2(a.cross(b).norm(), a.dot(b)));
}

void summarise(PoseDeviations& deviations) {
  deviations.position_statistics = sample_statistics(deviations.position);
  deviations.orientation_statistics = sample_statistics(deviations.orientation);
}

/// Directions in which axes with reversal values can have come, [axes] each; 0 for all others.
std::vector<std::vector<std::int8_t>> approaches(const Machine& machine, const ErrorSet& errors) {
  constexpr std::size_t kMostAxes = 6;
  std::vector<std::size_t> axes;
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value != 0) axes.push_back(reversal.axis);
  }
  std::vector<std::vector<std::int8_t>> all;
  const bool few = axes.size() <= kMostAxes;
  const std::size_t count = few ? std::size_t{1} << axes.size() : 2;
  for (std::size_t pattern = 0; pattern < count; ++pattern) {
    std::vector<std::int8_t> approach(machine.axes.size(), 0);
    for (std::size_t r = 0; r < axes.size(); ++r) {
      approach[axes[r]] = (few ? pattern >> r & 1 : pattern) != 0 ? std::int8_t{1} : std::int8_t{-1};
    }
    all.push_back(std::move(approach));
  }
  return all;
}

/// Largest factor of a state at the ends of the travels of all axes; 1 without a state.
double largest_factor(const Machine& machine, std::size_t state) {
  if (state == kNoState) return 1;
  double largest = 0;
  for (std::size_t corner = 0; corner < std::size_t{1} << machine.axes.size(); ++corner) {
    std::vector<double> positions;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const KnownTravel travel = known_travel(machine, ErrorSet{}, i);
      positions.push_back((corner >> i & 1) != 0 ? travel.to : travel.from);
    }
    largest = std::max(largest, std::abs(state_factor(machine, state, positions, {})));
  }
  return largest;
}

double largest_value(const Machine& machine, ErrorSet errors, std::size_t axis, Component component) {
  const KnownTravel travel = known_travel(machine, errors, axis);
  double largest = 0;
  const double factor = largest_factor(machine, errors.motions.front().state);  // all have the same
  for (ErrorMotion& motion : errors.motions) motion.state = kNoState;
  for (const double q : evenly_spaced(travel.from, travel.to, kSamples)) {
    largest = std::max(largest, std::abs(errors.evaluate(axis, q)[static_cast<std::size_t>(component)]));
  }
  return factor * largest;
}

}  // namespace

PoseDeviations deviations_with(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                               const CommandCorrection& correction) {
  PoseList from = commands, added;
  PoseDeviations largest;
  for (const std::vector<std::int8_t>& approach : approaches(machine, errors)) {
    from.approach.clear();
    for (const std::int8_t sign : approach) from.approach.emplace_back(commands.count(), sign);
    if (added.axis.empty() || correction.knows_directions()) correction.evaluate(from, added);
    PoseDeviations deviations;
    for (std::size_t k = 0; k < commands.count(); ++k) {
      const std::vector<double> pose = commands.pose(k);
      std::vector<double> stands = pose;
      for (std::size_t i = 0; i < stands.size(); ++i) {
        // The axis stands as if half of its reversal value had been commanded besides.
        stands[i] += added.axis[i][k] + 0.5 * approach[i] * reversal_of(errors, i);
      }
      add_deviation(machine, errors, pose, stands, deviations);
    }
    if (largest.position.empty()) {
      largest = std::move(deviations);
      continue;
    }
    for (std::size_t k = 0; k < commands.count(); ++k) {
      largest.position[k] = std::max(largest.position[k], deviations.position[k]);
      largest.orientation[k] = std::max(largest.orientation[k], deviations.orientation[k]);
    }
  }
  summarise(largest);
  return largest;
}

SampleStatistics volumetric_error_with(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                       const CommandCorrection& correction) {
  PoseList mean = commands, added;
  mean.approach.clear();
  correction.evaluate(mean, added);
  std::vector<Eigen::Vector3d> actual, wanted;
  for (std::size_t k = 0; k < commands.count(); ++k) {
    std::vector<double> stands = commands.pose(k);
    wanted.push_back(nominal_workpiece_from_tool(machine, stands).translation);
    for (std::size_t i = 0; i < stands.size(); ++i) stands[i] += added.axis[i][k];
    actual.push_back(actual_workpiece_from_tool(machine, errors, stands).translation);
  }
  const RigidTransform datum = best_fit_transform(actual, wanted).target_from_source;
  std::vector<double> left;
  for (std::size_t k = 0; k < actual.size(); ++k) left.push_back((datum * actual[k] - wanted[k]).norm());
  return sample_statistics(left);
}

PoseDeviations ideal_deviations(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                std::size_t& not_reached) {
  const CompensatedInverse inverse(with_room_beyond_travel(machine), errors);
  PoseList reached = commands;
  std::vector<const double*> in;
  std::vector<double*> out;
  for (std::size_t i = 0; i < commands.axis.size(); ++i) {
    in.push_back(commands.axis[i].data());
    out.push_back(reached.axis[i].data());
  }
  std::vector<CorrectionStatus> status(commands.count(), CorrectionStatus::not_run);
  inverse.correct({in, commands.count()}, {out, status.data()});
  not_reached = 0;
  PoseDeviations deviations;
  for (std::size_t k = 0; k < commands.count(); ++k) {
    if (!reaches_point(status[k])) ++not_reached;
    add_deviation(machine, errors, commands.pose(k), reached.pose(k), deviations);
  }
  summarise(deviations);
  return deviations;
}

std::vector<NamedErrors> errors_one_by_one(const Machine& machine, const ErrorSet& errors) {
  std::vector<NamedErrors> alone;
  for (const ErrorMotion& motion : errors.motions) {
    const std::string name = error_motion_name(machine, motion.axis, motion.component, motion.state);
    auto found = std::find_if(alone.begin(), alone.end(), [&](const NamedErrors& one) { return one.name == name; });
    if (found == alone.end()) {
      NamedErrors named;
      named.name = name;
      named.is_angle = is_rotation(motion.component);
      named.errors.composition = errors.composition;
      alone.push_back(std::move(named));
      found = alone.end() - 1;
    }
    found->errors.motions.push_back(motion);
  }
  for (NamedErrors& named : alone) {
    const ErrorMotion& motion = named.errors.motions.front();
    named.size = largest_value(machine, named.errors, motion.axis, motion.component);
  }
  for (const LocationError& location : errors.locations) {
    NamedErrors named;
    named.name = location_error_name(machine, location.axis, location.component, location.state);
    named.is_angle = is_rotation(location.component);
    // About (along) the axis's own direction it is its zero position, in the unit of the axis.
    if (is_zero_position_error(machine.axes[location.axis], location.component)) {
      named.is_angle = machine.axes[location.axis].kind == AxisKind::rotary;
    }
    named.size = largest_factor(machine, location.state) * std::abs(location.value);
    named.errors.composition = errors.composition;
    named.errors.locations.push_back(location);
    alone.push_back(std::move(named));
  }
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value == 0) continue;
    NamedErrors named;
    named.name = reversal_name(machine, reversal.axis);
    named.is_angle = machine.axes[reversal.axis].kind == AxisKind::rotary;
    named.size = std::abs(reversal.value);
    named.errors.composition = errors.composition;
    named.errors.reversals.push_back(reversal);
    alone.push_back(std::move(named));
  }
  for (int k = 0; k < 3; ++k) {
    if (errors.tool_offset_error[k] == 0) continue;
    NamedErrors named;
    named.name = std::string("tool_") + "XYZ"[k];
    named.size = std::abs(errors.tool_offset_error[k]);
    named.errors.composition = errors.composition;
    named.errors.tool_offset_error[k] = errors.tool_offset_error[k];
    alone.push_back(std::move(named));
  }
  return alone;
}

std::vector<CarriedError> carried_errors(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                         const CorrectionMaker& make) {
  std::vector<CarriedError> carried;
  for (const NamedErrors& alone : errors_one_by_one(machine, errors)) {
    CarriedError one;
    one.name = alone.name;
    one.is_angle = alone.is_angle;
    one.size = alone.size;
    const PoseDeviations before = deviations_with(machine, alone.errors, commands, NoCorrection());
    one.effect_before = before.position_statistics.rms;
    one.turn_before = before.orientation_statistics.rms;
    const PoseDeviations after = deviations_with(machine, alone.errors, commands, *make(alone.errors));
    one.effect_after = after.position_statistics.rms;
    one.turn_after = after.orientation_statistics.rms;
    carried.push_back(one);
  }
  return carried;
}

}  // namespace abbe
