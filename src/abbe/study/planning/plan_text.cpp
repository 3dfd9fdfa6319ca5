#include "abbe/study/planning/plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/drawings/svg_plot.h"
#include "abbe/study/planning/plan_states_text.h"
#include "abbe/study/planning/planning_drift.h"

namespace abbe {
namespace {

bool has_other_instruments(const Study& study) {
  return std::any_of(study.setups.begin(), study.setups.end(),
                     [](const Setup& setup) { return !setup.device->measures_points(); });
}

nlohmann::ordered_json grid_json(const GridPoint& grid) {
  nlohmann::ordered_json json = {{"made", grid.words},
                                 {"readings", grid.value.readings},
                                 {"determined", grid.value.determined},
                                 {"uncertainty_with_prior_um", 1e3 * grid.value.with_prior}};
  if (grid.value.determined) json["uncertainty_um"] = 1e3 * grid.value.uncertainty;
  if (grid.open > 0) {
    json["open_directions"] = grid.open;
    json["open_errors"] = grid.open_words;
  }
  return json;
}

std::string grid_text(const char* title, const GridPoint& grid) {
  std::string text;
  text += fmt::format("  {}: {} readings ({})\n", title, grid.value.readings, grid.words);
  return text;
}

std::string grids_text(const StudyPlan& result) {
  std::string text;
  text += fmt::format("\nagainst grids ({} tried, in the same limits and lines of sight, never with fewer readings)\n",
                      result.grids_tried);
  const GridsOfANumber& same = result.same_number;
  if (same.determined) {
    text += grid_text("as many readings, everything determined", *same.determined);
    text += fmt::format("    {:.3f} um: the plan's is {:.2f} times smaller\n", 1e3 * same.determined->value.uncertainty,
                        same.determined->value.uncertainty / result.uncertainty);
  } else {
    text += fmt::format("  as many readings: none of {} grids determines everything that the plan does\n", same.tried);
  }
  if (same.any) {
    text += grid_text("as many readings, with prior knowledge in both (20 um, 60 urad for every error)", *same.any);
    text +=
        fmt::format("    {:.3f} um: the plan's {:.3f} um is {:.2f} times smaller\n", 1e3 * same.any->value.with_prior,
                    1e3 * result.with_prior, same.any->value.with_prior / result.with_prior);
    if (same.any->open > 0)
      text += fmt::format("    by itself it leaves {} directions open, most of all in {}\n", same.any->open,
                          same.any->open_words);
  }
  if (result.random_poses)
    text += fmt::format("  as many of the candidates at random (median of {}): {:.3f} um, {:.2f} times the plan's\n",
                        result.random_tried, 1e3 * result.random_poses->uncertainty,
                        result.random_poses->uncertainty / result.uncertainty);
  if (result.equal_grid) {
    text += grid_text("the same uncertainty", *result.equal_grid);
    text += fmt::format(
        "    {:.3f} um: {:.2f} times the plan's number\n", 1e3 * result.equal_grid->value.uncertainty,
        static_cast<double>(result.equal_grid->value.readings) / static_cast<double>(result.readings.size()));
  } else {
    text += "  the same uncertainty: no grid tried reaches it\n";
  }
  return text;
}

std::string combinations_text(const StudyPlan& result) {
  std::string text;
  if (result.combinations.empty()) return text;
  text += "\nwhich instruments are worth setting up (uncertainty with prior knowledge of 20 um and 60 urad)\n";
  for (const SetupChoice& choice : result.combinations) {
    const std::string names = fmt::format("{}", fmt::join(choice.setups, ", "));
    if (choice.possible) {
      text += fmt::format("  {:>8.3f} um  {:>5} readings in {:>4.0f} min  {}\n", 1e3 * choice.with_prior,
                          choice.readings, choice.time / 60, names);
    } else {
      text += fmt::format("      open     in the time allowed                {}\n", names);
    }
  }
  return text;
}

/// How many readings every set-up takes, where there are several.
std::string setups_text(const Study& study, const StudyPlan& result) {
  std::string text;
  if (study.setups.size() < 2) return text;
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const auto count = std::count_if(result.readings.begin(), result.readings.end(),
                                     [s](const CandidateReading& reading) { return reading.setup == s; });
    text += fmt::format("  {:>6} with {} ({})\n", count, study.setups[s].name, study.setups[s].instrument);
  }
  return text;
}

}  // namespace

PlanColumns plan_columns(const Study& study) {
  PlanColumns columns{study.setups.size() > 1, false, {}};
  for (const Setup& setup : study.setups) {
    columns.station = columns.station || !setup.device->station_names().empty();
    const std::string word = setup.device->target_word();
    columns.target = columns.target.empty() || columns.target == word ? word : "target";
  }
  return columns;
}

