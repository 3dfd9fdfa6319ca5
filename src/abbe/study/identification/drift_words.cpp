#include "abbe/study/identification/drift_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

constexpr double kDriftHour_s = 3600;
constexpr int kTimesShown = 7;

std::vector<double> times_of(const DriftingPlace& place) {
  if (!place.knots_s.empty()) return place.knots_s;
  std::vector<double> times;
  for (int i = 0; i < kTimesShown; ++i) {
    times.push_back(place.start_s + (place.end_s - place.start_s) * i / (kTimesShown - 1));
  }
  return times;
}

/// Estimates of the drift's unknowns and their covariance; what is not estimated is zero.
struct DriftEstimates {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

DriftEstimates estimates_of(const Identification& identified, std::size_t setup, std::size_t first, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  DriftEstimates result{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  std::vector<Eigen::Index> at(count, -1);
  for (std::size_t p = 0; p < identified.parameters.size(); ++p) {
    const ParameterId& id = identified.parameters[p].id;
    if (id.is_machine() || id.observations != setup || id.index < first || id.index >= first + count) continue;
    at[id.index - first] = static_cast<Eigen::Index>(p);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index p = at[static_cast<std::size_t>(i)];
    if (p < 0) continue;
    result.values[i] = identified.estimates[p];
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::Index q = at[static_cast<std::size_t>(j)];
      if (q >= 0) result.covariance(i, j) = identified.covariance(p, q);
    }
  }
  return result;
}

double intensity_of(const StudyResult& result, std::size_t s, const DriftingPlace& place, bool is_angle) {
  const std::string name = place.name + (is_angle ? " turns" : " shifts");
  for (const EstimatedWalk& walk : result.walks) {
    if (walk.setup == s && walk.name == name) return std::sqrt(walk.variance);
  }
  const DriftPlan& plan = *result.campaign.setups[s].drift;
  return is_angle ? plan.walk_angle : plan.walk_length;
}

std::string walk_text(const EstimatedWalk& walk) {
  const double per_hour = micro_per_unit(walk.is_angle) * std::sqrt(kDriftHour_s), sigma = std::sqrt(walk.variance);
  const char* const unit = micro_unit(walk.is_angle);
  if (walk.at_zero) {
    return fmt::format("  {}: no random walk found; not above {:.3g} {}/sqrt(h) (k = 2)\n", walk.name,
                       per_hour * std::sqrt(2 * walk.variance_uncertainty), unit);
  }
  return fmt::format("  {}: random walk of {:.4g} {}/sqrt(h), standard uncertainty {:.2g} (estimated)\n", walk.name,
                     per_hour * sigma, unit, per_hour * walk.variance_uncertainty / (2 * sigma));
}

/// Walks of which straight lines between the knots leave out something, a line each.
std::string knots_text(const StudyResult& result) {
  std::string text;
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    if (setup.readings.drift == nullptr) continue;
    for (const DriftingPlace& place : setup.readings.drift->places) {
      for (const bool is_angle : {false, true}) {
        const bool has = std::any_of(place.components.begin(), place.components.end(),
                                     [&](int component) { return (component >= 3) == is_angle; });
        const double left = has ? walk_between_knots(setup, place, intensity_of(result, s, place, is_angle)) : 0;
        if (!(left > 0)) continue;
        text += fmt::format(
            "  {}: between its knots the walk may differ by {:.2g} {} (standard deviation) from "
            "straight lines; more `knots` make it less\n",
            place.name, micro_per_unit(is_angle) * left, micro_unit(is_angle));
      }
    }
  }
  return text;
}

}  // namespace

double walk_between_knots(const CampaignSetup& setup, const DriftingPlace& place, double intensity) {
  if (place.knots_s.empty()) return 0;
  const bool every = std::all_of(setup.readings.time_s.begin(), setup.readings.time_s.end(), [&](double time) {
    return time < place.start_s || time > place.end_s ||
           std::binary_search(place.knots_s.begin(), place.knots_s.end(), time);
  });
  if (every) return 0;
  double longest = 0;
  for (std::size_t i = 1; i < place.knots_s.size(); ++i) {
    longest = std::max(longest, place.knots_s[i] - place.knots_s[i - 1]);
  }
  return intensity * std::sqrt(longest) / 2;
}

