#include "abbe/study/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/geometry/rotation.h"
#include "abbe/identify/trust/monte_carlo_comparison.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/partial_errors.h"
#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/study/identification/drift_words.h"
#include "abbe/study/identification/state_ranges.h"
#include "abbe/study/identification/streamed_identification.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/advice.h"
#include "abbe/study/report/coverage.h"
#include "abbe/study/report/found_values_words.h"
#include "abbe/study/report/outlier_list.h"
#include "abbe/study/report/residual_figures.h"

namespace abbe {
namespace {

/// Statistics over the poses of a map that have a result.
void add_map_statistics(const StudyMap& map, nlohmann::ordered_json& entry) {
  entry["position_before_um"] = statistics_um(map.before.statistics);
  entry["orientation_before_urad"] = orientation_urad(map.before);
  if (map.after) {
    entry["position_after_um"] = statistics_um(map.after->statistics);
    entry["orientation_after_urad"] = orientation_urad(*map.after);
  }
  if (!map.predicted.norm_uncertainty.empty()) {
    std::vector<double> expanded = map.predicted.norm_uncertainty;
    for (double& value : expanded) value *= 2;
    entry["predicted_expanded_uncertainty_um"] = statistics_um(sample_statistics(expanded, map.predicted.covered));
  }
}

/// Over which positions of each axis the map is made, in chain order.
nlohmann::ordered_json map_ranges_json(const Machine& machine, const StudyMap& map) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::vector<double>& positions = map.poses.axis[i];
    if (positions.empty()) continue;
    const auto [first, last] = std::minmax_element(positions.begin(), positions.end());
    const Axis& axis = machine.axes[i];
    const double unit = position_unit(axis);
    nlohmann::ordered_json entry = {{"axis", axis.name}};
    entry[std::string("range_") + position_suffix(axis)] = {*first / unit, *last / unit};
    if (!map.grid.empty()) entry["positions"] = map.grid[i];
    list.push_back(entry);
  }
  return list;
}

/// That only a part of the machine's errors is identified, in front of figures that could be taken for all of them.
std::string known_words(const Study& study, const StudyResult& result) {
  const std::size_t missing = result.not_identified.errors.size();
  if (missing == 0) return {};
  const std::size_t known = known_error_count(study.machine, result.identification.errors);
  return fmt::format("{} of the {} errors that move the tool are identified. ", known, known + missing);
}

}  // namespace

std::string prediction_covers(const StudyResult& result) {
  std::string text = result.not_identified.errors.empty() ? "" : kIdentifiedErrorsOnly;
  if (result.unseen && !result.unseen->open.empty()) {
    text += std::string(text.empty() ? "" : ", ") + "directions that the readings determine only";
  }
  return text;
}

std::string study_verdict(const Study& study, const StudyResult& result) {
  if (!study.identification) {
    return result.campaign.is_explained() ? "" : "No use: the nominal machine does not explain the readings.";
  }
  if (!result.usable()) {
    return fmt::format("No result: {}.", result.identification.message.empty()
                                             ? status_text(result.identification.status)
                                             : result.identification.message);
  }
  std::string text;
  if (!result.distrusted.empty()) {
    text = fmt::format("{} ({}). ", result.misfit_accepted ? "Accepted despite doubts" : "Not to be trusted",
                       distrust_kinds(result));
  }
  text += known_words(study, result);
  if (result.volumetric && result.volumetric->poses > 0) {
    text += volumetric_sentence(*result.volumetric, prediction_covers(result));
  } else {
    text += "Identified; no pose has a volumetric error.";
  }
  if (!result.campaign.truth) {
    const NoiseFigures residual = noise_figures(study, result);
    text += fmt::format(" Residual of the readings: {:.3g} times their stated uncertainties",
                        residual.times_noise_without_outliers);
    if (residual.outliers > 0) {
      text +=
          fmt::format(" without the {} outlier{}, {:.3g} times with {}", residual.outliers,
                      residual.outliers == 1 ? "" : "s", residual.times_noise, residual.outliers == 1 ? "it" : "them");
    }
    text += ".";
  }
  return text;
}

