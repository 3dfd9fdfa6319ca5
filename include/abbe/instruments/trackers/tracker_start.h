#pragma once

#include <string>
#include <vector>

#include "abbe/geometry/best_fit_transform.h"
#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

struct StationStart {
  BestFitStatus status = BestFitStatus::not_run;
  RigidTransform body_from_tracker;  ///< as TrackerStation; meaningful for ok, one of many for collinear
  double rms_mm = 0;                 ///< of the readings that took part
  double extent_mm = 0;              ///< root mean square distance of the reflectors' points from their mean
  std::size_t readings = 0;
  std::size_t outliers = 0;  ///< readings that took no part
  std::string note;          ///< empty, or in words what is not determined and why
};

/// A run of readings that another reflector explains better.
struct SwappedReflector {
  std::size_t first = 0, last = 0;  ///< readings, both included
  std::size_t stated = 0;           ///< index of the reflector in the data
  std::size_t better = 0;           ///< index of the one that fits
  double stated_mm = 0;             ///< mean distance with the stated one
  double better_mm = 0;             ///< mean distance with the better one
};

struct TrackerStart {
  std::vector<StationStart> stations;  ///< [stations]
  std::vector<SwappedReflector> swapped;
  std::vector<std::string> messages;  ///< for people: "readings 17..23: reflector2 fits better than reflector1 ..."
  bool determined() const;            ///< every station with readings has status ok
};

struct TrackerStartOptions {
  RobustFitOptions fit;
  /// Another reflector explains a reading if its distance is below this; 0: six times the robust scale of the station's
  /// fit.
  double tolerance_mm = 0;
};

/// Finds the pose of every station from the data: robust best fit of the measured points to where the machine with
/// `errors` (nominal: an empty set) puts the reflectors. Nothing need be known of the poses. Then looks for readings
/// taken on another reflector than stated.
/// @throws std::invalid_argument as validate()
TrackerStart find_station_poses(const Machine& machine, const ErrorSet& errors, const TrackerSetup& setup,
                                const TrackerReadings& readings, const TrackerStartOptions& options = {});

/// Puts the poses found into the stations that are estimated and have one; the others keep theirs.
void apply(const TrackerStart& start, TrackerSetup& setup);

}  // namespace abbe