std::string plan_csv(const Study& study, const StudyPlan& result) {
  const PlanColumns columns = plan_columns(study);
  std::string text = "# " + study.name + ": readings in the order in which they are to be taken\n";
  for (const Axis& axis : study.machine.axes) text += fmt::format("{}_{},", axis.name, position_suffix(axis));
  if (columns.setup) text += "setup,";
  if (columns.station) text += "station,";
  const bool timed = result.states.has_course() || !result.drift.setups.empty();
  const std::vector<double> times =
      timed ? reading_times(study, result.readings, result.states) : std::vector<double>();
  text += columns.target + (timed ? ",time_s" : "") + state_heads_of_plan(study, result) + "\n";
  for (std::size_t k = 0; k < result.readings.size(); ++k) {
    const CandidateReading& reading = result.readings[k];
    for (std::size_t i = 0; i < reading.pose.size(); ++i)
      text += fmt::format("{:.6f},", reading.pose[i] / position_unit(study.machine.axes[i]));
    const Setup& setup = study.setups[reading.setup];
    const Instrument& device = *setup.device;
    const std::vector<std::string> stations = device.station_names();
    if (columns.setup) text += csv_field(setup.name) + ",";
    if (columns.station) text += (stations.empty() ? "-" : csv_field(stations[device.station_of(reading.item)])) + ",";
    text += csv_field(device.target_names()[device.target_of(reading.item)]);
    text += (timed ? fmt::format(",{:.3f}", times[k]) : "") + states_of_planned_reading(result, k) + "\n";
  }
  return text;
}

std::string plan_svg(const Study& study, const StudyPlan& result) {
  XyPlot plot(study.name + ": how many readings are enough", "readings",
              "predicted volumetric standard uncertainty in um");
  std::vector<PlotPoint> curve;
  for (const PlanPoint& point : result.curve)
    if (point.determined) curve.push_back({static_cast<double>(point.readings), 1e3 * point.uncertainty});
  plot.include_y(0);
  plot.line(curve, {PlotColour::first, 1.6, false, 1}, "");
  plot.points(curve, Marker::circle, {PlotColour::first, 1.6, false, 1}, "chosen readings");
  if (result.enough < result.curve.size()) {
    const PlanPoint& enough = result.curve[result.enough];
    plot.points({{static_cast<double>(enough.readings), 1e3 * enough.uncertainty}}, Marker::up,
                {PlotColour::third, 1.6, false, 1}, "enough");
  }
  std::vector<PlotPoint> grids;
  for (const GridsOfANumber& one : result.curve_grids)
    if (one.determined)
      grids.push_back({static_cast<double>(one.determined->value.readings), 1e3 * one.determined->value.uncertainty});
  if (!grids.empty())
    plot.points(grids, Marker::cross, {PlotColour::second, 1.6, false, 1}, "best grid that determines everything");
  return plot.svg();
}

nlohmann::ordered_json plan_json(const Study& study, const StudyPlan& result) {
  const char* const goals[] = {"volumetric", "determinant", "parameters"};
  nlohmann::ordered_json json;
  json["format"] = "abbe-plan/1";
  json["study"] = study.name;
  json["machine"] = study.machine.name;
  json["status"] = status_text(result.plan.status);
  json["goal"] = goals[static_cast<int>(study.planning->goal)];
  json["candidates"] = result.candidates;
  json["without_line_of_sight"] = result.hidden;
  json["forbidden_poses"] = result.forbidden;
  json["parameters"] = result.parameters;
  json["seen_directions"] = result.seen;
  for (const SetupChoice& choice : result.combinations) {
    nlohmann::ordered_json entry = {{"setups", choice.setups}, {"possible", choice.possible}};
    if (choice.possible) {
      entry["readings"] = choice.readings;
      entry["time_s"] = choice.time;
      entry["uncertainty_with_prior_um"] = 1e3 * choice.with_prior;
    }
    json["combinations"].push_back(entry);
  }
  add_planned_states(study, result, json);
  if (!result.drift.setups.empty()) json["drift"] = planned_drift_json(result);
  if (result.plan.status != PlanningStatus::done) return json;
  json["readings"] = result.readings.size();
  if (has_other_instruments(study)) {
    for (std::size_t s = 0; s < study.setups.size(); ++s) {
      json["readings_of_setups"][study.setups[s].name] =
          std::count_if(result.readings.begin(), result.readings.end(),
                        [s](const CandidateReading& reading) { return reading.setup == s; });
    }
  }
  json["time_s"] = result.time;
  if (!leaves_states_open(result)) json["predicted_volumetric_uncertainty_um"] = 1e3 * result.uncertainty;
  if (!result.not_identified.errors.empty()) {
    json["uncertainty_covers"] = kIdentifiedErrorsOnly;
    json["not_identified"] = result.not_identified.names;
  }
  json["largest_unseen_part_of_a_prediction"] = result.unseen_part;
  json["exchanges"] = result.plan.exchanges;
  json["predicted_volumetric_uncertainty_with_prior_um"] = 1e3 * result.with_prior;
  for (std::size_t k = 0; k < result.curve.size(); ++k) {
    const PlanPoint& point = result.curve[k];
    nlohmann::ordered_json entry = {{"readings", point.readings}, {"determined", point.determined}};
    if (point.determined) {
      entry["uncertainty_um"] = 1e3 * point.uncertainty;
      entry["uncertainty_with_prior_um"] = 1e3 * point.with_prior;
    }
    if (k < result.curve_grids.size()) {
      const GridsOfANumber& grids = result.curve_grids[k];
      if (grids.determined) entry["best_determined_grid"] = grid_json(*grids.determined);
      if (grids.any) entry["best_grid_with_prior"] = grid_json(*grids.any);
    }
    json["curve"].push_back(entry);
  }
  if (result.enough < result.curve.size()) json["enough_readings"] = result.curve[result.enough].readings;
  json["enough"] = result.enough_words;
  json["grids_tried"] = result.grids_tried;
  const GridsOfANumber& same = result.same_number;
  if (same.determined) {
    json["best_determined_grid_of_the_same_number"] = grid_json(*same.determined);
    json["gain"] = same.determined->value.uncertainty / result.uncertainty;
  }
  if (same.any) {
    json["best_grid_of_the_same_number_with_prior"] = grid_json(*same.any);
    json["gain_with_prior"] = same.any->value.with_prior / result.with_prior;
  }
  if (result.random_poses) {
    json["random_choice_uncertainty_um"] = 1e3 * result.random_poses->uncertainty;
    json["gain_over_random_choice"] = result.random_poses->uncertainty / result.uncertainty;
  }
  if (result.equal_grid) {
    json["grid_of_the_same_uncertainty"] = grid_json(*result.equal_grid);
    json["grid_readings_per_reading"] =
        static_cast<double>(result.equal_grid->value.readings) / static_cast<double>(result.readings.size());
  }
  return json;
}

