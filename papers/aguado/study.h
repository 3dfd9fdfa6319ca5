#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/strategies.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Aguado's machine, `w C' X' b Z t`: X 0..1400 mm, Z 0..600 mm, C one turn, as in the reference data.
Machine aguado_machine();

/// The known truth behind the reference readings and the figures an independent program found from them.
struct AguadoTruth {
  ErrorSet errors;
  TrackerSetup setup;  ///< one station on the table, three reflectors
  struct Expected {
    double initial_mean = 0, residual_mean = 0, validation_mean = 0, validation_max = 0;  ///< um
  };
  Expected expected(const std::string& key) const;  ///< "n500_noiseLT", ...
  std::vector<std::pair<std::string, Expected>> figures;
};
AguadoTruth read_aguado_truth();

/// Reference readings of `aguado_<name>.csv`, indices as in AguadoTruth::setup.
TrackerReadings read_aguado_readings(const std::string& name);

/// Orders of the model: Legendre degree of X and Z, harmonics of C.
struct AguadoOrders {
  int x = 4, z = 4, c = 4;
  bool constant_of_c = true;          ///< false: no constant terms of C, as the paper's (15)
  bool estimate_pose = true;          ///< false: station pose known
  bool rotary = true, linear = true;  ///< which axes have error motions at all
};
ErrorSet aguado_model(const AguadoOrders& orders);

struct AguadoFit {
  Identification identification;   ///< `converged`: every stage of the strategy has reached a minimum
  std::size_t rank = 0;            ///< of the readings at the nominal machine, of all parameters
  std::size_t open_alone = 0;      ///< combinations of the errors that the readings leave open with the pose known
  TrackerSetup setup;              ///< station and reflectors as identified
  SampleStatistics initial;        ///< nominal machine at the true station pose, at the readings, mm
  SampleStatistics residual;       ///< after the fit, at the readings, mm
  SampleStatistics unseen;         ///< identified against true, at poses and offsets that were not measured, mm
  SampleStatistics unseen_before;  ///< nominal against true there, mm

  /// Combinations of the errors and the pose of the tracker that only the unknown pose leaves open. Negative if the two
  /// ranks, each with a threshold of its own, contradict each other.
  int shared_with_pose() const {
    return static_cast<int>(identification.parameters.size()) - static_cast<int>(rank) - static_cast<int>(open_alone);
  }
};

/// Identifies readings by one strategy and compares with the truth at 2,000 unseen random poses with new offsets.
AguadoFit fit_aguado(const AguadoTruth& truth, const TrackerReadings& readings, const TrackerNoise& noise,
                     const AguadoOrders& orders, Strategy strategy = Strategy::joint, int threads = 0);

/// Distance between what the tracker sees on the true machine and what a state predicts, pose by pose with the first
/// reflector, mm.
std::vector<double> aguado_distances(const AguadoTruth& truth, const ErrorSet& errors, const TrackerSetup& setup,
                                     const PoseList& poses);

}  // namespace abbe
