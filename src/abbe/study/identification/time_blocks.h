#pragma once

#include <cstdint>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/problem.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// True if the readings of a set-up are a time series: they have times, and what is identified depends on states that
/// change with time, or the set-up drifts. Neighbours in time then share what the model lacks.
bool is_time_series(const Machine& machine, const ErrorSet& errors, const CampaignSetup& setup);

/// Holds out about a fraction of the readings in blocks without a break in time, evenly over the whole time. Readings
/// of one time stay together; the first and the last block take part in the fit.
void hold_out_blocks(const std::vector<double>& time_s, double fraction, RandomStream random,
                     std::vector<std::uint8_t>& use);

/// Says which readings belong to one block of time, counted from the first reading of a set-up.
/// @throws InputError where readings have no times
void mark_noise_blocks(double block_s, const Campaign& campaign, Problem& problem);

}  // namespace abbe
