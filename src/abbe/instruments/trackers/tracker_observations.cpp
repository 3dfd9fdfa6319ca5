#include "abbe/instruments/trackers/tracker_observations.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/error_states.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/jacobian_target.h"
#include "abbe/instruments/trackers/tracker_drift.h"
#include "abbe/instruments/trackers/tracker_residual.h"
#include "abbe/instruments/trackers/tracker_scratch.h"
#include "abbe/instruments/trackers/tracker_whitening.h"

namespace abbe {
namespace {

static_assert(Observations::kBlockSize <= ChainPlan::kBlockSize);

enum class UnknownKind { station_position, station_rotation, reflector_offset };
struct UnknownRole {
  UnknownKind kind;
  std::size_t index;  ///< of the station or reflector
  int component;
};

/// Readings of a block that share one pair of bodies.
struct Members {
  std::size_t count = 0;
  bool whole_block = false;
  std::uint16_t at[Observations::kBlockSize];  ///< index in the block
};

TrackerScratch& tracker_scratch() {
  thread_local TrackerScratch memory;
  return memory;
}

}  // namespace

struct TrackerObservations::Implementation {
  struct BodyPair {
    Body from, to;
    ChainPlan plan;
  };

  ErrorSet errors;
  TrackerSetup given;
  TrackerReadings readings;
  std::array<std::vector<double>, 6> weight;
  std::array<std::vector<double>, 4> trig;  ///< polar: sine and cosine of azimuth, of elevation
  std::vector<BodyPair> pairs;
  std::vector<std::uint8_t> pair_of;  ///< [station * reflectors + reflector]
  std::size_t tool_parameter = 0;
  std::vector<SetupUnknown> unknowns;
  std::vector<UnknownRole> roles;
  std::vector<double> values;
  std::vector<StationPose> stations;
  std::vector<Eigen::Vector3d> offsets;  ///< present reflector offsets
  std::vector<Eigen::Vector3d> starts;   ///< offsets with the tool offset error where it acts
  Eigen::Vector3d tool_offset_error = Eigen::Vector3d::Zero();
  ReversalShift reversal;
  GivenStates given_states;
  ReadingDrift drift;

  std::uint8_t pair_at(std::size_t reading) const {
    return pair_of[readings.station[reading] * given.reflectors.size() + readings.reflector[reading]];
  }

  void name_unknowns() {
    const auto add = [&](std::string name, bool is_angle, UnknownRole role, double value) {
      unknowns.push_back({std::move(name), is_angle, is_angle ? 1e-3 : 1.0});
      roles.push_back(role);
      values.push_back(value);
    };
    for (std::size_t s = 0; s < given.stations.size(); ++s) {
      const TrackerStation& station = given.stations[s];
      if (!station.estimate_pose) continue;
      const Eigen::Vector3d& place = station.body_from_tracker.translation;
      for (int k = 0; k < 3; ++k)
        add(station.name + "." + "xyz"[k], false, {UnknownKind::station_position, s, k}, place[k]);
      for (int k = 0; k < 3; ++k) add(station.name + ".r" + "xyz"[k], true, {UnknownKind::station_rotation, s, k}, 0);
    }
    for (std::size_t r = 0; r < given.reflectors.size(); ++r) {
      const Reflector& reflector = given.reflectors[r];
      if (!reflector.estimate_offset) continue;
      for (int k = 0; k < 3; ++k)
        add(reflector.name + ".offset_" + "xyz"[k], false, {UnknownKind::reflector_offset, r, k}, reflector.offset[k]);
    }
  }

