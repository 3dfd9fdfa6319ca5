#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/study/study.h"
#include "abbe/identify/problem.h"
#include "abbe/identify/walk_intensity.h"
#include "abbe/instruments/setup_drift.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// The drift that is to be identified, with all values zero; null where the plan identifies none.
/// @param device  as the identification starts
/// @param place   file or set-up, for messages
/// @throws InputError where the readings have no times, or one time only
std::shared_ptr<const SetupDrift> assumed_drift(const DriftPlan& plan, const Instrument& device,
                                                const InstrumentReadings& readings, const std::string& place);

/// Times at which readings were taken from each of the stations (one, where an instrument has none): increasing, each
/// once.
std::vector<std::vector<double>> times_by_station(const Instrument& device, const InstrumentReadings& readings);

/// The same drift over given times of each station; a station with fewer than two of them stands still.
std::shared_ptr<const SetupDrift> drift_over(const DriftPlan& plan, const Instrument& device,
                                             const std::vector<std::vector<double>>& times);

/// What a simulated set-up really does at these times: the stated polynomial and a walk that is drawn.
std::shared_ptr<const SetupDrift> true_drift(const DriftPlan& plan, const Instrument& truth,
                                             const std::vector<double>& time_s, RandomStream& random);

/// The random walks of a set-up as joint priors of its unknowns, appended: one for every place and component.
/// @param setup  its index among the observations of the problem
void add_walk_priors(const CampaignSetup& setup, std::size_t index, Problem& problem);
void add_walk_priors(const DriftPlan& plan, const SetupDrift& drift, std::size_t index, Problem& problem);

/// Walks of all set-ups whose intensity is to be estimated: shifts of a place together, and its turns.
std::vector<EstimatedWalk> walks_to_estimate(const Campaign& campaign, const Problem& problem);

/// Further readings of a set-up that drifts, taken between its first and its last reading.
/// @param file  of the readings, for messages. @throws InputError where they were taken at another time
void take_drift_of(const CampaignSetup& setup, const std::string& file, InstrumentReadings& readings);

/// Readings that are no part of a campaign, as its set-up saw them with its first reading: without drift, but with the
/// unknowns that the estimates have.
void stand_at_start_of_drift(const CampaignSetup& setup, InstrumentReadings& readings);

}  // namespace abbe
