#pragma once

#include "abbe/identify/planning/planning_space.h"
#include "abbe/identify/problem.h"

namespace abbe {

/// Every used reading of a problem as a candidate: the rows of its whitened Jacobian at the present values, over the
/// vector of estimates, in order of observations and readings. No costs.
///
/// Build the observations from readings that could be taken; what they would read need not be known, only their
/// uncertainties (the noise model at the measured point).
PlanningCandidates candidate_rows(const Problem& problem);

}  // namespace abbe