  void update_setup(std::span<const double> setup) {
    std::copy(setup.begin(), setup.end(), values.begin());
    std::vector<Eigen::Vector3d> turns(given.stations.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < roles.size(); ++i) {
      const UnknownRole& role = roles[i];
      switch (role.kind) {
        case UnknownKind::station_position:
          stations[role.index].origin[role.component] = values[i];
          break;
        case UnknownKind::station_rotation:
          turns[role.index][role.component] = values[i];
          break;
        case UnknownKind::reflector_offset:
          offsets[role.index][role.component] = values[i];
          break;
      }
    }
    for (std::size_t s = 0; s < stations.size(); ++s) {
      stations[s].body_from_tracker = rotation_from_vector(turns[s]) * given.stations[s].body_from_tracker.rotation;
      stations[s].turn_axes = rotation_vector_axes(turns[s]);
    }
    for (std::size_t r = 0; r < offsets.size(); ++r) {
      starts[r] = offsets[r];
      if (given.reflectors[r].body == Body::tool) starts[r] += tool_offset_error;
    }
    drift.set(setup.subspan(roles.size()));
  }

  void find_members(std::size_t first, std::size_t count, std::size_t pair, Members& members) const;
  void evaluate_pair(const BodyPair& pair, const Members& members, std::size_t first, std::size_t count,
                     std::span<const std::size_t> machine_parameters, std::span<const std::size_t> setup_parameters,
                     double* residuals, const JacobianTarget& out) const;
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, const JacobianTarget& out) const;
  void load(const Members& members, std::size_t first, TrackerScratch& s) const;
  void residuals_of_runs(const Members& members, bool with_forces, TrackerScratch& s) const;
  void setup_column(const UnknownRole& role, std::size_t count, const TrackerScratch& s, double* column) const;
};

void TrackerObservations::Implementation::find_members(std::size_t first, std::size_t count, std::size_t pair,
                                                       Members& members) const {
  members.count = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (pairs.size() > 1 && pair_at(first + k) != pair) continue;
    members.at[members.count++] = static_cast<std::uint16_t>(k);
  }
  members.whole_block = members.count == count;
}

void TrackerObservations::Implementation::load(const Members& members, std::size_t first, TrackerScratch& s) const {
  const std::size_t axes = readings.poses.axis.size();
  s.axis.resize(axes);
  s.positions.resize(axes * kBlockSize);
  const bool reverses = reversal.acts_on(readings.poses);
  for (std::size_t i = 0; i < axes; ++i) {
    const double* commands = readings.poses.axis[i].data() + first;
    if (!members.whole_block || reverses) {
      double* gathered = &s.positions[i * kBlockSize];
      for (std::size_t k = 0; k < members.count; ++k) {
        gathered[k] = commands[members.at[k]];
        if (reverses) gathered[k] += reversal.shift(readings.poses, i, first + members.at[k]);
      }
      commands = gathered;
    }
    s.axis[i] = commands;
  }
  given_states.gather(readings.poses, first, {members.at, members.count}, kBlockSize, s.states, s.state);
  for (std::size_t k = 0; k < members.count; ++k) {
    const std::size_t reading = first + members.at[k];
    s.station[k] = readings.station[reading];
    s.reflector[k] = readings.reflector[reading];
    const Eigen::Vector3d& start = starts[s.reflector[k]];
    for (int c = 0; c < 3; ++c) s.start[c][k] = start[c];
  }
  const auto gather = [&](const std::vector<double>& from, double* to) {
    if (from.empty()) return;
    if (members.whole_block) {
      std::copy_n(&from[first], members.count, to);
      return;
    }
    for (std::size_t k = 0; k < members.count; ++k) to[k] = from[first + members.at[k]];
  };
  for (std::size_t c = 0; c < 3; ++c) gather(readings.measured[c], s.gathered[c]);
  for (std::size_t c = 0; c < 4; ++c) gather(trig[c], s.trig[c]);
  for (std::size_t c = 0; c < 6; ++c) gather(weight[c], s.weight[c]);
}

void TrackerObservations::Implementation::residuals_of_runs(const Members& members, bool with_forces,
                                                            TrackerScratch& s) const {
  for (std::size_t begin = 0; begin < members.count;) {
    std::size_t end = begin + 1;
    while (end < members.count && s.station[end] == s.station[begin]) ++end;
    ResidualInput in;
    in.count = end - begin;
    ResidualOutput out;
    for (int c = 0; c < 3; ++c) {
      in.seen[c] = s.seen[c] + begin;
      in.measured[c] = s.gathered[c] + begin;
      out.residual[c] = s.residual[c] + begin;
      for (int i = 0; i < 3; ++i) out.force[c][i] = with_forces ? s.force[c][i] + begin : nullptr;
    }
    for (int c = 0; c < 2; ++c) {
      in.sines[c] = s.trig[2 * c] + begin;
      in.cosines[c] = s.trig[2 * c + 1] + begin;
    }
    for (int c = 0; c < 6; ++c) in.weight[c] = s.weight[c] + begin;
    tracker_residuals(readings.measure, stations[s.station[begin]], in, out);
    begin = end;
  }
}

