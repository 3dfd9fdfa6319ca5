#pragma once

// Internal to instruments: where a six-dimensional tracker stands and how its targets are mounted, from its readings.
#include <string>
#include <vector>

#include "abbe/instruments/trackers/pose_tracker.h"

namespace abbe {

/// The body of every reading's item, seen from the body of the station, [readings].
std::vector<RigidTransform> seen_bodies(const Machine& machine, const ErrorSet& errors, const Instrument& instrument,
                                        const InstrumentReadings& readings);

struct PoseTrackerStart {
  PoseTrackerSetup setup;  ///< with what was found
  StartFit fit;
  std::vector<std::string> messages;
};

/// The station's pose from the positions alone: a robust best fit to where the nominal machine puts the targets. Where
/// an offset is open, also from positions and orientations together, with nothing known: R_s R_k = A_k M is solved for
/// both rotations by the largest singular values of the mean of R_k (x) A_k, then the translations by linear least
/// squares. Of the two the one counts that leaves less. The orientations of the targets are the means of A_k' R_s R_k.
/// @param given  with estimated numbers at any values
/// Source: Shah, J. Mechanisms Robotics 5 (2013) 031007 (robot-world and hand-eye calibration by Kronecker products).
PoseTrackerStart find_pose_tracker_start(const Machine& machine, const PoseTrackerSetup& given,
                                         const InstrumentReadings& readings);

}  // namespace abbe
