#include "abbe/study/report/report_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/identify/covariance.h"
#include "abbe/identify/trust/monte_carlo_comparison.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/machine_json.h"

namespace abbe {
namespace {

std::string basis_words(const Basis& basis) {
  switch (basis.kind) {
    case BasisKind::fourier:
      return fmt::format("Fourier, {} harmonics", basis.order);
    case BasisKind::bspline:
      return fmt::format("cubic B-spline, {} intervals", basis.order);
    case BasisKind::table_linear:
    case BasisKind::table_monotone:
      return fmt::format("{}, {} nodes", basis_kind_name(basis.kind), basis.nodes.size());
    default:
      return fmt::format("{}, order {}", basis_kind_name(basis.kind), basis.order);
  }
}

/// Constraints that name this error, in words.
std::string gauge_note(const Identification& identification, const std::string& name) {
  std::string note;
  for (const GaugeConstraint& constraint : identification.gauge.constraints) {
    if (constraint.words.find(name) == std::string::npos) continue;
    note += (note.empty() ? "" : "; ") + constraint.words;
  }
  return note;
}

/// Columns of the simulation beside those of the covariance, null where the gauge fixes a parameter.
/// @param scales  unit of each parameter's column over mm or rad
void add_monte_carlo(const StudyResult& result, const std::vector<double>& scales, nlohmann::ordered_json& json) {
  const MonteCarloResult& simulated = *result.monte_carlo;
  const nlohmann::ordered_json none(scales.size(), nullptr);
  nlohmann::ordered_json uncertainty = none, ratio = none, low = none, high = none;
  for (const UncertaintyRatio& entry : compare_with_covariance(result.identification, simulated).parameters) {
    const std::size_t p = entry.parameter;
    const Eigen::Index i = static_cast<Eigen::Index>(p);
    uncertainty[p] = scales[p] * std::sqrt(simulated.covariance(i, i));
    ratio[p] = entry.ratio;
    low[p] = scales[p] * simulated.percentiles(i, 0);
    high[p] = scales[p] * simulated.percentiles(i, simulated.percentiles.cols() - 1);
  }
  json["monte_carlo_uncertainty"] = uncertainty;
  json["monte_carlo_ratio"] = ratio;
  json["monte_carlo_low"] = low;
  json["monte_carlo_high"] = high;
}

struct ShownUnit {
  std::string name;
  double scale = 1;  ///< over mm or rad
};

/// Set-up unknowns are large: mm and mrad read better than um and urad.
ShownUnit unit_of(const EstimatedParameter& parameter, ScalesIn scales_in) {
  if (parameter.is_pure_number && scales_in == ScalesIn::um_per_m) return {"um_per_m", kPurePerUnit};
  if (parameter.id.is_machine()) return {micro_unit(parameter.is_angle), micro_per_unit(parameter.is_angle)};
  return parameter.is_angle ? ShownUnit{"mrad", 1e3} : ShownUnit{"mm", 1};
}

}  // namespace

nlohmann::ordered_json report_error_motions(const Machine& machine, const Identification& identification,
                                            const ErrorSet* truth) {
  constexpr std::size_t kPoints = 121;
  const ErrorSet& errors = identification.errors;
  const Eigen::MatrixXd covariance = machine_covariance(identification, errors.parameter_count());
  nlohmann::ordered_json curves = nlohmann::ordered_json::array();
  Eigen::Index first = 0;
  for (std::size_t m = 0; m < errors.motions.size(); ++m) {
    const ErrorMotion& motion = errors.motions[m];
    const Basis& basis = motion.basis;
    const Eigen::Index size = static_cast<Eigen::Index>(basis.size());
    const Axis& axis = machine.axes[motion.axis];
    const bool rotary = axis.kind == AxisKind::rotary;
    const bool angle = is_rotation(motion.component);
    // The functions of an expansion go on beyond the travel.
    const double from = rotary ? basis.from : std::max(basis.from, axis.travel_min);
    const double to = rotary ? basis.to : std::min(basis.to, axis.travel_max);
    std::vector<double> position, value, band, true_value;
    Eigen::VectorXd functions(size);
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double q = from + (to - from) * static_cast<double>(i) / (kPoints - 1);
      basis.values(q, motion.coefficients, {functions.data(), basis.size()});
      const double variance = functions.dot(covariance.block(first, first, size, size) * functions);
      position.push_back(for_drawing(q / position_unit(axis)));
      value.push_back(for_drawing(micro_per_unit(angle) * basis.evaluate(q, motion.coefficients)));
      band.push_back(for_drawing(2 * micro_per_unit(angle) * std::sqrt(std::max(variance, 0.0))));
      if (truth != nullptr) {
        true_value.push_back(for_drawing(micro_per_unit(angle) * basis.evaluate(q, truth->motions[m].coefficients)));
      }
    }
    const std::string name = error_motion_name(machine, motion.axis, motion.component, motion.state);
    const std::string suffix = std::string("_") + micro_unit(angle);
    nlohmann::ordered_json curve;
    curve["name"] = name;
    curve["axis"] = axis.name;
    curve["component"] = std::string(1, component_letter(motion.component));
    curve["basis"] = basis_words(basis);
    if (motion.state != kNoState) curve["state"] = machine.states[motion.state].name;
    curve[rotary ? "position_deg" : "position_mm"] = position;
    curve["value" + suffix] = value;
    curve["expanded_uncertainty" + suffix] = band;
    if (truth != nullptr) curve["truth" + suffix] = true_value;
    const std::string note = gauge_note(identification, name);
    if (!note.empty()) curve["note"] = note;
    curves.push_back(curve);
    first += size;
  }
  return curves;
}