std::string study_plan_text(const Study& study, const StudyPlan& result) {
  std::string text;
  text += fmt::format("{}: {}   ({})\n", study.name, study.machine.name, study.machine.chain());
  text += fmt::format("{} candidates; {} sights without a line of sight and {} poses in forbidden boxes left out\n",
                      result.candidates, result.hidden, result.forbidden);
  text += fmt::format("{} parameters, of which the candidates see {} directions\n", result.parameters, result.seen);
  if (result.plan.status != PlanningStatus::done) {
    text += fmt::format("no plan: {}\n", status_text(result.plan.status));
    return text + planned_drift_text(result) + planned_states_text(study, result);
  }
  text += combinations_text(result);
  if (result.unseen_part > 1e-6)
    text +=
        fmt::format("note: {:.2g} % of a prediction depends on directions that no candidate sees; they are left out\n",
                    100 * result.unseen_part);
  text += fmt::format("\n{} readings in {:.0f} min\n", result.readings.size(), result.time / 60);
  if (has_other_instruments(study)) text += setups_text(study, result);
  if (study.planning->time > 0 && result.time > study.planning->time)
    text += fmt::format("warning: this is more than the {:.0f} min allowed\n", study.planning->time / 60);
  text += leaves_states_open(result)
              ? fmt::format("predicted volumetric standard uncertainty: {}; with prior knowledge {:.3f} um\n",
                            open_states_words(result), 1e3 * result.with_prior)
              : fmt::format("predicted volumetric standard uncertainty (root mean square): {:.3f} um\n",
                            1e3 * result.uncertainty);
  if (!result.not_identified.errors.empty())
    text += fmt::format("  of the {}: not in the model and not covered are {}\n", kIdentifiedErrorsOnly,
                        not_identified_names(study, result.not_identified));
  text += planned_drift_text(result);
  text += planned_states_text(study, result);
  text += fmt::format("\nhow many are enough: {}\n", result.enough_words);
  const bool grids = result.grids_tried > 0;
  text += fmt::format("                  chosen{}\n", grids ? "    best grid" : "");
  for (std::size_t k = 0; k < result.curve.size(); ++k) {
    const PlanPoint& point = result.curve[k];
    std::string grid = grids ? "       open" : "";
    if (k < result.curve_grids.size() && result.curve_grids[k].determined)
      grid = fmt::format("{:>8.3f} um", 1e3 * result.curve_grids[k].determined->value.uncertainty);
    const char* const mark = k == result.enough ? "   <- enough" : "";
    if (point.determined)
      text += fmt::format("  {:>6} readings {:>6.3f} um{}{}\n", point.readings, 1e3 * point.uncertainty,
                          grid.empty() ? "" : " " + grid, mark);
    else
      text += fmt::format("  {:>6} readings   do not determine everything\n", point.readings);
  }
  if (grids) text += grids_text(result);
  return text;
}

}  // namespace abbe