void TrackerObservations::Implementation::setup_column(const UnknownRole& role, std::size_t count,
                                                       const TrackerScratch& s, double* column) const {
  const std::uint16_t* of = role.kind == UnknownKind::reflector_offset ? s.reflector : s.station;
  for (int row = 0; row < 3; ++row) {
    double* values_out = column + static_cast<std::size_t>(row) * count;
    if (role.kind == UnknownKind::reflector_offset) {
      std::copy_n(s.by_start[row][role.component], count, values_out);
    } else if (role.kind == UnknownKind::station_position) {
      for (std::size_t k = 0; k < count; ++k) values_out[k] = -s.force[row][role.component][k];
    } else {
      // Turned about the axis: force . (seen - origin) x axis = (seen - origin) . axis x force
      const StationPose& station = stations[role.index];
      const double a0 = station.turn_axes(0, role.component), a1 = station.turn_axes(1, role.component);
      const double a2 = station.turn_axes(2, role.component);
      const double o0 = station.origin[0], o1 = station.origin[1], o2 = station.origin[2];
      const double *f0 = s.force[row][0], *f1 = s.force[row][1], *f2 = s.force[row][2];
      for (std::size_t k = 0; k < count; ++k) {
        values_out[k] = (s.seen[0][k] - o0) * (a1 * f2[k] - a2 * f1[k]) +
                        (s.seen[1][k] - o1) * (a2 * f0[k] - a0 * f2[k]) +
                        (s.seen[2][k] - o2) * (a0 * f1[k] - a1 * f0[k]);
      }
    }
  }
  // Alone and not in the loops above, which are then done with vectors.
  for (std::size_t k = 0; k < count; ++k) {
    if (of[k] == role.index) continue;
    for (std::size_t row = 0; row < 3; ++row) column[row * count + k] = 0;
  }
}