nlohmann::ordered_json report_location_errors(const Machine& machine, const Identification& identification,
                                              const ErrorSet* truth) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const auto add = [&](const std::string& name, std::size_t axis, bool angle, double value, double uncertainty,
                       const double* true_value) {
    const std::string suffix = std::string("_") + micro_unit(angle);
    nlohmann::ordered_json entry;
    entry["name"] = name;
    entry["axis"] = machine.axes[axis].name;
    entry["value" + suffix] = micro_per_unit(angle) * value;
    entry["standard_uncertainty" + suffix] = micro_per_unit(angle) * uncertainty;
    if (true_value != nullptr) entry["truth" + suffix] = micro_per_unit(angle) * *true_value;
    const std::string note = gauge_note(identification, name);
    if (!note.empty()) entry["note"] = note;
    list.push_back(entry);
  };
  for (std::size_t l = 0; l < identification.errors.locations.size(); ++l) {
    const LocationError& location = identification.errors.locations[l];
    add(location_error_name(machine, location.axis, location.component, location.state), location.axis,
        is_rotation(location.component), location.value, location.standard_uncertainty,
        truth != nullptr ? &truth->locations[l].value : nullptr);
    list.back()["component"] = std::string(1, component_letter(location.component));
    if (location.state != kNoState) list.back()["state"] = machine.states[location.state].name;
  }
  for (std::size_t r = 0; r < identification.errors.reversals.size(); ++r) {
    const Reversal& reversal = identification.errors.reversals[r];
    add(reversal_name(machine, reversal.axis), reversal.axis, machine.axes[reversal.axis].kind == AxisKind::rotary,
        reversal.value, reversal.standard_uncertainty, truth != nullptr ? &truth->reversals[r].value : nullptr);
  }
  return list;
}

nlohmann::ordered_json report_parameters(const Machine& machine, const StudyResult& result, const ErrorSet* truth,
                                         ScalesIn scales_in) {
  const Identification& identified = result.identification;
  const std::vector<std::vector<Correlation>> correlations = largest_correlations(identified.covariance, 1);
  const std::vector<double> true_values = truth != nullptr ? truth->parameters() : std::vector<double>();
  std::vector<std::string> names, groups, units, partners, gauge;
  std::vector<double> scales;
  nlohmann::ordered_json values = nlohmann::ordered_json::array(), uncertainties = nlohmann::ordered_json::array(),
                         largest = nlohmann::ordered_json::array(), truths = nlohmann::ordered_json::array();
  // Which axis a machine parameter belongs to: motions first, then locations, reversals, the tool.
  std::vector<std::string> machine_groups;
  for (const ErrorMotion& motion : identified.errors.motions) {
    machine_groups.insert(machine_groups.end(), motion.coefficients.size(), machine.axes[motion.axis].name);
  }
  machine_groups.insert(machine_groups.end(), identified.errors.locations.size(), "location");
  machine_groups.insert(machine_groups.end(), identified.errors.reversals.size(), "reversal");
  machine_groups.insert(machine_groups.end(), 3, "tool");

  for (std::size_t p = 0; p < identified.parameters.size(); ++p) {
    const EstimatedParameter& parameter = identified.parameters[p];
    const Eigen::Index i = static_cast<Eigen::Index>(p);
    const bool is_machine = parameter.id.is_machine();
    const auto [unit_name, unit] = unit_of(parameter, scales_in);
    names.push_back(parameter.name);
    groups.push_back(is_machine ? machine_groups[parameter.id.index]
                                : result.campaign.setups[parameter.id.observations].name);
    scales.push_back(unit);
    units.push_back(unit_name);
    values.push_back(unit * identified.estimates[i]);
    const double u = identified.standard_uncertainties[i];
    if (u > 0) {
      uncertainties.push_back(unit * u);
    } else {
      uncertainties.push_back(nullptr);
    }
    if (correlations[p].empty()) {
      largest.push_back(nullptr);
      partners.emplace_back();
    } else {
      largest.push_back(for_drawing(correlations[p][0].value));
      partners.push_back(identified.parameters[correlations[p][0].other].name);
    }
    std::string note;
    for (const GaugeConstraint& constraint : identified.gauge.constraints) {
      if (std::abs(constraint.functional[i]) > 0 &&
          constraint.functional.cwiseAbs().maxCoeff() == std::abs(constraint.functional[i])) {
        note += (note.empty() ? "" : "; ") + constraint.words;
      }
    }
    gauge.push_back(note);
    if (truth != nullptr && is_machine) {
      truths.push_back(unit * true_values[parameter.id.index]);
    } else {
      truths.push_back(nullptr);
    }
  }
  nlohmann::ordered_json json;
  json["name"] = names;
  json["group"] = groups;
  json["unit"] = units;
  json["value"] = values;
  json["standard_uncertainty"] = uncertainties;
  json["largest_correlation"] = largest;
  json["correlated_with"] = partners;
  json["gauge"] = gauge;
  if (truth != nullptr) json["truth"] = truths;
  if (result.monte_carlo && result.monte_carlo->status == MonteCarloStatus::done) add_monte_carlo(result, scales, json);
  return json;
}

}  // namespace abbe
