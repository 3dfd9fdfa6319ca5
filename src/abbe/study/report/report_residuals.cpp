#include "abbe/study/report/report_residuals.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "abbe/identify/distributions.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/machine_json.h"

namespace abbe {
namespace {

/// More readings than this are thinned out evenly: the drawing is not finer.
constexpr std::size_t kLimit = 5000;

/// Length of the whitened residuals of one reading, standard uncertainties.
double norm_of(const std::vector<ResidualComponent>& components, std::size_t reading) {
  double sum = 0;
  for (const ResidualComponent& component : components) {
    sum += component.normalised[reading] * component.normalised[reading];
  }
  return std::sqrt(sum);
}

std::vector<double> drawn(const std::vector<double>& values, const std::vector<std::size_t>& entries) {
  std::vector<double> chosen;
  chosen.reserve(entries.size());
  for (std::size_t k : entries) chosen.push_back(for_drawing(values[k]));
  return chosen;
}

nlohmann::ordered_json position_columns(const Machine& machine, const Observations& observations,
                                        const std::vector<std::size_t>& entries) {
  std::vector<std::vector<double>> values(machine.axes.size());
  for (std::size_t k : entries) {
    const std::vector<double> positions = observations.positions(k);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      values[i].push_back(for_drawing(positions[i] / position_unit(machine.axes[i])));
    }
  }
  nlohmann::ordered_json columns;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    columns[machine.axes[i].name + "_" + position_suffix(machine.axes[i])] = values[i];
  }
  return columns;
}

/// One set-up of any instrument. @param time_s  [readings] or empty
nlohmann::ordered_json setup_json(const Machine& machine, const StudyResult& result, std::size_t s,
                                  const Observations& observations, const std::vector<ResidualComponent>& components,
                                  const std::vector<double>& time_s) {
  const std::size_t count = observations.reading_count();
  const double norm_limit =
      std::sqrt(chi_square_quantile(IdentifyOptions{}.outlier_norm_quantile, observations.rows())) *
      result.identification.robust_scale;
  std::set<std::size_t> outliers;
  for (const Outlier& outlier : result.identification.outliers) {
    if (outlier.observations == s) outliers.insert(outlier.reading);
  }
  // Held-out readings take no part in the fit, but a gross error among them is marked like the others.
  const std::vector<std::uint8_t>& use = result.model.problem.observations[s].use;
  for (std::size_t k = 0; k < count && !use.empty(); ++k) {
    if (use[k] == 0 && norm_of(components, k) > norm_limit) outliers.insert(k);
  }
  std::vector<std::size_t> shown;
  const std::size_t step = std::max<std::size_t>(1, (count + kLimit - 1) / kLimit);
  for (std::size_t k = 0; k < count; ++k) {
    if (k % step == 0 || outliers.count(k) != 0) shown.push_back(k);
  }
  nlohmann::ordered_json setup;
  setup["name"] = result.campaign.setups[s].name;
  setup["readings"] = count;
  setup["outlier_limit"] = for_drawing(norm_limit);
  setup["reading"] = shown;
  if (!time_s.empty()) {
    std::vector<double> times;
    for (std::size_t k : shown) times.push_back(time_s[k]);
    setup["time_s"] = times;
  }
  if (const std::vector<std::string>& points = result.campaign.setups[s].readings.point_name; !points.empty()) {
    std::vector<std::string> names;
    for (std::size_t k : shown) names.push_back(points[k]);
    setup["point"] = names;
  }
  setup["positions"] = position_columns(machine, observations, shown);
  setup["components"] = nlohmann::ordered_json::array();
  for (const ResidualComponent& component : components) {
    nlohmann::ordered_json entry;
    entry["name"] = component.name;
    if (!component.unit.empty()) entry["unit"] = component.unit;
    entry["normalised"] = drawn(component.normalised, shown);
    if (!component.residual.empty()) entry["residual"] = drawn(component.residual, shown);
    setup["components"].push_back(entry);
  }
  std::vector<int> marked, held_out;
  for (std::size_t k : shown) {
    marked.push_back(outliers.count(k) != 0 ? 1 : 0);
    held_out.push_back(!use.empty() && use[k] == 0 ? 1 : 0);
  }
  setup["outlier"] = marked;
  if (std::find(held_out.begin(), held_out.end(), 1) != held_out.end()) setup["held_out"] = held_out;
  return setup;
}

}  // namespace

std::vector<ResidualComponent> residual_components(const Observations& observations) {
  const std::vector<ReadingComponent>& of_reading = observations.components();
  const std::size_t rows = of_reading.size();
  const std::vector<double> residuals = residuals_by_reading(observations);
  std::vector<ResidualComponent> components(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    components[row].name = of_reading[row].name;
    components[row].unit = micro_unit(of_reading[row].is_angle);
  }
  const std::vector<double> deviations = deviations_by_reading(observations);
  for (std::size_t row = 0; row < rows; ++row) {
    const double micro = micro_per_unit(of_reading[row].is_angle);
    for (std::size_t k = 0; k < observations.reading_count(); ++k) {
      components[row].normalised.push_back(residuals[rows * k + row]);
      components[row].residual.push_back(deviations[rows * k + row] * micro);
    }
  }
  return components;
}

nlohmann::ordered_json report_residuals(const Machine& machine, const StudyResult& result) {
  nlohmann::ordered_json setups = nlohmann::ordered_json::array();
  for (std::size_t s = 0; s < result.model.problem.observations.size(); ++s) {
    const Observations& observations = *result.model.problem.observations[s].observations;
    const CampaignSetup& setup = result.campaign.setups[s];
    setups.push_back(
        setup_json(machine, result, s, observations, residual_components(observations), setup.readings.time_s));
  }
  return {{"setups", setups}};
}

}  // namespace abbe