void TrackerObservations::Implementation::evaluate_pair(const BodyPair& pair, const Members& members, std::size_t first,
                                                        std::size_t count,
                                                        std::span<const std::size_t> machine_parameters,
                                                        std::span<const std::size_t> setup_parameters,
                                                        double* residuals, const JacobianTarget& out) const {
  TrackerScratch& s = tracker_scratch();
  load(members, first, s);
  const std::size_t n = members.count;
  const PositionArrays positions{s.axis, n, s.state};
  const ConstPointArrays start{s.start[0], s.start[1], s.start[2]};
  const auto& of_plan = drift.acts() ? s.unmoved : s.seen;
  const ConstPointArrays seen{of_plan[0], of_plan[1], of_plan[2]};
  pair.plan.transform(positions, start, {s.seen[0], s.seen[1], s.seen[2]});
  if (drift.acts()) move_reflectors(drift, first, {members.at, n}, s.seen, s.unmoved);
  residuals_of_runs(members, out.wanted(), s);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < n; ++k) residuals[row * count + members.at[k]] = s.residual[row][k];
  }
  if (!out.wanted()) return;

  const std::size_t columns = out.written(machine_parameters.size() + setup_parameters.size());
  const BlockMembers block{first, count, {members.at, n}};
  JacobianTarget target = out;
  if (!members.whole_block) {
    target.stride = 3 * kBlockSize;
    target.basis_stride = kBlockSize;
    s.jacobian.resize(columns * target.stride + out.bases_written() * target.basis_stride);
    target.columns = s.jacobian.data();
    target.bases = target.columns + columns * target.stride;
  }
  const auto is_of_reflector = [&](std::size_t i) {
    return i < roles.size() && roles[i].kind == UnknownKind::reflector_offset;
  };
  double* const setup_target = target.columns + (columns - setup_parameters.size()) * target.stride;
  // Of a station the columns are in its own frame, those of everything else in the frame of the body.
  for (std::size_t i = 0; i < setup_parameters.size(); ++i) {
    if (setup_parameters[i] >= roles.size() || is_of_reflector(setup_parameters[i])) continue;
    setup_column(roles[setup_parameters[i]], n, s, setup_target + i * target.stride);
  }
  if (drift.acts()) {
    take_tracker_drift(drift, first, {members.at, n}, s.seen,
                       {setup_parameters, roles.size(), setup_target, target.stride}, s.force);
  }
  const bool by_start_wanted = std::any_of(setup_parameters.begin(), setup_parameters.end(), is_of_reflector);
  RowArrays rows[3];
  PointArrays by_start[3];
  for (int row = 0; row < 3; ++row) {
    rows[row].force = {s.force[row][0], s.force[row][1], s.force[row][2]};
    by_start[row] = {s.by_start[row][0], s.by_start[row][1], s.by_start[row][2]};
  }
  if (!machine_parameters.empty() || by_start_wanted) {
    double* by_position = nullptr;
    if (reversal.acts_on(readings.poses)) {
      s.by_position.resize(readings.poses.axis.size() * 3 * n);
      by_position = s.by_position.data();
    }
    differentiate_readings(pair.plan, positions, start, seen, rows, machine_parameters, target,
                           by_start_wanted ? by_start : nullptr, by_position, reversal, readings.poses, block);
  }
  if (pair.from != Body::tool) {
    // The tool offset error belongs to targets on the tool; a station standing there has its own pose.
    for (std::size_t column = 0; column < machine_parameters.size(); ++column) {
      if (machine_parameters[column] >= tool_parameter) std::fill_n(target.column(column), 3 * n, 0.0);
    }
  }
  for (std::size_t i = 0; i < setup_parameters.size(); ++i) {
    if (!is_of_reflector(setup_parameters[i])) continue;
    setup_column(roles[setup_parameters[i]], n, s, setup_target + i * target.stride);
  }
  if (!members.whole_block) spread_derivatives(target, columns, 3, block, out);
}

void TrackerObservations::Implementation::evaluate(std::size_t first, std::size_t count,
                                                   std::span<const std::size_t> machine_parameters,
                                                   std::span<const std::size_t> setup_parameters, double* residuals,
                                                   const JacobianTarget& out) const {
  assert(count <= kBlockSize && first + count <= readings.count());
  Members members;
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    find_members(first, count, pair, members);
    if (members.count == 0) continue;
    evaluate_pair(pairs[pair], members, first, count, machine_parameters, setup_parameters, residuals, out);
    if (members.whole_block) break;
  }
}

