#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/trial_readings.h"
#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_residual.h"
#include "abbe/instruments/tracker_simulation.h"
#include "abbe/instruments/tracker_whitening.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
constexpr std::size_t kTrialPoses = 90;
constexpr double kNewReflector_mm = 100;
constexpr double kNewStation_mm = 500;

/// One tracker set-up of a problem with the trials that can be made of it.
class TrackerTrials {
 public:
  TrackerTrials(const Problem& problem, std::size_t observations, const TrackerObservations& tracker)
      : problem_(problem),
        observations_(observations),
        tracker_(tracker),
        errors_(without_errors(problem)),
        parameters_(estimated_parameters(problem)) {
    if (tracker.readings().stated != StatedUncertainty::none) noise_ = typical_noise(tracker.readings());
    for (const TrialRange& range : measured_ranges(problem.machine, tracker.readings().poses)) {
      from_.push_back(range.from);
      to_.push_back(range.to);
    }
  }

  void add(std::vector<PossibleMeasurement>& list) {
    const std::vector<Axis>& axes = problem_.machine.axes;
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (to_[i] > from_[i])
        add_trial(list, fmt::format("more positions of {}, not in equal steps,", axes[i].name), poses(i),
                  tracker_.setup(), existing_sights());
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (!(to_[i] > from_[i]))
        add_trial(list, fmt::format("moving {} over its travel", axes[i].name), poses(i), tracker_.setup(),
                  existing_sights());
    add_trial(list, "poses at which all axes stand differently", poses(axes.size()), tracker_.setup(),
              existing_sights());
    const TrackerSetup setup = tracker_.setup();
    for (std::size_t r = 0; r < setup.reflectors.size() && r < 1; ++r) {
      TrackerSetup more = setup;
      std::vector<Sight> sights;
      // Three more on other lines through the first, so that together they do not lie on one.
      for (const Vector3d& shift : other_places(setup)) {
        Reflector reflector = setup.reflectors[r];
        reflector.name = fmt::format("trial{}", more.reflectors.size());
        reflector.estimate_offset = false;
        reflector.offset += shift;
        more.reflectors.push_back(reflector);
        sights.push_back({0, static_cast<std::uint16_t>(more.reflectors.size() - 1)});
        if (sights.size() == 1)
          add_trial(list,
                    fmt::format("another reflector at a known place, {:.0f} mm off {}", kNewReflector_mm,
                                setup.reflectors.size() > 1 ? "the line of the others" : setup.reflectors[0].name),
                    poses(axes.size()), more, sights);
      }
      add_trial(list, "further reflectors at known places that are not on one line", poses(axes.size()), more, sights);
    }
    TrackerSetup moved = setup;
    TrackerStation station = setup.stations[0];
    station.name = "another station";
    station.body_from_tracker.translation += Vector3d(kNewStation_mm, -0.7 * kNewStation_mm, 0.4 * kNewStation_mm);
    station.estimate_pose = true;
    moved.stations.push_back(station);
    std::vector<Sight> sights = existing_sights();
    for (Sight& sight : sights) sight.station = static_cast<std::uint16_t>(moved.stations.size() - 1);
    add_trial(list, "readings from another station", poses(axes.size()), moved, sights);
  }

