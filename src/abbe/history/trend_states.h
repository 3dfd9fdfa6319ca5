#pragma once

// Internal to history: campaigns whose errors depend on states, at one state.
#include <string>
#include <vector>

#include "abbe/history/machine_trends.h"

namespace abbe {

/// Campaigns with their errors at one state of the machine.
struct CampaignsAtState {
  std::vector<IdentifiedCampaign> campaigns;
  StateValues at_state;  ///< empty: no errors have states that are given
  /// [campaigns] names of the errors that are extrapolated there; empty without states.
  std::vector<std::vector<std::string>> extrapolated;
};

/// Brings the errors of campaigns to one state: terms without a state become the errors there, terms with a state stay
/// what they are, per unit of their state.
/// @param states  texts of --state; a state that is not among them has its reference in the newest campaign
/// @throws InputError for texts that name no state of any campaign
CampaignsAtState campaigns_at_state(std::vector<IdentifiedCampaign> campaigns, const std::vector<std::string>& states);

/// Variance per day that an error gains at a place, as the file of a campaign says ([ageing]); mm^2 or rad^2.
/// @param at  position on its axis: of a motion
double wander_per_day(const IdentifiedCampaign& campaign, const std::string& error, std::optional<double> at);

}  // namespace abbe
