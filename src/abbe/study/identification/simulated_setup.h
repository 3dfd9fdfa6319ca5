#pragma once

#include <cstddef>

#include "abbe/errors/error_set.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/study/study.h"
#include "abbe/study/campaign.h"
#include "abbe/study/job_options.h"

namespace abbe {

/// Simulates the readings of a set-up by its plans.
/// @param truth   errors of the simulated machine
/// @param result  has its name and instruments; gets readings, exact readings, the true instrument and its drift
/// @throws InputError where the instrument reads nothing, and where poses give no value of a state of the true errors
void simulate_setup(const Study& study, std::size_t setup_index, const ErrorSet& truth, const JobOptions& job,
                    const ChannelUse& channels, CampaignSetup& result);

}  // namespace abbe
