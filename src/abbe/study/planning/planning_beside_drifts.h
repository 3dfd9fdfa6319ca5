#pragma once

#include <vector>

#include "abbe/identify/planning_candidates.h"
#include "abbe/instruments/instrument.h"

namespace abbe {

/// Rows of the estimates that are no drift, beside those that are: A - Q Q'A, with Q an orthonormal basis of the
/// columns of the drift, over the readings and the priors of walks.
/// @param all       rows of all estimates
/// @param readings  [observations] with their drifts
PlanningCandidates beside_drifts(const Problem& problem, const PlanningCandidates& all,
                                 const std::vector<InstrumentReadings>& readings);

}  // namespace abbe