TrackerObservations::TrackerObservations(const Machine& machine, const ErrorSet& errors, TrackerSetup setup,
                                         TrackerReadings readings)
    : implementation_(std::make_unique<Implementation>()) {
  validate(machine, setup, readings);
  Implementation& own = *implementation_;
  own.errors = errors;
  own.weight = whitening(readings, setup);
  own.given = std::move(setup);
  own.readings = std::move(readings);
  own.tool_parameter = errors.parameter_count() - 3;
  own.tool_offset_error = errors.tool_offset_error;
  own.reversal = ReversalShift(errors);
  own.given_states = GivenStates(machine, errors);
  require_states(machine, errors, own.readings.poses);
  if (own.readings.measure == TrackerMeasure::range_and_angles) {
    for (std::size_t a = 0; a < 2; ++a) {
      for (double angle : own.readings.measured[a + 1]) {
        own.trig[2 * a].push_back(std::sin(angle));
        own.trig[2 * a + 1].push_back(std::cos(angle));
      }
    }
  }
  // Only pairs of bodies that occur get a plan.
  const std::size_t reflectors = own.given.reflectors.size();
  own.pair_of.assign(own.given.stations.size() * reflectors, 0);
  std::vector<std::uint8_t> occurs(own.pair_of.size(), 0);
  for (std::size_t k = 0; k < own.readings.count(); ++k) {
    occurs[own.readings.station[k] * reflectors + own.readings.reflector[k]] = 1;
  }
  for (std::size_t i = 0; i < occurs.size(); ++i) {
    if (!occurs[i]) continue;
    const Body from = own.given.reflectors[i % reflectors].body;
    const Body to = own.given.stations[i / reflectors].body;
    std::size_t pair = 0;
    while (pair < own.pairs.size() && (own.pairs[pair].from != from || own.pairs[pair].to != to)) ++pair;
    if (pair == own.pairs.size()) own.pairs.push_back({from, to, ChainPlan(machine, errors, from, to)});
    own.pair_of[i] = static_cast<std::uint8_t>(pair);
  }
  for (const TrackerStation& station : own.given.stations) {
    own.stations.push_back({station.body_from_tracker.rotation, station.body_from_tracker.translation});
  }
  for (const Reflector& reflector : own.given.reflectors) own.offsets.push_back(reflector.offset);
  own.starts = own.offsets;
  own.name_unknowns();
  if (own.readings.drift != nullptr) {
    own.drift = ReadingDrift(own.readings.drift, own.readings.time_s, own.readings.station);
    for (SetupUnknown& unknown : own.readings.drift->unknowns()) own.unknowns.push_back(std::move(unknown));
    const std::vector<double>& values = own.readings.drift->values;
    own.values.insert(own.values.end(), values.begin(), values.end());
  }
  const std::vector<double> start_values = own.values;
  own.update_setup(start_values);
}

TrackerObservations::~TrackerObservations() = default;

std::string TrackerObservations::name() const {
  std::string names;
  for (const TrackerStation& station : implementation_->given.stations) {
    names += (names.empty() ? "" : ", ") + station.name;
  }
  return names;
}
std::size_t TrackerObservations::reading_count() const { return implementation_->readings.count(); }
const std::vector<SetupUnknown>& TrackerObservations::unknowns() const { return implementation_->unknowns; }
std::vector<double> TrackerObservations::unknown_values() const { return implementation_->values; }
std::vector<double> TrackerObservations::positions(std::size_t reading) const {
  return implementation_->readings.poses.pose(reading);
}
const std::vector<ReadingComponent>& TrackerObservations::components() const {
  static const std::vector<ReadingComponent> kPoint = {{"x", false}, {"y", false}, {"z", false}};
  static const std::vector<ReadingComponent> kBeam = {{"range", false}, {"azimuth", false}, {"elevation", false}};
  return implementation_->readings.measure == TrackerMeasure::cartesian ? kPoint : kBeam;
}
std::vector<double> TrackerObservations::deviation(std::size_t reading) const {
  const TrackerReadings& readings = implementation_->readings;
  const Eigen::Vector3d d = distance(reading);
  if (readings.measure == TrackerMeasure::cartesian) return {d.x(), d.y(), d.z()};
  // Along the beam and across it, in the directions in which azimuth and elevation grow.
  const double azimuth = readings.measured[1][reading], elevation = readings.measured[2][reading];
  const double ca = std::cos(azimuth), sa = std::sin(azimuth), ce = std::cos(elevation), se = std::sin(elevation);
  return {Eigen::Vector3d(ce * ca, ce * sa, se).dot(d), Eigen::Vector3d(-sa, ca, 0).dot(d),
          Eigen::Vector3d(-se * ca, -se * sa, ce).dot(d)};
}
const TrackerReadings& TrackerObservations::readings() const { return implementation_->readings; }

void TrackerObservations::set_parameters(std::span<const double> machine, std::span<const double> setup) {
  Implementation& own = *implementation_;
  assert(machine.size() == own.tool_parameter + 3);
  assert(setup.size() == own.unknowns.size());
  for (Implementation::BodyPair& pair : own.pairs) pair.plan.set_parameters(machine);
  own.reversal.set_parameters(machine);
  for (int k = 0; k < 3; ++k) own.tool_offset_error[k] = machine[own.tool_parameter + static_cast<std::size_t>(k)];
  own.update_setup(setup);
}

