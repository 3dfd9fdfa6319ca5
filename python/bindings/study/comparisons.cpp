#include <fmt/format.h>

#include "abbe/study/comparison/compared_campaigns.h"
#include "bindings/evaluate/report.h"
#include "bindings/job.h"
#include "bindings/study/campaign_arguments.h"
#include "bindings/study/compared_parts.h"

namespace abbe::python {
namespace {

/// With names that are all different.
std::vector<IdentifiedCampaign> named_campaigns(const std::vector<CampaignArgument>& arguments,
                                                const std::optional<MachineArgument>& machine,
                                                const std::optional<std::vector<std::string>>& names) {
  std::vector<IdentifiedCampaign> campaigns = campaigns_of(arguments, machine);
  if (names) {
    give_names(*names, campaigns);
    return campaigns;
  }
  std::vector<std::string> paths;
  for (std::size_t k = 0; k < campaigns.size(); ++k) {
    const std::filesystem::path* const path = file_of_campaign(arguments[k]);
    paths.push_back(path ? path->string() : campaigns[k].name);
  }
  make_names_different(campaigns, paths);
  return campaigns;
}

ComparedCampaigns comparison_of(const std::vector<CampaignArgument>& campaigns,
                                const std::optional<MachineArgument>& machine,
                                const std::optional<std::vector<std::string>>& names, double level_percent,
                                const Tolerances& tolerances, bool page, const nb::object& progress) {
  CompareRequest request;
  request.level = level_percent / 100;
  request.tolerances = tolerance_texts(tolerances);
  request.page = page;
  request.campaigns = named_campaigns(campaigns, machine, names);
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
          "Probability that any error of a pair is reported as changed if none has.")
      .def_ro("pairs", &ComparedCampaigns::pairs,
              "Each campaign against the first; with three or more then each but the second against the one before.")
      .def_prop_ro("judged", &ComparedCampaigns::is_judged,
                   "Whether every pair has errors to compare and the significance of all of them is known.")
      .def_prop_ro(
          "ok", [](const ComparedCampaigns& r) { return r.is_judged() && !r.report.exceeds_tolerance(); },
          "Whether all is judged and no figure exceeds its tolerance. Changes alone do not make it false.")
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
      "error of a pair is reported as changed if none has, above 0 to 50. tolerances: {'V_max_um': 10}; with three or "
      "more\n"
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
