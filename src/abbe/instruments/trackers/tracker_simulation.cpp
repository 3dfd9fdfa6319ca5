#include "abbe/instruments/trackers/tracker_simulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPosesPerBlock = 512;

struct Reading {
  std::size_t pose;
  Sight sight;
  Vector3d measured;
  bool outlier = false, swapped = false;
};

/// Chains for every pair of bodies between which a sight goes.
struct SightChains {
  struct Pair {
    Body on, from;
    ChainPlan point, back;
  };
  std::vector<Pair> pairs;
  std::vector<std::size_t> pair_of;  ///< [sights]
};

std::vector<Sight> sights_of(const TrackerSetup& setup, const TrackerSimulationOptions& options) {
  std::vector<Sight> sights = options.sights;
  if (sights.empty()) {
    for (std::size_t s = 0; s < setup.stations.size(); ++s) {
      for (std::size_t r = 0; r < setup.reflectors.size(); ++r) {
        if (setup.stations[s].body == setup.reflectors[r].body) continue;
        sights.push_back({static_cast<std::uint16_t>(s), static_cast<std::uint16_t>(r)});
      }
    }
  }
  if (sights.empty()) throw std::invalid_argument("simulation: no station sees a reflector on another body");
  for (const Sight& sight : sights) {
    if (sight.station >= setup.stations.size() || sight.reflector >= setup.reflectors.size()) {
      throw std::invalid_argument("simulation: a sight names a station or reflector that is not there");
    }
    if (setup.stations[sight.station].body == setup.reflectors[sight.reflector].body) {
      throw std::invalid_argument("simulation: " + setup.stations[sight.station].name + " and " +
                                  setup.reflectors[sight.reflector].name + " are on the same body");
    }
  }
  return sights;
}

/// Two unit vectors across a beam.
void across(const Vector3d& beam, Vector3d& first, Vector3d& second) {
  first = (std::abs(beam.z()) < 0.9 ? Vector3d::UnitZ().cross(beam) : Vector3d::UnitX().cross(beam)).normalized();
  second = beam.cross(first);
}

bool visible(const TrackerStation& station, const Reflector& reflector, const Vector3d& point,
             const Vector3d& station_from_reflector) {
  const double range = point.norm();
  if (range < station.range_min || range > station.range_max || range == 0) return false;
  const double elevation = std::asin(std::clamp(point.z() / range, -1.0, 1.0));
  if (elevation < station.elevation_min || elevation > station.elevation_max) return false;
  if (reflector.view_half_angle >= std::numbers::pi) return true;
  const double cosine = station_from_reflector.normalized().dot(reflector.view_direction);
  return cosine >= std::cos(reflector.view_half_angle);
}

Vector3d noisy_reading(const Vector3d& point, const TrackerStation& station, const TrackerSimulationOptions& options,
                       RandomStream& random, Reading& reading) {
  const double range = point.norm();
  const Vector3d beam = point / range;
  Vector3d first, second;
  across(beam, first, second);
  // Always the same number of draws, so that a changed option changes only what it names.
  const double along = random.normal(), side = random.normal(), up = random.normal();
  const bool outlier = random.uniform() < options.outlier_fraction;
  const double size = options.outlier_mm * random.uniform(0.5, 1.5);
  // Drawn one by one: the order in which arguments are worked out is the compiler's.
  const double z = random.normal(), y = random.normal(), x = random.normal();
  const Vector3d direction = Vector3d(x, y, z).normalized();
  const double across_mm = options.noise_factor * station.noise.transverse_uncertainty(range);
  const double along_mm = options.noise_factor * station.noise.range_uncertainty(range);
  // Along an arc, so that noise across the beam does not lengthen the range.
  Vector3d seen = (point + across_mm * (side * first + up * second)).normalized() * (range + along_mm * along);
  if (outlier) seen += size * direction;
  reading.outlier = outlier;
  return options.measure == TrackerMeasure::cartesian ? seen : range_and_angles_from_point(seen);
}

}  // namespace

