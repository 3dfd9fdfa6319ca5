#pragma once

// Campaigns of one machine as arguments: files, errors in memory, results of studies.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/study/comparison/compared_campaigns.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {

/// A results folder or an errors file, errors, or the result of a study.
using CampaignArgument = std::variant<MachineErrors, std::shared_ptr<StudyOutcome>, std::filesystem::path>;
using MachineArgument = std::variant<Machine, std::filesystem::path>;

/// The path of a campaign; null: it is in memory.
const std::filesystem::path* file_of_campaign(const CampaignArgument& argument);

/// Opens the files of campaigns. One in memory is called after its study, or "campaign 2".
/// @param machine  of campaigns that are files; none: machine.toml of each results folder
/// @throws InputError naming the arguments `machine` and `campaigns`
std::vector<IdentifiedCampaign> campaigns_of(const std::vector<CampaignArgument>& arguments,
                                             const std::optional<MachineArgument>& machine);

/// Names that are given take the place of those of files; a campaign in memory is called so in messages too.
/// @throws InputError for another number of names, and for names that are empty or given twice
void give_names(const std::vector<std::string>& names, std::vector<IdentifiedCampaign>& campaigns);

/// A warning of Python for each reason why these errors are marked as not to be trusted.
void warn_of_distrusted(const IdentifiedCampaign& campaign);

}  // namespace abbe::python
