#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/formats/study/study.h"
#include "abbe/identify/term_selection.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// Terms with states that the readings support, and what is identified as a result.
struct ChosenTerms {
  std::vector<std::string> candidates;  ///< "EXX*ambient", in the order of the study
  std::vector<std::size_t> most;        ///< [candidates] levels that it could have had
  TermSelection selection;
  IdentificationPlan plan;  ///< without the terms that were not taken; the study's where nothing could be chosen
};

/// Chooses by held-out blocks of time among the terms of the study that are optional or have several orders.
/// @param problem  of the study with all of them
/// @throws InputError where readings have no times
ChosenTerms choose_terms(const Study& study, const Campaign& campaign, const Problem& problem,
                         const IdentifyOptions& options);

/// What was chosen and by how much the held-out error fell, a line each.
std::string chosen_terms_text(const ChosenTerms& terms);
nlohmann::ordered_json chosen_terms_json(const ChosenTerms& terms);

}  // namespace abbe
