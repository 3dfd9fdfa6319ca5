#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// Which stations see which reflectors at a pose.
enum class SightChoice {
  every,  ///< each listed sight at each pose
  cycle,  ///< one sight per pose, in turn
  random  ///< one sight per pose, drawn
};

struct Sight {
  std::uint16_t station = 0;
  std::uint16_t reflector = 0;
};

struct TrackerSimulationOptions {
  TrackerMeasure measure = TrackerMeasure::cartesian;
  std::vector<Sight> sights;  ///< empty: every station with every reflector on another body
  SightChoice choice = SightChoice::every;
  std::uint64_t seed = 1;
  double noise_factor = 1;                    ///< times the stations' noise; 0: none
  double outlier_fraction = 0;                ///< of the readings
  double outlier_mm = 1;                      ///< an outlier is shifted by 0.5 to 1.5 times this, any direction
  double swapped_fraction = 0;                ///< readings taken on another reflector than stated
  bool line_of_sight = true;                  ///< leave out what station limits and reflector cones do not allow
  double interval_s = 2;                      ///< time between readings
  std::vector<double> time_s{};               ///< [poses] instead, where poses have times
  std::shared_ptr<const SetupDrift> drift{};  ///< of the stations, with its true values; `time_s` is then needed
  int threads = 0;                            ///< 0: all
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in poses; called from one thread at a time
};

struct SimulatedTracker {
  TrackerReadings readings;
  std::vector<std::uint32_t> outliers;  ///< readings made to outliers
  std::vector<std::uint32_t> swapped;   ///< readings taken on another reflector
  std::size_t hidden = 0;               ///< sights left out for lack of a line of sight
};

/// What trackers would read on a machine with these errors, station poses and reflector offsets (both taken as true).
///
/// Noise of a reading depends on (seed, reading) only, so the result does not depend on the number of threads. Noise is
/// normal with TrackerNoise at the true point, along and across the beam.
/// @throws std::invalid_argument for a sight whose station stands on the reflector's body, or no sight at all
SimulatedTracker simulate_tracker(const Machine& machine, const ErrorSet& errors, const TrackerSetup& setup,
                                  const PoseList& poses, const TrackerSimulationOptions& options);

}  // namespace abbe
