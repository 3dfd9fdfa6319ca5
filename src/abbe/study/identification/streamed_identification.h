#pragma once

#include <memory>
#include <string>
#include <vector>

#include "abbe/formats/readings/reading_shards.h"
#include "abbe/identify/identify.h"
#include "abbe/study/campaign.h"
#include "abbe/study/study_steps.h"

namespace abbe {

/// The readings of a set-up where they are more than the study keeps in memory; null where they are not.
/// @throws InputError also where the study asks for something that needs all readings in memory
std::shared_ptr<const ReadingShards> shards_too_large(const Study& study, const Setup& setup,
                                                      const JobOptions& options);

/// Takes the instrument and the kept readings from the shards of a set-up.
/// @param warnings  what is of the kept readings only; appended
void take_shards(CampaignSetup& setup, std::vector<std::string>& warnings);

/// Number of all readings, those included that are not in memory.
std::size_t all_reading_count(const CampaignSetup& setup);
std::size_t all_reading_count(const Campaign& campaign);

bool is_streamed(const Campaign& campaign);

/// Identifies from all readings of a campaign with shards. The problem of the result keeps the readings that are in
/// memory, at the estimates; outliers are listed among these, and counted among all.
///
/// Every sum is numbered work (IdentificationJob::work), which can be kept in a file and shared by processes.
/// @throws InputError if a file of readings has changed meanwhile; Stopped
void identify_streamed(const Study& study, const IdentifyOptions& given, const IdentificationJob& job,
                       StudyResult& result);

}  // namespace abbe
