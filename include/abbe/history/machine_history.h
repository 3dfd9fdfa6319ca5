#pragma once

// Campaigns of one machine over the years, as `abbe history` keeps them:
//
//   #include <abbe/history/machine_history.h>
//   #include <abbe/history/machine_trends.h>
//
//   #include <cstdio>
//   #include <filesystem>
//   #include <utility>
//
//   int main() {
//     const std::string file = (std::filesystem::temp_directory_path() / "abbe_example.history").string();
//     std::filesystem::remove(file);
//     std::vector<abbe::CampaignToKeep> campaigns;
//     for (const auto& [month, day] : {std::pair("march", "2026-03-02"), {"june", "2026-06-01"}, {"october",
//     "2026-10-05"}})
//       campaigns.push_back(abbe::campaign_to_keep(std::string("examples/compare/") + month + ".errors.toml",
//                                                  "examples/machines/three-axis-mill.machine.toml",
//                                                  abbe::date_of(day)));
//     abbe::add_to_history(file, campaigns);
//     abbe::TrendRequest request;
//     request.campaigns = abbe::read_history(file);
//     for (const abbe::ErrorTrend& trend : abbe::find_trends(request).errors) {
//       if (!trend.expected || trend.expected->is_within) continue;
//       std::printf("%s changed by %.1f um, which the campaigns before do not predict\n", trend.name.c_str(),
//                   1e3 * trend.values.back().value);
//     }
//     std::filesystem::remove(file);
//     return 0;
//   }
//
// It prints:
//
//   EXX changed by 7.6 um, which the campaigns before do not predict
//
// A history is one file, a database of SQLite, to which several programs may add at a time. Method: docs/history.md.

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/study/comparison/compared_campaigns.h"

namespace abbe {

using Date = std::chrono::sys_days;

/// A day as files and options write it, "2026-03-02". @throws InputError for anything else. @param field  for messages
Date date_of(const std::string& text, const std::string& field = "--date");
std::string date_text(Date date);

/// A campaign that is to be added.
struct CampaignToKeep {
  IdentifiedCampaign campaign;
  Date measured{};
  std::string source;   ///< where it came from, for people
  std::string summary;  ///< summary.json of its results folder, or empty
};

/// Opens the files of a campaign.
/// @param path          results folder of `abbe run`, or an errors file
/// @param machine_file  empty: machine.toml of the results folder
/// @throws InputError as read_campaign()
CampaignToKeep campaign_to_keep(const std::string& path, const std::string& machine_file, Date measured);

/// A campaign of a history.
struct KeptCampaign {
  std::int64_t number = 0;  ///< in the order in which they were added, from 1
  IdentifiedCampaign campaign;
  Date measured{};
  std::string source, summary;
  std::string added;         ///< when, UTC: "2026-03-02T08:15:00Z"
  std::string abbe_version;  ///< of the program that added it
};

/// Adds campaigns, all or none. A history that does not exist is made.
/// @return their numbers
/// @throws InputError for a file that is no history, another machine than that of the history, a campaign that is in
///   it already, and errors that a file cannot state, such as those that are not finite
std::vector<std::int64_t> add_to_history(const std::string& path, const std::vector<CampaignToKeep>& campaigns);

/// All campaigns, in the order in which they were measured. @throws InputError also for a history that does not exist
std::vector<KeptCampaign> read_history(const std::string& path);

/// The campaign of this number. @throws InputError as read_history(), and for a number that is not in the history
KeptCampaign campaign_of_history(const std::string& path, std::int64_t number);

/// For people: a line with number, date, name and source for each campaign.
std::string history_text(const std::vector<KeptCampaign>& campaigns);
/// The same for programs, with the time of adding and the version of Abbe.
nlohmann::ordered_json history_json(const std::vector<KeptCampaign>& campaigns);

/// Files of a results folder of this campaign, name and contents, as `abbe history export` writes them: machine.toml,
/// errors.toml, its covariance and summary.json, as far as there are any.
std::vector<std::pair<std::string, std::string>> campaign_files(const KeptCampaign& campaign);

}  // namespace abbe
