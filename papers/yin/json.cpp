#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/evaluations/positioning_json.h"
#include "yin/results.h"

namespace abbe {
namespace {

using nlohmann::ordered_json;

ordered_json parameters_json(const SwingHeadLinkage& linkage) {
  ordered_json json;
  const auto values = linkage.values();
  for (std::size_t i = 0; i < values.size(); ++i) json[std::string(linkage_name(i)) + "_mm"] = values[i];
  return json;
}

ordered_json figures_json(const YinFigures& f) {
  return {{"mean_um", f.mean}, {"max_um", f.largest}, {"standard_deviation_um", f.deviation}};
}

ordered_json positions_json(const YinPositioning& p) {
  if (!p.failure.empty()) return {{"not_found", p.failure}};
  return {{"table_to_workpiece", position_json(p.table_to_workpiece)},
          {"workpiece_to_table", position_json(p.workpiece_to_table)}};
}

ordered_json linkage_json(const YinResults& r) {
  ordered_json json;
  for (const auto* steps : {&r.table_moves, &r.head_moves}) {
    ordered_json& part = json[steps == &r.table_moves ? "U" : "P"];
    if (steps->found.status != LinkageStatus::ok) {
      part["not_found"] = steps->found.reason;
      continue;
    }
    part["corrected"] = parameters_json(steps->found.linkage);
    part["printed"] = parameters_json(steps->found.printed);
    for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
      part["standard_uncertainty_um"][linkage_name(i)] = 1e3 * steps->found.standard_uncertainty(i);
    }
  }
  ordered_json& joint = json["joint_fit"];
  joint["converged"] = r.joint.converged;
  if (!r.joint.converged) {
    joint["message"] = r.joint.message;
    return json;
  }
  joint["readings"] = r.joint.readings;
  joint["chi_square"] = r.joint.chi_square;
  joint["degrees_of_freedom"] = r.joint.degrees_of_freedom;
  joint["found"] = parameters_json(r.joint.found);
  joint["truth"] = parameters_json(r.joint.truth);
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    joint["standard_uncertainty_um"][linkage_name(i)] = 1e3 * r.joint.standard_uncertainty(i);
  }
  joint["focus_rms_um"] = 1e3 * r.joint.focus;
  joint["focus_rms_by_five_steps_um"] = 1e3 * r.joint.focus_by_steps;
  joint["focus_rms_by_five_steps_without_correlations_um"] = 1e3 * r.joint.focus_without_correlations;
  return json;
}

ordered_json scans_json(const YinResults& r) {
  const YinPositioning& p = r.located.positioning;
  ordered_json json = {{"targets_placed", r.scans.targets_placed},
                       {"targets_seen", r.scans.targets_seen},
                       {"surface_points_placed", r.scans.surface_placed},
                       {"surface_points_seen", r.scans.surface_seen}};
  json.update(positions_json(p));
  if (!p.failure.empty()) return json;
  json["off_the_truth_um"] = 1e3 * p.largest_difference;
  json["chi_square_of_six"] = r.located.chi_square;
  return json;
}

ordered_json budget_figure_json(const BudgetFigure& f) {
  return {{"by_sensitivity_um", 1e3 * f.by_sensitivity},
          {"by_monte_carlo_um", 1e3 * f.by_monte_carlo},
          {"u_monte_carlo_um", 1e3 * f.monte_carlo_uncertainty}};
}

ordered_json contour_json(const YinResults& r) {
  const YinContour& c = r.contour;
  ordered_json json = {{"paper", figures_json(kYinMeasured)},
                       {"across_the_curve", figures_json(c.across)},
                       {"in_the_surface", figures_json(c.in_surface)},
                       {"across_95_percent", figures_json(c.upper)},
                       {"rms_by_sensitivity_um", 1e3 * c.budget.total[0].by_sensitivity},
                       {"rms_by_monte_carlo_um", 1e3 * c.budget.total[0].by_monte_carlo},
                       {"u_rms_by_monte_carlo_um", 1e3 * c.budget.total[0].monte_carlo_uncertainty},
                       {"L_tA_as_printed_um", c.printed_l_ta}};
  json["inputs"] = c.budget.inputs;
  json["runs"] = c.budget.runs;
  json["runs_per_cause"] = c.budget.runs_per_cause;
  json["largest_disagreement_in_standard_uncertainties"] = c.budget.largest_disagreement();
  json["total"] = {{"across", budget_figure_json(c.budget.total[0])}, {"along", budget_figure_json(c.budget.total[1])}};
  for (const BudgetLine& line : c.budget.lines) {
    json["budget"].push_back({{"cause", line.cause},
                              {"inputs", line.inputs},
                              {"share", line.share},
                              {"across", budget_figure_json(line.kinds[0])},
                              {"along", budget_figure_json(line.kinds[1])}});
  }
  return json;
}

ordered_json sections_json(const YinSections& s) {
  return {{"edge_radius_um", 1e3 * s.radius},
          {"contour_error", figures_json(s.found)},
          {"contour_error_true", figures_json(s.truth)},
          {"P1_P2", figures_json(s.rounding)},
          {"largest_miss_um", 1e3 * s.largest_miss},
          {"without_an_edge", s.refused}};
}

}  // namespace

ordered_json yin_details(const YinResults& r) {
  ordered_json json;
  json["linkage"] = linkage_json(r);
  json["positioning"] = positions_json(r.positioning);
  json["positioning"]["simulated_scans"] = scans_json(r);
  if (r.positioning.failure.empty()) {
    json["contour"] = contour_json(r);
    json["sections"] = sections_json(r.sections);
  }
  return json;
}

}  // namespace abbe