std::vector<FoundDrift> found_drifts(const StudyResult& result) {
  std::vector<FoundDrift> found;
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    const SetupDrift* drift = setup.readings.drift.get();
    if (drift == nullptr || !result.usable()) continue;
    const std::size_t before =
        result.model.problem.observations[s].observations->unknowns().size() - drift->unknown_count();
    for (std::size_t p = 0; p < drift->places.size(); ++p) {
      const DriftingPlace& place = drift->places[p];
      for (std::size_t c = 0; c < place.components.size(); ++c) {
        const DriftEstimates of =
            estimates_of(result.identification, s, before + drift->first_unknown(p, c), place.functions());
        FoundDrift one{.place = place.name,
                       .setup = setup.name,
                       .component = place.components[c],
                       .time_s = {},
                       .value = {},
                       .expanded = {}};
        Eigen::VectorXd weights(static_cast<Eigen::Index>(place.functions()));
        for (const double time : times_of(place)) {
          drift_functions(place, time, weights.data());
          one.time_s.push_back(time - place.start_s);
          one.value.push_back(weights.dot(of.values));
          one.expanded.push_back(2 * std::sqrt(std::max(0.0, weights.dot(of.covariance * weights))));
        }
        found.push_back(std::move(one));
      }
    }
  }
  return found;
}

std::string drift_text(const StudyResult& result) {
  const std::vector<FoundDrift> drifts = found_drifts(result);
  if (drifts.empty()) return {};
  std::string text = "\ndrift of the set-ups since their first reading, in the frame of the body on which they stand\n";
  for (const FoundDrift& one : drifts) {
    const double unit = micro_per_unit(one.is_angle());
    std::size_t largest = 0;
    for (std::size_t i = 0; i < one.value.size(); ++i) {
      if (std::abs(one.value[i]) > std::abs(one.value[largest])) largest = i;
    }
    text += fmt::format("  {:<24} {:>9.2f} {} after {:.3g} h, expanded uncertainty {:.2g} (k = 2)",
                        one.place + " " + drift_component_name(one.component), unit * one.value.back(),
                        micro_unit(one.is_angle()), one.time_s.back() / kDriftHour_s, unit * one.expanded.back());
    if (largest + 1 < one.value.size()) {
      text +=
          fmt::format("; most {:.2f} after {:.3g} h", unit * one.value[largest], one.time_s[largest] / kDriftHour_s);
    }
    text += "\n";
  }
  for (const EstimatedWalk& walk : result.walks) text += walk_text(walk);
  return text + knots_text(result);
}

nlohmann::ordered_json drift_json(const StudyResult& result) {
  nlohmann::ordered_json json;
  json["places"] = nlohmann::ordered_json::array();
  for (const FoundDrift& one : found_drifts(result)) {
    const std::string unit = micro_unit(one.is_angle());
    nlohmann::ordered_json entry = {
        {"setup", one.setup}, {"place", one.place}, {"motion", drift_component_name(one.component)}};
    for (std::size_t i = 0; i < one.time_s.size(); ++i) {
      entry["time_h"].push_back(one.time_s[i] / kDriftHour_s);
      entry["value_" + unit].push_back(micro_per_unit(one.is_angle()) * one.value[i]);
      entry["expanded_uncertainty_" + unit].push_back(micro_per_unit(one.is_angle()) * one.expanded[i]);
    }
    json["places"].push_back(entry);
  }
  for (const EstimatedWalk& walk : result.walks) {
    const double per_hour = micro_per_unit(walk.is_angle) * std::sqrt(kDriftHour_s), sigma = std::sqrt(walk.variance);
    const std::string name = std::string(micro_unit(walk.is_angle)) + "_per_sqrt_h";
    nlohmann::ordered_json entry = {{"name", walk.name}, {"none_found", walk.at_zero}};
    entry[name] = walk.at_zero ? 0.0 : per_hour * sigma;
    entry["standard_uncertainty_" + name] = per_hour * (walk.at_zero ? std::sqrt(2 * walk.variance_uncertainty) / 2
                                                                     : walk.variance_uncertainty / (2 * sigma));
    json["random_walks"].push_back(entry);
  }
  return json;
}

}  // namespace abbe
