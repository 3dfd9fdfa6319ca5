#include "abbe/study/report/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/version.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/advice.h"
#include "abbe/study/report/report_identification.h"
#include "abbe/study/report/report_parameters.h"
#include "abbe/study/report/report_residuals.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/report/truth_in_gauge.h"
#include "abbe/verify/left_out_poses.h"

namespace abbe {
namespace {

/// Columns of axis positions for chosen entries: {"X_mm": [...], "C_deg": [...]}.
nlohmann::ordered_json position_columns(const Machine& machine, const PoseList& poses,
                                        const std::vector<std::size_t>& entries) {
  nlohmann::ordered_json columns;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    std::vector<double> values;
    for (std::size_t k : entries) values.push_back(for_drawing(poses.axis[i][k] / position_unit(axis)));
    columns[axis.name + "_" + position_suffix(axis)] = values;
  }
  return columns;
}

nlohmann::ordered_json columns(const std::array<std::vector<double>, 3>& source,
                               const std::vector<std::size_t>& entries, double unit, const char* names) {
  nlohmann::ordered_json json;
  for (std::size_t d = 0; d < 3; ++d) {
    std::vector<double> values;
    for (std::size_t k : entries) values.push_back(for_drawing(source[d][k] * unit));
    json[std::string(1, names[d])] = values;
  }
  return json;
}

/// Evenly thinned indices of the poses inside the measured range.
std::vector<std::size_t> thinned_poses(const std::vector<std::uint8_t>& covered, std::size_t limit) {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < covered.size(); ++k) {
    if (covered[k] != 0) all.push_back(k);
  }
  if (all.size() <= limit) return all;
  std::vector<std::size_t> part;
  for (std::size_t i = 0; i < limit; ++i) part.push_back(all[i * all.size() / limit]);
  return part;
}

}  // namespace

nlohmann::ordered_json report_map(const Machine& machine, const PoseList& poses, const ErrorMap& before,
                                  const ErrorMap* after, const ErrorMap* uncertainty, const std::string& description,
                                  std::size_t limit) {
  const std::vector<std::size_t> shown = thinned_poses(before.covered, limit);
  nlohmann::ordered_json json;
  json["frame"] = "workpiece";
  json["poses"] = before.statistics.count;
  json["description"] = description;
  json["positions"] = position_columns(machine, poses, shown);
  json["point_mm"] = columns(before.point, shown, 1, "xyz");
  json["before_um"] = columns(before.displacement, shown, 1e3, "xyz");
  if (!before.rotation[0].empty()) json["before_urad"] = columns(before.rotation, shown, 1e6, "abc");
  if (after != nullptr) {
    json["after_um"] = columns(after->displacement, shown, 1e3, "xyz");
    if (!after->rotation[0].empty()) json["after_urad"] = columns(after->rotation, shown, 1e6, "abc");
  }
  if (uncertainty != nullptr && !uncertainty->norm_uncertainty.empty()) {
    std::vector<double> values;
    for (std::size_t k : shown) values.push_back(for_drawing(2e3 * uncertainty->norm_uncertainty[k]));
    json["expanded_uncertainty_um"] = values;
  }
  return json;
}

nlohmann::ordered_json study_report_data(const Study& study, const StudyResult& result,
                                         const nlohmann::ordered_json& summary) {
  nlohmann::ordered_json json;
  json["format"] = "abbe-report/1";
  json["title"] = study.report.title.empty() ? study.name : study.report.title;
  if (!study.description.empty()) json["subtitle"] = study.description;
  json["generator"] = std::string("abbe ") + version_text();
  json["study"] = {{"name", study.name}, {"seed", study.seed}};
  json["simulated"] = result.campaign.truth.has_value();
  json["machine"] = report_machine(study.machine);
  json["summary"] = summary;
  json["warnings"] = nlohmann::ordered_json::array();
  for (const Distrust& reason : result.distrusted)
    json["warnings"].push_back({{"level", "error"}, {"text", "Not to be trusted: " + reason.text + "."}});
  if (study.identification && !result.usable()) {
    json["warnings"].push_back({{"level", "error"}, {"text", study_verdict(study, result)}});
  }
  for (const std::string& warning : study_warnings(study, result))
    json["warnings"].push_back({{"level", "warning"}, {"text", warning}});
  if (result.map && result.map->before.statistics.excluded > 0) {
    json["warnings"].push_back({{"level", "warning"}, {"text", left_out_words(result.map->left_out())}});
  }
  json["assumptions"] = report_assumptions(study, result);
  if (result.map && result.map->before.statistics.count > 0) {
    json["map"] =
        report_map(study.machine, result.map->poses, result.map->before,
                   result.map->after ? &*result.map->after : nullptr, &result.map->predicted, result.map->description);
    if (!result.not_identified.errors.empty()) {
      json["map"]["note"] = fmt::format("Not identified and taken as zero: {}. The uncertainty is that of the {}.",
                                        not_identified_names(study, result.not_identified), kIdentifiedErrorsOnly);
    }
  }
  if (result.unseen && !result.unseen->after.empty()) {
    const UnseenPoses& unseen = *result.unseen;
    std::vector<double> before, after;
    const std::size_t step = std::max<std::size_t>(1, unseen.after.size() / 5000);
    for (std::size_t k = 0; k < unseen.after.size(); k += step) {
      before.push_back(for_drawing(1e3 * unseen.before[k]));
      after.push_back(for_drawing(1e3 * unseen.after[k]));
    }
    const auto percentiles = [](const SampleStatistics& s) {
      return nlohmann::ordered_json{{"median", 1e3 * s.median}, {"p95", 1e3 * s.p95}};
    };
    const std::string quantity = quantity_name(unseen.quantity);
    std::string title = quantity;
    title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
    json["histograms"] = {{{"title", title + ": " + unseen.description},
                           {"quantity", quantity},
                           {"before_um", before},
                           {"after_um", after},
                           {"before_percentiles_um", percentiles(unseen.before_statistics)},
                           {"after_percentiles_um", percentiles(unseen.after_statistics)}}};
  }
  if (result.usable()) {
    const std::optional<ErrorSet> truth = truth_in_gauge(study, result);
    json["error_motions"] = report_error_motions(study.machine, result.identification, truth ? &*truth : nullptr);
    json["location_errors"] = report_location_errors(study.machine, result.identification, truth ? &*truth : nullptr);
    json["parameters"] = report_parameters(study.machine, result, truth ? &*truth : nullptr, ScalesIn::um_per_m);
    json["residuals"] = report_residuals(study.machine, result);
    json["identification"] = report_identification(study, result);
  }
  if (!result.advice.empty()) json["advice"] = advice_json(result);
  if (!result.not_identified.errors.empty()) json["not_identified"] = not_identified_json(study, result);
  json["references"] = {"ISO 230-1:2012 (geometric accuracy)", "ISO 230-7:2015 (axes of rotation)",
                        "JCGM 100:2008 (GUM)",
                        "Aguado et al. (2014), laser tracker verification of multi-axis machines"};
  return json;
}

}  // namespace abbe
