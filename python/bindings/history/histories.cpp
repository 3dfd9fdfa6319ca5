#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "abbe/formats/files/results_files.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/history/machine_history.h"
#include "abbe/history/machine_trends.h"
#include "abbe/study/report/summary.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/history/dates.h"
#include "bindings/history/trends.h"
#include "bindings/job.h"
#include "bindings/study/campaign_arguments.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// The name of a history. Every call opens the file and closes it again.
struct HistoryFile {
  std::filesystem::path path;
};

/// summary.json of a campaign, or empty.
std::string summary_of_campaign(const CampaignArgument& argument) {
  if (const auto* const path = file_of_campaign(argument)) {
    return is_results_folder(path->string()) ? results_summary_text(path->string()) : std::string();
  }
  const auto* const outcome = std::get_if<std::shared_ptr<StudyOutcome>>(&argument);
  return outcome ? json_text(study_summary(*(*outcome)->study, (*outcome)->result)) : std::string();
}

std::vector<CampaignToKeep> campaigns_to_keep(const std::vector<CampaignArgument>& arguments, const DaysArgument& days,
                                              const std::optional<MachineArgument>& machine,
                                              const std::optional<std::vector<std::string>>& names) {
  const std::vector<Date> dates = days_of(days, "dates");
  if (dates.size() != arguments.size()) {
    throw InputError({.field = "dates"}, fmt::format("has {}", dates.size()),
                     fmt::format("{}, one for each campaign", arguments.size()));
  }
  std::vector<IdentifiedCampaign> campaigns = campaigns_of(arguments, machine);
  for (std::size_t k = 0; k < campaigns.size(); ++k) {
    // Campaigns that are added one by one would all have the same number.
    if (!std::holds_alternative<MachineErrors>(arguments[k])) continue;
    campaigns[k].name = date_text(dates[k]);
    campaigns[k].errors_file = campaigns[k].name;
  }
  if (names) give_names(*names, campaigns);
  std::vector<CampaignToKeep> result;
  for (std::size_t k = 0; k < campaigns.size(); ++k) {
    warn_of_distrusted(campaigns[k]);
    const auto* const path = file_of_campaign(arguments[k]);
    result.push_back(
        {std::move(campaigns[k]), dates[k], path ? path->string() : "memory", summary_of_campaign(arguments[k])});
  }
  return result;
}

std::vector<std::int64_t> add_campaigns(const HistoryFile& history, const std::vector<CampaignArgument>& arguments,
                                        const DaysArgument& dates, const std::optional<MachineArgument>& machine,
                                        const std::optional<std::vector<std::string>>& names) {
  const std::vector<CampaignToKeep> campaigns = campaigns_to_keep(arguments, dates, machine, names);
  return computed([&] { return add_to_history(history.path.string(), campaigns); });
}

std::vector<KeptCampaign> campaigns_in(const HistoryFile& history) {
  return computed([&] { return read_history(history.path.string()); });
}

MachineTrends trends_of(const HistoryFile& history, std::optional<double> limit_um, std::size_t last,
                        const std::optional<std::map<std::string, double>>& states, bool page,
                        const nb::object& progress) {
  if (limit_um && !(*limit_um > 0 && *limit_um <= 1e6)) {
    throw InputError({.field = "limit_um"}, fmt::format("is {}", *limit_um), "above 0 to 1e6 um, or None");
  }
  TrendRequest request;
  request.limit_mm = limit_um.value_or(0) * 1e-3;
  request.last = last;
  request.page = page;
  if (states) {
    for (const auto& [name, value] : *states) request.states.push_back(fmt::format("{}={}", name, value));
  }
  request.campaigns = campaigns_in(history);
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return find_trends(request, control.options("comparing campaigns")); });
  });
}

