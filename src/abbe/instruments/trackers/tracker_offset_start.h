#pragma once

// Internal to instruments: offsets of reflectors that are open, where the stated ones are too far off to find stations.
#include "abbe/instruments/trackers/laser_tracker.h"
#include "abbe/instruments/trackers/tracker_start.h"

namespace abbe {

/// True for a reflector whose offset is to be found with nothing known but a rough guess.
bool offset_is_open(const Reflector& reflector);

/// find_station_poses(), and where a station is not found well with the stated offsets, the open ones from the readings
/// too: R x + t - A o = p is solved for the station (R, t) and the offsets o by linear least squares with free entries
/// of R, which are then made a rotation and refined by Gauss-Newton steps; A, p: body of the reflector seen from that
/// of the station. Up to 45 % of the readings may be wrong (least quantile of squares over subsets, then concentration
/// steps). What the readings do not determine of an offset stays as stated.
///
/// @param tracker   names the items of `readings`
/// @param setup     in: as stated; out: with the offsets that explain the readings much better, if there are any
/// Source: Rousseeuw and Van Driessen, Data Mining Knowl. Discov. 12 (2006) 29 (concentration steps); the equations as
///   find_pose_tracker_start(), without orientations.
TrackerStart find_poses_and_offsets(const Machine& machine, const LaserTracker& tracker,
                                    const InstrumentReadings& readings, TrackerSetup& setup);

}  // namespace abbe
