#pragma once

// Internal to study: what was found about campaigns, as a report.
#include <string>
#include <vector>

#include "abbe/study/comparison/compared_campaigns.h"

namespace abbe {

/// "A" of the first campaign.
std::string campaign_letter(std::size_t campaign);
/// "B - A" of a pair, in a table; "B-A" in names of files.
std::string pair_words(const ComparedPair& pair);
std::string pair_suffix(const ComparedPair& pair);

/// How many errors changed, and which: "2 of 17 errors changed: EXX, EC0Y".
std::string changed_words(const ComparedPair& pair);

/// The changes of a pair, what matters most first: significant ones by what they do at the tool, then the others.
EvaluationTable table_of_changes(const ComparedCampaigns& result, const ComparedPair& pair);
/// With three or more campaigns: a column for each pair.
EvaluationTable table_against_first(const ComparedCampaigns& result);
EvaluationTable table_of_drift(const ComparedCampaigns& result);
/// What a pair cannot be compared in, and why; without rows if there is nothing.
EvaluationTable table_of_the_rest(const ComparedPair& pair);

/// Everything about the pairs for programs; units in the keys.
nlohmann::ordered_json comparison_details(const ComparedCampaigns& result);

/// Curves of the error motions and their changes, a plot each.
std::vector<EvaluationPlot> comparison_plots(const ComparedCampaigns& result);

/// Facts, figures, tables, notes, details and, if the request wants a page, plots and the map: from everything else in
/// the result.
void write_comparison_report(const CompareRequest& request, ComparedCampaigns& result);

}  // namespace abbe
