#pragma once

// Internal to study: the unknowns of set-ups alone, with the errors of the machine held.
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/identify/problem.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// A problem that estimates the unknowns of set-ups from their readings and from what is known of them beforehand.
/// @param use  [setups][readings] as SelectedObservations::use
Problem setups_problem(const Machine& machine, const ErrorSet& errors, std::span<const CampaignSetup> setups,
                       std::span<const std::vector<std::uint8_t>> use);

}  // namespace abbe