/// Estimated variances of the readings. Chi-square is that of the uncertainties as stated: with estimated ones it is
/// what the estimate makes it.
nlohmann::ordered_json variances_json(const VarianceComponents& components) {
  nlohmann::ordered_json json;
  if (components.estimated.variance_factor) {
    json["variance_factor"] = components.variance.factor;
    json["variance_factor_standard_uncertainty"] = components.variance_factor_uncertainty();
  }
  if (components.estimated.pose_noise) {
    const std::string name = components.estimated.by_block ? "block_noise" : "pose_noise";
    json[name + "_um"] = 1e3 * components.pose_noise();
    json[name + "_standard_uncertainty_um"] = 1e3 * components.pose_noise_uncertainty();
    json[name + "_at_zero"] = components.pose_noise_at_zero;
  }
  json["method"] = "restricted maximum likelihood";
  json["identifications"] = components.iterations;
  json["stated_chi_square"] = components.stated_chi_square;
  json["stated_degrees_of_freedom"] = components.stated_degrees_of_freedom;
  json["stated_chi_square_probability"] = components.stated_p_value;
  json["chi_square_is_a_test"] = !components.estimated.variance_factor;
  return json;
}

nlohmann::ordered_json study_summary(const Study& study, const StudyResult& result) {
  nlohmann::ordered_json json;
  json["format"] = "abbe-summary/1";
  json["study"] = study.name;
  json["machine"] = study.machine.name;
  json["chain"] = study.machine.chain();
  json["seed"] = study.seed;
  for (std::size_t s = 0; s < study.setups.size() && s < result.campaign.setups.size(); ++s) {
    json["setups"].push_back({{"name", study.setups[s].name},
                              {"instrument", study.setups[s].instrument},
                              {"readings", all_reading_count(result.campaign.setups[s])}});
  }
  if (study.identification) {
    const Identification& identified = result.identification;
    json["verdict"] = study_verdict(study, result);
    json["status"] = status_text(identified.status);
    json["converged"] = result.usable();
    json["readings"] = all_reading_count(result.campaign);
    if (result.usable()) {
      json["trusted"] = result.distrusted.empty();
      if (!result.distrusted.empty()) {
        json["distrusted"] = distrust_json(result);
        json["misfit_accepted"] = result.misfit_accepted;
      }
      std::size_t machine_parameters = 0;
      for (const EstimatedParameter& parameter : identified.parameters)
        machine_parameters += parameter.id.is_machine() ? 1U : 0U;
      json["iterations"] = identified.history.size();
      json["outliers"] = identified.outliers.size();
      json["residuals"] = used_residual_count(result.model.problem);
      json["parameters"] = identified.parameters.size();
      json["machine_parameters"] = machine_parameters;
      json["setup_parameters"] = identified.parameters.size() - machine_parameters;
      json["rank"] = identified.parameters.size() - identified.gauge.constraints.size();
      json["null_space"] = identified.gauge.constraints.size();
      json["degrees_of_freedom"] = identified.statistics.degrees_of_freedom;
      json["chi_square"] = identified.statistics.chi_square;
      json["chi_square_probability"] = identified.statistics.p_value;
      json["observability_index"] = identified.statistics.observability.o1;
      json["observability_index_kind"] = "O1";
      json["condition_number"] = identified.statistics.observability.condition;
      json["normalised_residual_rms"] = std::sqrt(identified.statistics.variance_factor);
      if (result.weighed) json["reading_variances"] = variances_json(result.weighed->components);
      const ResidualFigures residual = residual_figures(study, result);
      json["fit_residual_um"] = statistics_um(residual.length);
      json["residual"] = residual_json(residual);
      if (!identified.outliers.empty()) json["outlier_list"] = outliers_json(study, result);
      json["identified"] = found_values_json(found_values(study, result));
      if (const nlohmann::ordered_json drift = drift_json(result); !drift["places"].empty()) json["drift"] = drift;
      if (result.terms) json["terms_with_states"] = chosen_terms_json(*result.terms);
      if (result.sensors) json["sensors"] = ranked_sensors_json(*result.sensors);
      const std::vector<CoveredState> covered = covered_states(study, result);
      for (const CoveredState& state : covered) json["covered_states"][state.column] = {state.from, state.to};
      if (!covered.empty()) json["covered_time_h"] = covered_time_s(result) / 3600;
      json["gauge"] = gauge_table_json(identified);
      if (result.monte_carlo && result.monte_carlo->status == MonteCarloStatus::done) {
        const MonteCarloComparison comparison = compare_with_covariance(identified, *result.monte_carlo);
        json["monte_carlo"] = {{"samples", comparison.samples},
                               {"compared", comparison.parameters.size()},
                               {"smallest_uncertainty_ratio", comparison.smallest_ratio},
                               {"largest_uncertainty_ratio", comparison.largest_ratio},
                               {"chance_ratio_low", comparison.ratio_low},
                               {"chance_ratio_high", comparison.ratio_high},
                               {"largest_shift", comparison.largest_shift},
                               {"chance_shift", comparison.shift_limit},
                               {"beyond_chance", comparison.beyond},
                               {"agrees", comparison.agrees()}};
      }
    }
  }
  if (!result.model.coverage.empty()) json["ranges"] = coverage_json(study, result);
  json["warnings"] = study_warnings(study, result);
  if (!result.advice.empty()) json["not_seen"] = advice_json(result);
  const bool conditional = !result.not_identified.errors.empty();
  if (conditional) {
    json["errors_known"] = known_error_count(study.machine, result.identification.errors);
    json["errors_of_machine"] = json["errors_known"].get<std::size_t>() + result.not_identified.errors.size();
  }
  if (conditional) json["not_identified"] = not_identified_json(study, result);
  if (result.volumetric) {
    add_volumetric_figures(*result.volumetric, json, prediction_covers(result));
  }
  if (result.unseen && !result.unseen->after.empty()) {
    const UnseenPoses& unseen = *result.unseen;
    nlohmann::ordered_json held_out;
    held_out["poses"] = unseen.after.size();
    held_out["description"] = unseen.description;
    held_out["reference"] = unseen.against_truth ? "truth" : "readings";
    held_out["quantity"] = quantity_name(unseen.quantity);
    if (unseen.times_noise > 0) held_out["times_stated_uncertainty"] = unseen.times_noise;
    held_out["position_before_um"] = statistics_um(unseen.before_statistics);
    held_out["position_after_um"] = statistics_um(unseen.after_statistics);
    held_out["predicted_expanded_uncertainty_um"] = statistics_um(unseen.uncertainty_statistics);
    if (conditional) held_out["uncertainty_covers"] = kIdentifiedErrorsOnly;
    if (unseen.against_truth) held_out["coverage_percent"] = 100 * unseen.coverage;
    if (unseen.readings && unseen.readings->readings > 0) {
      const ReadingCoverage& found = *unseen.readings;
      held_out["reading_coverage"] = {{"coverage_factor", 2},
                                      {"readings", found.readings},
                                      {"components", found.components},
                                      {"components_within_percent", 100 * static_cast<double>(found.components_within) /
                                                                        static_cast<double>(found.components)},
                                      {"readings_within_percent", 100 * static_cast<double>(found.readings_within) /
                                                                      static_cast<double>(found.readings)}};
    }
    if (unseen.before_statistics.mean > 0) {
      held_out["remaining_percent"] = 100 * unseen.after_statistics.mean / unseen.before_statistics.mean;
    }
    if (!unseen.open.empty()) {
      held_out["not_determined"] = unseen.open;
      if (unseen.against_truth) held_out["not_determined_rms_um"] = 1e3 * unseen.open_rms;
    }
    json["held_out"] = held_out;
  }
  if (result.map) {
    const StudyMap& map = *result.map;
    nlohmann::ordered_json entry;
    entry["poses"] = map.before.statistics.count;
    entry["description"] = map.description + ", after the best fit of the workpiece datum";
    entry["reference"] = map.against_truth ? "truth" : "model";
    if (map.before.statistics.count > 0) add_map_statistics(map, entry);
    if (conditional) entry["uncertainty_covers"] = kIdentifiedErrorsOnly;
    entry["ranges"] = map_ranges_json(study.machine, map);
    if (!map.moved.empty()) entry["moved"] = map.moved;
    if (map.before.statistics.excluded > 0) entry["outside_range"] = map.before.statistics.excluded;
    json["map"] = entry;
  }
  return json;
}

}  // namespace abbe
