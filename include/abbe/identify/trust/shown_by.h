#pragma once

#include <string>
#include <vector>

#include "abbe/identify/trust/unseen.h"

namespace abbe {

/// What shows an error that a study could estimate but does not.
struct ShownBy {
  bool by_readings = false;  ///< the readings at hand do, if it is estimated too
  bool shown = false;        ///< one of the measurements tried does, or several together
  std::string remedy;        ///< its words; empty: none of them
};

/// Asks of groups of parameters whether the readings show them when everything in the problem is estimated, and if not,
/// which of the possible measurements would.
///
/// A group counts as shown if less than a tenth of each of its directions is left open, without the part that none of
/// the measurements tells apart, as in unseen_advice(): seen is what changes the readings by more than their noise when
/// errors have a typical size.
/// @param problem  with the groups among its estimates. All errors zero, the unknowns of the set-ups as they are;
///                 the observations are moved there
/// @param groups   entries of the vector of estimates, e.g. the orders of one error motion that are no convention
std::vector<ShownBy> shown_by(const Problem& problem, const std::vector<std::vector<std::size_t>>& groups,
                              const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options = {},
                              int threads = 0);

}  // namespace abbe