SimulatedTracker simulate_tracker(const Machine& machine, const ErrorSet& errors, const TrackerSetup& setup,
                                  const PoseList& poses, const TrackerSimulationOptions& options) {
  const std::vector<Sight> sights = sights_of(setup, options);
  if (poses.axis.size() != machine.axes.size()) throw std::invalid_argument("simulation: poses do not fit the machine");
  SightChains chains;
  for (const Sight& sight : sights) {
    const Body on = setup.reflectors[sight.reflector].body, from = setup.stations[sight.station].body;
    std::size_t pair = 0;
    while (pair < chains.pairs.size() && (chains.pairs[pair].on != on || chains.pairs[pair].from != from)) ++pair;
    if (pair == chains.pairs.size()) {
      chains.pairs.push_back({on, from, ChainPlan(machine, errors, on, from), ChainPlan(machine, errors, from, on)});
    }
    chains.pair_of.push_back(pair);
  }
  const ReversalShift reversal(errors);
  const GivenStates given(machine, errors);
  require_states(machine, errors, poses);
  std::vector<ReadingDrift> drifts;  // of every station, at the times of the poses
  for (std::size_t s = 0; options.drift && s < setup.stations.size(); ++s) {
    const std::vector<std::uint16_t> place(poses.count(), static_cast<std::uint16_t>(s));
    drifts.emplace_back(options.drift, options.time_s, place);
  }
  const std::size_t blocks = (poses.count() + kPosesPerBlock - 1) / kPosesPerBlock;
  std::vector<std::vector<Reading>> made(blocks);
  std::vector<std::size_t> hidden(blocks, 0);
  std::size_t done = 0;
  std::mutex progress_mutex;

  for_each_block(blocks, options.threads, [&](std::size_t block) {
    std::vector<double> positions(machine.axes.size());
    std::vector<const double*> axis, state;
    std::vector<double> states;
    for (const double& position : positions) axis.push_back(&position);
    const auto transformed = [&](const ChainPlan& plan, const Vector3d& start) {
      Vector3d seen;
      plan.transform({axis, 1, state}, {&start[0], &start[1], &start[2]}, {&seen[0], &seen[1], &seen[2]});
      return seen;
    };
    const std::size_t last = std::min(poses.count(), (block + 1) * kPosesPerBlock);
    for (std::size_t pose = block * kPosesPerBlock; pose < last; ++pose) {
      for (std::size_t i = 0; i < positions.size(); ++i) {
        positions[i] = poses.axis[i][pose] + reversal.shift(poses, i, pose);
      }
      const std::size_t chosen[] = {pose};
      given.gather(poses, chosen, states, state);
      std::size_t first_sight = 0, end_sight = sights.size();
      if (options.choice != SightChoice::every) {
        first_sight = options.choice == SightChoice::cycle
                          ? pose % sights.size()
                          : RandomStream(options.seed, 2 * pose).bits() % sights.size();
        end_sight = first_sight + 1;
      }
      for (std::size_t s = first_sight; s < end_sight; ++s) {
        // Odd streams for readings, even ones for the choice of sights: no stream is used twice.
        RandomStream random(options.seed, 2 * (pose * sights.size() + s) + 1);
        const bool swap = random.uniform() < options.swapped_fraction;
        const double which = random.uniform();
        Reading reading{.pose = pose, .sight = sights[s], .measured = {}, .swapped = false};
        std::size_t taken = s;
        if (swap) {
          std::vector<std::size_t> others;
          for (std::size_t o = 0; o < sights.size(); ++o) {
            if (sights[o].station == sights[s].station && sights[o].reflector != sights[s].reflector)
              others.push_back(o);
          }
          if (!others.empty()) {
            taken = others[static_cast<std::size_t>(which * static_cast<double>(others.size()))];
            reading.swapped = true;
          }
        }
        const TrackerStation& station = setup.stations[sights[taken].station];
        const Reflector& reflector = setup.reflectors[sights[taken].reflector];
        const SightChains::Pair& chain = chains.pairs[chains.pair_of[taken]];
        const Vector3d start = reflector_start(reflector, errors);
        Vector3d seen = transformed(chain.point, start);
        if (options.drift) seen = drifts[sights[taken].station].seen(pose, seen);
        const Vector3d point = station.body_from_tracker.inverse() * seen;
        if (options.line_of_sight) {
          const Vector3d back = transformed(chain.back, station.body_from_tracker.translation) - start;
          if (!visible(station, reflector, point, back)) {
            ++hidden[block];
            continue;
          }
        }
        reading.measured = noisy_reading(point, station, options, random, reading);
        made[block].push_back(reading);
      }
    }
    if (options.progress) {
      const std::lock_guard lock(progress_mutex);
      done += last - block * kPosesPerBlock;
      options.progress(done, poses.count());
    }
  });

  SimulatedTracker result;
  TrackerReadings& readings = result.readings;
  readings.measure = options.measure;
  std::size_t total = 0;
  for (const std::vector<Reading>& part : made) total += part.size();
  readings.reserve(machine.axes.size(), total);
  if (!poses.approach.empty()) readings.poses.approach.resize(machine.axes.size());
  readings.poses.state.resize(poses.state.size());
  for (std::size_t block = 0; block < blocks; ++block) {
    result.hidden += hidden[block];
    for (const Reading& reading : made[block]) {
      const std::uint32_t index = static_cast<std::uint32_t>(readings.count());
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        readings.poses.axis[i].push_back(poses.axis[i][reading.pose]);
        if (!poses.approach.empty()) readings.poses.approach[i].push_back(poses.approach[i][reading.pose]);
      }
      for (std::size_t j = 0; j < poses.state.size(); ++j) {
        if (!poses.state[j].empty()) readings.poses.state[j].push_back(poses.state[j][reading.pose]);
      }
      for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(reading.measured[static_cast<int>(k)]);
      readings.station.push_back(reading.sight.station);
      readings.reflector.push_back(reading.sight.reflector);
      readings.time_s.push_back(options.time_s.empty() ? options.interval_s * index : options.time_s[reading.pose]);
      if (reading.outlier) result.outliers.push_back(index);
      if (reading.swapped) result.swapped.push_back(index);
    }
    made[block] = {};
  }
  return result;
}

}  // namespace abbe
