#pragma once

#include "abbe/instruments/trackers/tracker.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// One state of knowledge: errors of the machine with station poses and reflector offsets that belong to them.
struct TrackerState {
  const ErrorSet* errors = nullptr;
  const TrackerSetup* setup = nullptr;
};

/// How far apart two states predict what a tracker reads at given poses, in the tracker frame: the true error at unseen
/// poses if one state is the truth. Does not depend on the gauge, because the station pose is part of the state.
///
/// @param sights  stations and reflectors compared at every pose; unseen offsets are reflectors like others
/// @return statistics of the distance, mm; `excluded` counts predictions outside a measured range
/// @throws std::invalid_argument if the set-ups do not have the same stations and reflectors
SampleStatistics compare_predictions(const Machine& machine, const TrackerState& truth, const TrackerState& identified,
                                     const PoseList& poses, const std::vector<Sight>& sights, int threads = 0);

}  // namespace abbe
