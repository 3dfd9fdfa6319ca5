#pragma once

#include <string>
#include <vector>

#include "abbe/geometry/trilateration.h"
#include "abbe/instruments/trackers/tracking_interferometer.h"

namespace abbe {

struct TrackingStationStart {
  TrilaterationStatus status = TrilaterationStatus::not_run;  ///< not_run: no readings, or the position is known
  Eigen::Vector3d position = Eigen::Vector3d::Zero();         ///< mm, frame of the station's body
  Eigen::Vector3d other = Eigen::Vector3d::Zero();            ///< mirrored: the position that was not taken
  double rms_mm = 0;                                          ///< of the lengths that took part
  double extent_mm = 0;  ///< root mean square distance of the reflectors' points from their mean
  std::size_t readings = 0;
  std::size_t outliers = 0;  ///< readings that took no part
};

struct TrackingStart {
  std::vector<TrackingStationStart> stations;  ///< [stations]
  std::vector<double> values;                  ///< [quantities()] with positions and dead paths found put in
  std::vector<std::string> messages;           ///< for people: what is ambiguous or not determined, and why
  bool determined() const;                     ///< every station sought was found, and only one position fits
};

/// Where the stations stand and how long the dead paths are, from the lengths alone: trilateration from where the
/// machine with `errors` (nominal: an empty set) puts the reflectors.
///
/// Sought are stations of which a coordinate is Knowledge::open, and open dead paths; the given position decides
/// between mirrored ones, which is said. At most 2000 readings per station take part, evenly spread.
/// @throws std::invalid_argument as check_readings()
TrackingStart find_tracking_start(const Machine& machine, const ErrorSet& errors,
                                  const TrackingInterferometer& tracking, const InstrumentReadings& readings,
                                  const TrilaterationOptions& options = {});

}  // namespace abbe