void TrackerObservations::evaluate(std::size_t first, std::size_t count,
                                   std::span<const std::size_t> machine_parameters,
                                   std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                                   std::size_t stride) const {
  implementation_->evaluate(first, count, machine_parameters, setup_parameters, residuals,
                            JacobianTarget::of(jacobian, stride));
}

std::optional<FactoredColumns> TrackerObservations::column_factors(
    std::span<const std::size_t> machine_parameters, std::span<const std::size_t> setup_parameters) const {
  return factors_with_setup(implementation_->errors, machine_parameters, setup_parameters);
}

void TrackerObservations::evaluate_factored(std::size_t first, std::size_t count,
                                            std::span<const std::size_t> machine_parameters,
                                            std::span<const std::size_t> setup_parameters, double* residuals,
                                            const JacobianFactors& factors) const {
  implementation_->evaluate(first, count, machine_parameters, setup_parameters, residuals, JacobianTarget::of(factors));
}

bool TrackerObservations::displacement_rows(std::size_t first, std::size_t count, double* rows_out) const {
  const Implementation& own = *implementation_;
  assert(count <= kBlockSize && first + count <= own.readings.count());
  TrackerScratch& s = tracker_scratch();
  Members members;
  for (std::size_t pair = 0; pair < own.pairs.size(); ++pair) {
    own.find_members(first, count, pair, members);
    if (members.count == 0) continue;
    own.load(members, first, s);
    own.pairs[pair].plan.transform({s.axis, members.count, s.state}, {s.start[0], s.start[1], s.start[2]},
                                   {s.seen[0], s.seen[1], s.seen[2]});
    const std::span<const std::uint16_t> at(members.at, members.count);
    if (own.drift.acts()) move_reflectors(own.drift, first, at, s.seen, s.unmoved);
    own.residuals_of_runs(members, true, s);
    if (own.drift.acts()) take_tracker_drift(own.drift, first, at, s.seen, {}, s.force);
    for (std::size_t direction = 0; direction < 3; ++direction) {
      for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t k = 0; k < members.count; ++k) {
          rows_out[(direction * 3 + row) * count + members.at[k]] = s.force[row][direction][k];
        }
      }
    }
    if (members.whole_block) break;
  }
  return true;
}

TrackerSetup TrackerObservations::setup() const {
  const Implementation& own = *implementation_;
  TrackerSetup present = own.given;
  for (std::size_t s = 0; s < present.stations.size(); ++s) {
    present.stations[s].body_from_tracker = {own.stations[s].body_from_tracker, own.stations[s].origin};
  }
  for (std::size_t r = 0; r < present.reflectors.size(); ++r) present.reflectors[r].offset = own.offsets[r];
  return present;
}

Eigen::Vector3d TrackerObservations::distance(std::size_t reading) const {
  const Implementation& own = *implementation_;
  TrackerScratch& s = tracker_scratch();
  const std::size_t axes = own.readings.poses.axis.size();
  s.axis.resize(axes);
  s.positions.resize(std::max(s.positions.size(), axes));
  for (std::size_t i = 0; i < axes; ++i) {
    const PoseList& poses = own.readings.poses;
    s.positions[i] = poses.axis[i][reading] + own.reversal.shift(poses, i, reading);
    s.axis[i] = &s.positions[i];
  }
  const std::uint16_t at[] = {0};
  own.given_states.gather(own.readings.poses, reading, at, 1, s.states, s.state);
  Eigen::Vector3d seen;
  const Eigen::Vector3d& start = own.starts[own.readings.reflector[reading]];
  own.pairs[own.pair_at(reading)].plan.transform({s.axis, 1, s.state}, {&start[0], &start[1], &start[2]},
                                                 {&seen[0], &seen[1], &seen[2]});
  if (own.drift.acts()) seen = own.drift.seen(reading, seen);
  const StationPose& station = own.stations[own.readings.station[reading]];
  return own.readings.point(reading) - station.body_from_tracker.transpose() * (seen - station.origin);
}

std::optional<double> TrackerObservations::length_of_deviation(std::size_t reading) const {
  return distance(reading).norm();
}

}  // namespace abbe
