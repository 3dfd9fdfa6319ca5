#include "bindings/study/campaign_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// The machine of campaigns that are files.
std::optional<Machine> machine_of_files(const std::optional<MachineArgument>& argument,
                                        const std::vector<CampaignArgument>& campaigns) {
  if (!argument) return std::nullopt;
  const bool is_used = std::any_of(campaigns.begin(), campaigns.end(), [](const CampaignArgument& campaign) {
    return file_of_campaign(campaign) != nullptr;
  });
  if (!is_used) {
    throw InputError({.field = "machine"}, "has no effect on campaigns that are no files", "no machine, or files");
  }
  if (const auto* const machine = std::get_if<Machine>(&*argument)) return *machine;
  return computed([&] { return read_machine(std::get<std::filesystem::path>(*argument)); });
}

/// @param number  from 1
IdentifiedCampaign campaign_of(const CampaignArgument& argument, const std::optional<Machine>& machine,
                               std::size_t number) {
  if (const auto* const path = file_of_campaign(argument)) {
    return computed([&] { return read_campaign(path->string(), machine, StatesOfErrors::allowed); });
  }
  const auto in_memory = [](const std::string& name, const MachineErrors& errors) {
    return IdentifiedCampaign{name, name, errors.machine, errors.file};
  };
  if (const auto* const errors = std::get_if<MachineErrors>(&argument)) {
    return in_memory(fmt::format("campaign {}", number), *errors);
  }
  const auto& outcome = std::get<std::shared_ptr<StudyOutcome>>(argument);
  if (!outcome) throw nb::type_error("a campaign is None; expected a path, Errors or a StudyResult");
  return in_memory(outcome->study->name, identified_errors(*outcome));
}

}  // namespace

const std::filesystem::path* file_of_campaign(const CampaignArgument& argument) {
  return std::get_if<std::filesystem::path>(&argument);
}

std::vector<IdentifiedCampaign> campaigns_of(const std::vector<CampaignArgument>& arguments,
                                             const std::optional<MachineArgument>& machine) {
  const std::optional<Machine> of_files = machine_of_files(machine, arguments);
  std::vector<IdentifiedCampaign> campaigns;
  for (const CampaignArgument& argument : arguments) {
    campaigns.push_back(campaign_of(argument, of_files, campaigns.size() + 1));
  }
  return campaigns;
}

void give_names(const std::vector<std::string>& names, std::vector<IdentifiedCampaign>& campaigns) {
  if (names.size() != campaigns.size()) {
    throw InputError({.field = "names"}, fmt::format("has {}", names.size()),
                     fmt::format("{}, one for each campaign", campaigns.size()));
  }
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size()) {
    throw InputError({.field = "names"}, "has a name twice", "another name for each campaign");
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k].empty()) throw InputError({.field = "names"}, "has an empty text", "a name for each campaign");
    if (campaigns[k].errors_file == campaigns[k].name) campaigns[k].errors_file = names[k];
    campaigns[k].name = names[k];
  }
}

void warn_of_distrusted(const IdentifiedCampaign& campaign) {
  for (const std::string& reason : campaign.errors.distrusted) {
    const std::string text = fmt::format("{}: marked as not to be trusted: {}", campaign.errors_file, reason);
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw nb::python_error();
  }
}

}  // namespace abbe::python