 private:
  std::vector<Sight> existing_sights() const {
    std::vector<Sight> sights;
    const TrackerReadings& readings = tracker_.readings();
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const bool known = std::any_of(sights.begin(), sights.end(), [&](const Sight& sight) {
        return sight.station == readings.station[k] && sight.reflector == readings.reflector[k];
      });
      if (!known) sights.push_back({readings.station[k], readings.reflector[k]});
    }
    return sights;
  }

  /// Random positions of one axis (of all, for the number of axes); the others as they were measured.
  PoseList poses(std::size_t moving) const {
    const PoseList& measured = tracker_.readings().poses;
    const std::vector<Axis>& axes = problem_.machine.axes;
    PoseList result;
    for (std::size_t k = 0; k < kTrialPoses; ++k) {
      RandomStream random(17, k);
      const std::size_t other = static_cast<std::size_t>(random.uniform() * static_cast<double>(measured.count()));
      std::vector<double> pose = measured.pose(std::min(other, measured.count() - 1));
      for (std::size_t i = 0; i < axes.size(); ++i) {
        if (moving != axes.size() && moving != i) continue;
        const bool stood = !(to_[i] > from_[i]);
        if (stood && moving == axes.size()) continue;
        pose[i] = stood ? random.uniform(axes[i].endless ? 0 : axes[i].travel_min,
                                         axes[i].endless ? 2 * std::numbers::pi : axes[i].travel_max)
                        : random.uniform(from_[i], to_[i]);
      }
      result.append(pose);
    }
    return result;
  }

  /// Shifts off the line of the reflectors, three directions.
  std::vector<Vector3d> other_places(const TrackerSetup& setup) const {
    Vector3d line = Vector3d::UnitX();
    for (const Reflector& reflector : setup.reflectors) {
      const Vector3d step = reflector.offset - setup.reflectors[0].offset;
      if (step.norm() > 1) line = step.normalized();
    }
    const Vector3d first = line.unitOrthogonal(), second = line.cross(first);
    return {kNewReflector_mm * first, kNewReflector_mm * second, kNewReflector_mm * line};
  }

  void add_trial(std::vector<PossibleMeasurement>& list, std::string words, const PoseList& trial_poses,
                 TrackerSetup setup, const std::vector<Sight>& sights) const {
    if (sights.empty()) return;
    if (tracker_.readings().stated != StatedUncertainty::none) {
      // The stations have no noise model of their own then.
      for (TrackerStation& station : setup.stations) station.noise = noise_;
    }
    TrackerSimulationOptions options;
    options.measure = tracker_.readings().measure;
    options.noise_factor = 0;
    options.line_of_sight = false;
    options.sights = sights;
    options.choice = sights.size() > 3 ? SightChoice::cycle : SightChoice::every;
    const TrackerReadings readings = simulate_tracker(problem_.machine, errors_, setup, trial_poses, options).readings;
    if (readings.count() == 0) return;
    TrackerObservations trial(problem_.machine, errors_, setup, readings);
    PossibleMeasurement measurement = trial_measurement(problem_, observations_, std::move(words), trial,
                                                        std::vector<TrialUnknown>(trial.unknowns().size()));
    turn_as_ours(measurement.rows);
    list.push_back(std::move(measurement));
  }

  // A trial's station has its present rotation as the given one; ours has a rotation vector w on top of the given one:
  // a change of w turns it about the columns of J(w).
  void turn_as_ours(PlanningCandidates::Rows& rows) const {
    const std::vector<SetupUnknown>& unknowns = tracker_.unknowns();
    const std::vector<double> values = tracker_.unknown_values();
    for (std::size_t u = 0; u + 2 < unknowns.size(); ++u) {
      if (!unknowns[u].name.ends_with(".rx")) continue;
      for (std::size_t c = 0; c + 2 < parameters_.size(); ++c) {
        if (parameters_[c].id.observations != observations_ || parameters_[c].name != unknowns[u].name) continue;
        const Eigen::Matrix3d axes = rotation_vector_axes({values[u], values[u + 1], values[u + 2]});
        rows.middleCols<3>(static_cast<Index>(c)) = (rows.middleCols<3>(static_cast<Index>(c)) * axes).eval();
      }
    }
  }

  const Problem& problem_;
  std::size_t observations_;
  const TrackerObservations& tracker_;
  ErrorSet errors_;
  std::vector<EstimatedParameter> parameters_;
  TrackerNoise noise_;  ///< if the data state their uncertainties
  std::vector<double> from_, to_;
};

}  // namespace

void add_tracker_readings(const Problem& problem, std::vector<PossibleMeasurement>& list) {
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const auto* tracker = dynamic_cast<const TrackerObservations*>(problem.observations[o].observations.get());
    if (!tracker || tracker->reading_count() == 0) continue;
    TrackerTrials(problem, o, *tracker).add(list);
  }
}

}  // namespace abbe
