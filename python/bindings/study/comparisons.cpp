#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <set>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/study/compared_campaigns.h"
#include "abbe/study/results.h"
#include "bindings/evaluate/report.h"
#include "bindings/job.h"
#include "bindings/study/compared_parts.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {
namespace {

/// A results folder or an errors file, errors, or the result of a study.
using CampaignArgument = std::variant<MachineErrors, std::shared_ptr<StudyOutcome>, std::filesystem::path>;
using MachineArgument = std::variant<Machine, std::filesystem::path>;

/// The machine of campaigns that are files.
std::optional<Machine> machine_of_files(const std::optional<MachineArgument>& argument,
                                        const std::vector<CampaignArgument>& campaigns) {
  if (!argument) return std::nullopt;
  const bool is_used = std::any_of(campaigns.begin(), campaigns.end(), [](const CampaignArgument& campaign) {
    return std::holds_alternative<std::filesystem::path>(campaign);
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
  if (const auto* const path = std::get_if<std::filesystem::path>(&argument)) {
    return computed([&] { return read_campaign(path->string(), machine); });
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

/// Names that are given take the place of those of files; a campaign in memory is called so in messages too.
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

std::vector<IdentifiedCampaign> campaigns_of(const std::vector<CampaignArgument>& arguments,
                                             const std::optional<MachineArgument>& machine,
                                             const std::optional<std::vector<std::string>>& names) {
  const std::optional<Machine> of_files = machine_of_files(machine, arguments);
  std::vector<IdentifiedCampaign> campaigns;
  std::vector<std::string> paths;
  for (const CampaignArgument& argument : arguments) {
    campaigns.push_back(campaign_of(argument, of_files, campaigns.size() + 1));
    const auto* const path = std::get_if<std::filesystem::path>(&argument);
    paths.push_back(path ? path->string() : campaigns.back().name);
  }
  if (names) {
    give_names(*names, campaigns);
  } else {
    make_names_different(campaigns, paths);
  }
  return campaigns;
}

void warn_of_distrusted(const IdentifiedCampaign& campaign) {
  for (const std::string& reason : campaign.errors.distrusted) {
    const std::string text = fmt::format("{}: marked as not to be trusted: {}", campaign.errors_file, reason);
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw nb::python_error();
  }
}

ComparedCampaigns comparison_of(const std::vector<CampaignArgument>& campaigns,
                                const std::optional<MachineArgument>& machine,
                                const std::optional<std::vector<std::string>>& names, double level_percent,
                                const Tolerances& tolerances, bool page, const nb::object& progress) {
  CompareRequest request;
  request.level = level_percent / 100;
  request.tolerances = tolerance_texts(tolerances);
  request.page = page;
  request.campaigns = campaigns_of(campaigns, machine, names);
  for (const IdentifiedCampaign& campaign : request.campaigns) warn_of_distrusted(campaign);
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return compare_campaigns(request, control.options("comparing campaigns")); });
  });
}

std::string summary_of(const ComparedCampaigns& result) {
  std::size_t changed = 0;
  for (const ComparedPair& pair : result.pairs) changed += pair.count(ChangeVerdict::changed);
  return fmt::format("<abbe.Comparison of {} campaigns: {} significant changes in {} pairs{}{}>", result.names.size(),
                     changed, result.pairs.size(), result.is_judged() ? "" : ", not all judged",
                     result.report.exceeds_tolerance() ? ", a tolerance is exceeded" : "");
}

}  // namespace

void bind_comparisons(nb::module_& module) {
  bind_compared_parts(module);
  nb::class_<ComparedCampaigns> bound(
      module, "Comparison",
      "What changed in a machine from one campaign to the next. Made by compare().\n\n"
      "figures are those of the report; pairs has the errors, curves and maps behind them. text(), json_text(),\n"
      "page_html() and write() give what `abbe compare` writes.");
  add_report(bound, &ComparedCampaigns::report, &comparison_files);
  bound.def_ro("machine", &ComparedCampaigns::machine, "Of the first campaign, with the travel that all have.")
      .def_ro("names", &ComparedCampaigns::names, "Of the campaigns, in the order of time.")
      .def_prop_ro(
          "level_percent", [](const ComparedCampaigns& r) { return 100 * r.level; },
          "Probability that any error of a pair is called changed if none has.")
      .def_ro("pairs", &ComparedCampaigns::pairs,
              "Each campaign against the first; with three or more then each but the second against the one before.")
      .def_prop_ro("judged", &ComparedCampaigns::is_judged,
                   "Whether every pair has errors to compare and the significance of all of them is known.")
      .def_prop_ro(
          "ok", [](const ComparedCampaigns& r) { return r.is_judged() && !r.report.exceeds_tolerance(); },
          "Whether all is judged and no figure exceeds its tolerance. Changes alone are no reason to say no.")
      .def("__repr__", &summary_of);
  module.def(
      "compare", &comparison_of, nb::arg("campaigns"), nb::kw_only(), nb::arg("machine") = nb::none(),
      nb::arg("names") = nb::none(), nb::arg("level_percent") = 5.0, nb::arg("tolerances") = Tolerances{},
      nb::arg("page") = true, nb::arg("progress") = nb::none(),
      "What changed in a machine from one campaign to the next, and whether significantly: `abbe compare`.\n\n"
      "campaigns: two to 26 in the order of time, each a results folder, an errors file, Errors or a StudyResult.\n"
      "machine: a Machine or its file, for campaigns that are files; default: machine.toml of each results folder.\n"
      "names: of the campaigns, for texts; default: of files, folders and studies. level_percent: probability that "
      "any\n"
      "error of a pair is called changed if none has, above 0 to 50. tolerances: {'V_max_um': 10}; with three or more\n"
      "campaigns {'V_max_C_A_um': 10}. page: whether there are curves, plots and the map of the page. progress: a\n"
      "function of the step, the pairs done and their number; Ctrl-C takes effect after a pair. Raises InputError, "
      "and\n"
      "warns of errors that are marked as not to be trusted. Method and figures: docs/compare.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> march, october = abbe.Errors(mill), abbe.Errors(mill)\n"
      ">>> march.add_location('EC0Y', value_urad=20, u_urad=2)\n"
      ">>> october.add_location('EC0Y', value_urad=50, u_urad=2)\n"
      ">>> error = abbe.compare([march, october]).pairs[0]['EC0Y']\n"
      ">>> round(1e6 * error.change_mm_rad, 3), round(1e6 * error.expanded_uncertainty_mm_rad, 3), error.verdict\n"
      "(30.0, 5.657, 'changed')\n");
}

}  // namespace abbe::python
