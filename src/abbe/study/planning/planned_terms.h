#pragma once

// Terms with states as an identification plan has them, for choices by held-out blocks of time.
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/formats/study/study.h"
#include "abbe/identify/term_selection.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// A term with a state and where it stands in the plan.
struct PlannedTerm {
  CandidateTerm term;
  bool is_location = false;
  std::size_t index = 0;
  std::size_t state = kNoState;
};

enum class TermsWanted {
  to_be_chosen,  ///< those that are optional or have several orders
  all            ///< with a state
};

/// @param errors  of the problem, with the motions and locations of the plan
std::vector<PlannedTerm> planned_terms(const Study& study, const ErrorSet& errors, TermsWanted wanted);

/// Blocks of time of all set-ups, as the plan divides them.
/// @param what  is done by them, for the message: "terms with states are chosen"
/// @throws InputError where readings have no times
std::vector<TimeBlocks> blocks_of_time(const Study& study, const Campaign& campaign, const std::string& what);

}  // namespace abbe