void bind_kept_campaign(nb::module_& module) {
  using Kept = KeptCampaign;
  nb::class_<Kept> bound(module, "HistoryCampaign", "A campaign that is kept in the history of a machine.");
  bound.def_ro("number", &Kept::number, "In the order in which they were added, from 1.")
      .def_prop_ro("name", [](const Kept& k) { return k.campaign.name; })
      .def_prop_ro(
          "date", [](const Kept& k) { return python_date(k.measured); }, nb::sig("def date(self) -> datetime.date"),
          "Day of the measurement.")
      .def_ro("source", &Kept::source, "Where it came from: the path that was added, or 'memory'.")
      .def_ro("added", &Kept::added, "When it was added, UTC: '2026-03-02T08:15:00Z'.")
      .def_ro("abbe_version", &Kept::abbe_version, "Of the program that added it.")
      .def_prop_ro(
          "machine", [](const Kept& k) { return k.campaign.machine; }, "A copy of the machine as it was then.")
      .def_prop_ro(
          "errors",
          [](const Kept& k) {
            return MachineErrors{k.campaign.machine, k.campaign.errors};
          },
          "A copy of the identified errors, with their covariance.")
      .def_prop_ro(
          "summary", [](const Kept& k) { return k.summary.empty() ? nb::none() : python_of_json(k.summary); },
          nb::sig("def summary(self) -> dict[str, typing.Any] | None"),
          "Headline figures of the study that identified them; None: it was not among the results.");
  add_files(bound, &campaign_files,
            "Writes a results folder that compare(), verify_results() and `abbe compensate` read, whole or not at all: "
            "machine.toml,\nerrors.toml, its covariance and summary.json.");
  bound.def("__repr__", [](const Kept& k) {
    return fmt::format("<abbe.HistoryCampaign {}: {} of {}>", k.number, k.campaign.name, date_text(k.measured));
  });
}

}  // namespace

void bind_histories(nb::module_& module) {
  bind_kept_campaign(module);
  bind_trends(module);
  nb::class_<HistoryFile>(module, "History",
                          "The campaigns of one machine over the years, in one file: `abbe history`.\n\n"
                          "The file is opened by each call and closed again, so that other programs may add campaigns "
                          "meanwhile. Method and\n"
                          "figures: docs/history.md.\n\n"
                          ">>> import abbe\n"
                          ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
                          ">>> history = abbe.History('mill.history')\n"
                          ">>> for date, squareness in [('2024-01-10', 20), ('2025-01-09', 24), ('2026-01-09', 28)]:\n"
                          "...     errors = abbe.Errors(mill)\n"
                          "...     errors.add_location('EC0Y', value_urad=squareness, u_urad=1)\n"
                          "...     number = history.add([errors], [date])\n"
                          ">>> trend = history.trends(limit_um=10).errors['EC0Y']\n"
                          ">>> (1e6 * trend.changes_mm_rad).round(3).tolist(), trend.dates.dtype\n"
                          "([0.0, 4.0, 8.0], dtype('<M8[D]'))\n"
                          ">>> trend.drifts, round(1e6 * trend.drift_mm_rad_per_year, 2), trend.last_is_expected\n"
                          "(True, 4.0, True)\n")
      .def(nb::init<std::filesystem::path>(), nb::arg("path"), "The name of a history; nothing is opened yet.")
      .def_ro("path", &HistoryFile::path)
      .def("add", &add_campaigns, nb::arg("campaigns"), nb::arg("dates"), nb::kw_only(),
           nb::arg("machine") = nb::none(), nb::arg("names") = nb::none(),
           "Adds campaigns, all or none, and returns their numbers. A history that does not exist is made.\n\n"
           "campaigns: each a results folder, an errors file, Errors or a StudyResult. dates: of the measurements, one "
           "for\n"
           "each, as datetime.date, datetime64[D] or '2026-03-02'; the date of a file is not the day of the "
           "measurement.\n"
           "machine: a Machine or its file, for campaigns that are files; default: machine.toml of each results "
           "folder.\n"
           "names: of the campaigns; default: of files, folders and studies, of Errors the day. Waits up to 30 s while "
           "other\n"
           "programs write. Raises InputError for another machine, for errors that are in the history already and for "
           "a\n"
           "file that is no history, and warns of errors that are marked as not to be trusted.")
      .def("campaigns", &campaigns_in,
           "All campaigns in the order in which they were measured, each a HistoryCampaign. Raises InputError for a "
           "file\n"
           "that does not exist or is no history.")
      .def("trends", &trends_of, nb::kw_only(), nb::arg("limit_um") = nb::none(), nb::arg("last") = 26,
           nb::arg("states") = nb::none(), nb::arg("page") = true, nb::arg("progress") = nb::none(),
           "Follows every error over the campaigns: drift, unexpected values, when to measure again.\n\n"
           "limit_um: tolerated change at the tool by one error since the last campaign, um; None: nothing is "
           "predicted.\n"
           "last: only the newest campaigns, 2 to 26. states: where errors with states are followed, {'ambient_degC': "
           "26.5};\n"
           "else at the references of the newest campaign. page: whether there is a plot of each error. progress: a "
           "function "
           "of\n"
           "the step, the pairs of campaigns compared and their number; Ctrl-C takes effect after a pair. Raises "
           "InputError,\n"
           "also for campaigns of fewer than two days.")
      .def("__repr__", [](const HistoryFile& h) { return fmt::format("<abbe.History '{}'>", h.path.string()); });
}

}  // namespace abbe::python
