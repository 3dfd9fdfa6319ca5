#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <numbers>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/instruments/further_readings.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_residual.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/instruments/trackers/tracker_whitening.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
constexpr std::size_t kTrialPoses = 90;
constexpr double kNewReflector_mm = 100;
constexpr double kNewStation_mm = 500;

/// One tracker set-up with the trials that can be made of it.
class TrackerTrials {
 public:
  TrackerTrials(const Machine& machine, const ErrorSet& errors, const TrackerObservations& tracker)
      : machine_(machine), errors_(errors), tracker_(tracker) {
    if (tracker.readings().stated != StatedUncertainty::none) noise_ = typical_noise(tracker.readings());
    for (const TrialRange& range : measured_ranges(machine, tracker.readings().poses)) {
      from_.push_back(range.from);
      to_.push_back(range.to);
    }
  }

  void add(std::vector<FurtherReadings>& list) {
    const std::vector<Axis>& axes = machine_.axes;
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
    const std::vector<Axis>& axes = machine_.axes;
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

  void add_trial(std::vector<FurtherReadings>& list, std::string words, const PoseList& trial_poses, TrackerSetup setup,
                 const std::vector<Sight>& sights) const {
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
    PoseList at_references = trial_poses;
    stand_at_references(machine_, at_references);
    const TrackerReadings readings = simulate_tracker(machine_, errors_, setup, at_references, options).readings;
    if (readings.count() == 0) return;
    FurtherReadings further;
    further.words = std::move(words);
    further.trial = std::make_shared<TrackerObservations>(machine_, errors_, setup, readings);
    further.unknowns.resize(further.trial->unknowns().size());
    further.turned = turned();
    list.push_back(std::move(further));
  }

  // A trial's station has its present rotation as the given one; ours has a rotation vector w on top of the given one:
  // a change of w turns it about the columns of J(w).
  std::vector<std::pair<std::string, Eigen::Matrix3d>> turned() const {
    std::vector<std::pair<std::string, Eigen::Matrix3d>> result;
    const std::vector<SetupUnknown>& unknowns = tracker_.unknowns();
    const std::vector<double> values = tracker_.unknown_values();
    for (std::size_t u = 0; u + 2 < unknowns.size(); ++u) {
      if (!unknowns[u].name.ends_with(".rx")) continue;
      result.emplace_back(unknowns[u].name, rotation_vector_axes({values[u], values[u + 1], values[u + 2]}));
    }
    return result;
  }

  const Machine& machine_;
  const ErrorSet& errors_;
  const TrackerObservations& tracker_;
  TrackerNoise noise_;  ///< if the data state their uncertainties
  std::vector<double> from_, to_;
};

}  // namespace

std::vector<FurtherReadings> TrackerObservations::further_readings(const Machine& machine,
                                                                   const ErrorSet& errors) const {
  std::vector<FurtherReadings> list;
  if (reading_count() > 0) TrackerTrials(machine, errors, *this).add(list);
  return list;
}

}  // namespace abbe
