#include "abbe/study/planning/plan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/pages/path_data.h"
#include "abbe/report/report.h"
#include "abbe/report/version.h"
#include "abbe/study/planning/plan_states_text.h"
#include "abbe/study/planning/plan_text.h"

namespace abbe {
namespace {

constexpr double kMinute = 60;
constexpr double kNoticedPart = 1e-6;  // of a prediction in directions that nobody sees

std::string um_text(double length) { return fmt::format("{:.3f}", 1e3 * length); }

nlohmann::json um_or_null(const std::optional<GridPoint>& grid) {
  return grid && grid->value.determined ? nlohmann::json(for_drawing(1e3 * grid->value.uncertainty)) : nlohmann::json();
}

const char* goal_words(PlanningGoal goal) {
  switch (goal) {
    case PlanningGoal::volumetric:
      return "smallest predicted volumetric uncertainty";
    case PlanningGoal::determinant:
      return "smallest volume of the confidence region (determinant)";
    case PlanningGoal::parameters:
      return "smallest uncertainty of named parameters";
  }
  return "";
}

nlohmann::json curve_json(const StudyPlan& plan) {
  nlohmann::json curve = {{"readings", nlohmann::json::array()}, {"uncertainty_um", nlohmann::json::array()}};
  for (const PlanPoint& point : plan.curve) {
    curve["readings"].push_back(point.readings);
    curve["uncertainty_um"].push_back(point.determined ? nlohmann::json(for_drawing(1e3 * point.uncertainty))
                                                       : nlohmann::json());
  }
  for (const GridsOfANumber& grids : plan.curve_grids) {
    curve["grid_readings"].push_back(grids.determined ? nlohmann::json(grids.determined->value.readings)
                                                      : nlohmann::json());
    curve["grid_uncertainty_um"].push_back(um_or_null(grids.determined));
  }
  return curve;
}

nlohmann::json plan_figures(const StudyPlan& plan) {
  nlohmann::json figures = nlohmann::json::array();
  const auto add = [&](const char* symbol, const std::string& name, const char* key, double value, int decimals) {
    figures.push_back({{"symbol", symbol}, {"name", name}, {key, value}, {"decimals", decimals}});
  };
  add("u", "predicted volumetric standard uncertainty, root mean square", "value_um", 1e3 * plan.uncertainty, 3);
  add("readings", "to be taken", "value", static_cast<double>(plan.readings.size()), 0);
  add("time", "of the whole measurement", "value_min", plan.time / kMinute, 1);
  if (plan.same_number.determined) {
    add("gain", "uncertainty of the best grid of as many readings, over that of the plan", "value",
        plan.same_number.determined->value.uncertainty / plan.uncertainty, 2);
  }
  if (plan.random_poses) {
    add("random", "uncertainty of as many candidates at random, over that of the plan", "value",
        plan.random_poses->uncertainty / plan.uncertainty, 2);
  }
  if (plan.equal_grid) {
    add("grid", "readings of the smallest grid of the same uncertainty, over those of the plan", "value",
        static_cast<double>(plan.equal_grid->value.readings) / static_cast<double>(plan.readings.size()), 2);
  }
  return figures;
}

nlohmann::json comparison_table(const StudyPlan& plan) {
  nlohmann::json rows = nlohmann::json::array();
  const auto add = [&](const char* choice, std::size_t readings, double uncertainty, double of_the_plan,
                       const std::string& made) {
    rows.push_back({choice, std::to_string(readings), um_text(uncertainty),
                    fmt::format("{:.2f}", uncertainty / of_the_plan), made});
  };
  const auto add_grid = [&](const char* choice, const GridPoint& grid, double uncertainty, double of_the_plan) {
    std::string made = grid.words;
    if (grid.open > 0) {
      made += fmt::format("; by itself it leaves {} direction{} open, most of all in {}", grid.open,
                          grid.open == 1 ? "" : "s", grid.open_words);
    }
    add(choice, grid.value.readings, uncertainty, of_the_plan, made);
  };
  add("plan", plan.readings.size(), plan.uncertainty, plan.uncertainty, "");
  if (const auto& grid = plan.same_number.determined) {
    add_grid("best grid that determines everything", *grid, grid->value.uncertainty, plan.uncertainty);
  }
  if (plan.random_poses) {
    add("candidates at random", plan.random_poses->readings, plan.random_poses->uncertainty, plan.uncertainty,
        fmt::format("median of {} draws", plan.random_tried));
  }
  if (plan.equal_grid) {
    add_grid("grid of the same uncertainty", *plan.equal_grid, plan.equal_grid->value.uncertainty, plan.uncertainty);
  }
  if (const auto& grid = plan.same_number.any) {
    add("plan, with prior knowledge", plan.readings.size(), plan.with_prior, plan.with_prior,
        "every error within 20 \xC2\xB5m or 60 \xC2\xB5rad");
    add_grid("best grid, with prior knowledge", *grid, grid->value.with_prior, plan.with_prior);
  }
  nlohmann::json table = {
      {"title", plan.grids_tried > 0 ? "Against grids and chance" : "Against chance"},
      {"columns", {"choice", "readings", "uncertainty / \xC2\xB5m", "against the plan", "how it is made"}},
      {"rows", rows}};
  if (plan.grids_tried > 0) {
    table["note"] = fmt::format(
        "{} grids were tried, in the same limits and lines of sight; a grid has as many readings "
        "or up to a fifth more.",
        plan.grids_tried);
  }
  return table;
}

/// What setting up is worth: one row for each combination of set-ups.
nlohmann::json combinations_table(const StudyPlan& plan) {
  nlohmann::json rows = nlohmann::json::array();
  for (const SetupChoice& choice : plan.combinations) {
    rows.push_back({fmt::format("{}", fmt::join(choice.setups, ", ")),
                    choice.possible ? std::to_string(choice.readings) : "",
                    choice.possible ? fmt::format("{:.0f}", choice.time / kMinute) : "",
                    choice.possible ? um_text(choice.with_prior) : "open"});
  }
  return {{"title", "Which instruments are worth setting up"},
          {"columns", {"set-ups", "readings", "time / min", "with prior / \xC2\xB5m"}},
          {"rows", rows}};
}

nlohmann::json curve_table(const StudyPlan& plan) {
  nlohmann::json rows = nlohmann::json::array();
  nlohmann::json columns = {"readings", "chosen / \xC2\xB5m", "with prior / \xC2\xB5m"};
  if (plan.grids_tried > 0) {
    for (const char* column : {"best grid / \xC2\xB5m", "its readings", "how the grid is made"})
      columns.push_back(column);
  }
  for (std::size_t k = 0; k < plan.curve.size(); ++k) {
    const PlanPoint& point = plan.curve[k];
    const GridPoint* const grid =
        k < plan.curve_grids.size() && plan.curve_grids[k].determined ? &*plan.curve_grids[k].determined : nullptr;
    nlohmann::json row = {std::to_string(point.readings), point.determined ? um_text(point.uncertainty) : "",
                          um_text(point.with_prior)};
    if (plan.grids_tried > 0) {
      row.push_back(grid != nullptr ? um_text(grid->value.uncertainty) : "");
      row.push_back(grid != nullptr ? std::to_string(grid->value.readings) : "");
      row.push_back(grid != nullptr ? grid->words : "open");
    }
    rows.push_back(std::move(row));
  }
  return {{"title", "Uncertainty over the number of readings"}, {"columns", columns}, {"rows", rows}};
}

std::vector<std::string> open_words(const Study& study, const StudyPlan& plan) {
  std::vector<std::string> words;
  if (plan.seen < plan.parameters) {
    words.push_back(fmt::format(
        "{} of the {} combinations of parameters change no reading of any candidate. A convention fixes them when the "
        "readings are identified; the plan is about the other {}, and determines all of them.",
        plan.parameters - plan.seen, plan.parameters, plan.seen));
  } else {
    words.push_back(fmt::format("The plan determines all {} combinations of parameters.", plan.parameters));
  }
  if (plan.unseen_part > kNoticedPart) {
    words.push_back(fmt::format(
        "Up to {:.2g} % of a prediction depends on combinations that no candidate sees; they are left out of the "
        "predicted uncertainty.",
        100 * plan.unseen_part));
  }
  if (!plan.not_identified.errors.empty()) {
    words.push_back(fmt::format(
        "Errors of the machine that are not in the model, and that the predicted uncertainty therefore does "
        "not cover: {}.",
        not_identified_names(study, plan.not_identified)));
  }
  return words;
}

nlohmann::json readings_json(const Study& study, const StudyPlan& plan, const std::vector<double>& times) {
  nlohmann::json columns = {"reading", "time / min"}, rows = nlohmann::json::array();
  for (const Axis& axis : study.machine.axes) {
    columns.push_back(axis.name + (axis.kind == AxisKind::rotary ? " / \xC2\xB0" : " / mm"));
  }
  const PlanColumns names = plan_columns(study);
  if (names.setup) columns.push_back("set-up");
  if (names.station) columns.push_back("station");
  columns.push_back(names.target);
  for (std::size_t k = 0; k < plan.readings.size(); ++k) {
    const CandidateReading& reading = plan.readings[k];
    nlohmann::json row = {std::to_string(k + 1), fmt::format("{:.1f}", times[k] / kMinute)};
    for (std::size_t i = 0; i < reading.pose.size(); ++i) {
      row.push_back(fmt::format("{:.3f}", reading.pose[i] / position_unit(study.machine.axes[i])));
    }
    const Setup& setup = study.setups[reading.setup];
    const std::vector<std::string> stations = setup.device->station_names();
    if (names.setup) row.push_back(setup.name);
    if (names.station) row.push_back(stations.empty() ? "" : stations[setup.device->station_of(reading.item)]);
    row.push_back(setup.device->target_names()[setup.device->target_of(reading.item)]);
    rows.push_back(std::move(row));
  }
  return {{"columns", columns}, {"rows", rows}};
}

nlohmann::json poses_json(const Study& study, const StudyPlan& plan, const std::vector<double>& times) {
  const Machine& machine = study.machine;
  PathPicture picture;
  picture.title = "The chosen poses on the machine";
  picture.note = "Time: the slowest axis of each move, settling and reading, without acceleration.";
  for (std::size_t k = 0; k < plan.readings.size(); ++k) {
    const std::vector<double>& pose = plan.readings[k].pose;
    const RigidTransform place = nominal_workpiece_from_tool(machine, pose);
    DrawnMove move;
    std::copy(pose.begin(), pose.end(), move.command.begin());
    move.point = place.translation;
    move.direction = place.rotation * machine.tool_direction;
    move.time = times[k];
    picture.moves.push_back(move);
  }
  nlohmann::json json = path_data(machine, picture);
  json["stops"] = true;
  return json;
}

nlohmann::json plan_facts(const Study& study, const StudyPlan& plan) {
  nlohmann::json facts = nlohmann::json::array();
  const auto add = [&](const char* name, const std::string& text) {
    facts.push_back({{"name", name}, {"text", text}});
  };
  add("machine", fmt::format("{} ({})", study.machine.name, study.machine.chain()));
  add("goal", goal_words(study.planning->goal));
  add("candidates", fmt::format("{}; {} sights hidden and {} poses in forbidden boxes left out", plan.candidates,
                                plan.hidden, plan.forbidden));
  add("model", fmt::format("{} parameters, of which the candidates see {} combinations", plan.parameters, plan.seen));
  for (const std::string& setup : plan.drift.setups) add("drift of a set-up", setup);
  if (!plan.drift.setups.empty() && plan.drift.determined) {
    add("beside the drift", fmt::format("{} of {} poses are revisited; {} um if nothing drifted",
                                        plan.drift.returned_to, plan.drift.poses, um_text(plan.drift.still)));
  }
  return facts;
}

std::vector<std::string> plan_notes(const StudyPlan& plan) {
  std::vector<std::string> notes = {
      "Predicted volumetric standard uncertainty: what the noise of the readings leaves in the displacement of the "
      "tool "
      "at poses over the working volume, after the best fit of the workpiece; root mean square.",
      "A number of readings is enough where more of them only average noise. The curve adds readings to those chosen "
      "before, so that it is a little above the plan at the plan's own number."};
  if (plan.same_number.any) {
    notes.emplace_back(
        "With prior knowledge: every error within 20 um or 60 urad, every number of a set-up within a thousand times "
        "that. So grids that do not determine everything can be compared too.");
  }
  return notes;
}

}  // namespace

nlohmann::json plan_page_data(const Study& study, const StudyPlan& plan) {
  const std::vector<double> times = reading_times(study, plan.readings, plan.states);
  nlohmann::json data;
  data["format"] = "abbe-report/1";
  data["title"] = "Planned measurement: " + study.name;
  data["subtitle"] = study.machine.name;
  data["generator"] = std::string("abbe ") + version_text();
  data["study"] = {{"name", study.name}, {"seed", study.seed}};
  data["evaluation"] = {{"kind", "plan"}, {"facts", plan_facts(study, plan)}, {"figures", plan_figures(plan)}};
  data["summary"]["verdict"] = fmt::format(
      "{} readings in {:.0f} min: predicted volumetric standard uncertainty{} {} um.", plan.readings.size(),
      plan.time / kMinute, plan.not_identified.errors.empty() ? "" : std::string(" of the ") + kIdentifiedErrorsOnly,
      (leaves_states_open(plan) ? "with prior knowledge " : "") + um_text(plan.uncertainty));
  data["warnings"] = nlohmann::json::array();
  if (study.planning->time > 0 && plan.time > study.planning->time) {
    data["warnings"].push_back(
        {{"level", "warning"},
         {"text", fmt::format("This takes longer than the {:.0f} min allowed.", study.planning->time / kMinute)}});
  }
  if (leaves_states_open(plan)) {
    data["warnings"].push_back(
        {{"level", "warning"},
         {"text", fmt::format("What the errors do where they are used is {}.", open_states_words(plan))}});
  }
  data["plan"]["curve"] = curve_json(plan);
  if (plan.enough < plan.curve.size()) data["plan"]["curve"]["enough"] = plan.enough;
  data["plan"]["enough_words"] = plan.enough_words;
  data["plan"]["open"] = open_words(study, plan);
  data["plan"]["readings"] = readings_json(study, plan, times);
  data["path"] = poses_json(study, plan, times);
  data["machine"] = nlohmann::json(report_machine(study.machine));
  data["tables"] = {comparison_table(plan), curve_table(plan)};
  for (nlohmann::json& table : planned_states_tables(plan)) data["tables"].push_back(std::move(table));
  if (!plan.combinations.empty()) data["tables"].push_back(combinations_table(plan));
  data["assumptions"] = plan_notes(plan);
  return data;
}

std::string plan_page(const Study& study, const StudyPlan& plan) { return report_page(plan_page_data(study, plan)); }

}  // namespace abbe
