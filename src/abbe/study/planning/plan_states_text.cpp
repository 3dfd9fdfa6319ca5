#include "abbe/study/planning/plan_states_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr double kHour_s = 3600;
constexpr std::size_t kStatesInText = 12;

bool is_part_of_plan(const StudyPlan& result) { return result.states.any(); }

std::size_t readings_at_condition(const StudyPlan& result, std::size_t condition) {
  return static_cast<std::size_t>(
      std::count_if(result.readings.begin(), result.readings.end(),
                    [condition](const CandidateReading& one) { return one.condition == condition; }));
}

std::string open_text(const ConditionsOfANumber& one) {
  return fmt::format("{} direction{} open, most of all in {}", one.open, one.open == 1 ? "" : "s", one.open_words);
}

/// Conditions of the plan in the order of their readings.
std::vector<std::size_t> conditions_in_turn(const StudyPlan& result) {
  std::vector<std::size_t> order;
  for (const CandidateReading& reading : result.readings) {
    if (std::find(order.begin(), order.end(), reading.condition) == order.end()) order.push_back(reading.condition);
  }
  return order;
}

std::string enough_sensor_words(const SensorSelection& sensors) {
  if (sensors.enough == 0) return "none is needed";
  std::string names;
  for (std::size_t k = 0; k < sensors.enough; ++k) {
    names += (k > 0 ? ", " : "") + sensors.names[sensors.forward[k].sensor];
  }
  return fmt::format("{} {} enough: within {:g} % of all", names, sensors.enough == 1 ? "is" : "are",
                     100 * kEnoughError);
}

std::string sensors_text(const SensorSelection& sensors) {
  std::string text = "\nwhich sensors matter (volumetric error that remains, with prior knowledge)\n";
  text += fmt::format("  {:>8.3f} um  with all, {:.3f} um without any\n", 1e3 * sensors.all, 1e3 * sensors.none);
  for (const SensorStep& step : sensors.without) {
    text += fmt::format("  {:>8.3f} um  without {}\n", 1e3 * step.error, sensors.names[step.sensor]);
  }
  for (std::size_t k = 0; k < sensors.forward.size(); ++k) {
    text += fmt::format("  {:>8.3f} um  {} {}\n", 1e3 * sensors.forward[k].error, k == 0 ? "with only" : "and",
                        sensors.names[sensors.forward[k].sensor]);
  }
  text += "  " + enough_sensor_words(sensors) + "\n";
  for (const SensorLikeness& one : sensors.alike) text += "  note: " + likeness_words(sensors.courses, one) + "\n";
  return text;
}

nlohmann::ordered_json sensors_json(const SensorSelection& sensors) {
  nlohmann::ordered_json json;
  json["error_with_all_um"] = 1e3 * sensors.all;
  json["error_without_any_um"] = 1e3 * sensors.none;
  for (const SensorStep& step : sensors.without) {
    json["without"].push_back({{"sensor", sensors.names[step.sensor]}, {"error_um", 1e3 * step.error}});
  }
  for (const SensorStep& step : sensors.forward) {
    json["added_in_turn"].push_back({{"sensor", sensors.names[step.sensor]}, {"error_um", 1e3 * step.error}});
  }
  json["enough"] = sensors.enough;
  for (const SensorLikeness& one : sensors.alike) json["alike"].push_back(likeness_json(sensors.courses, one));
  return json;
}

}  // namespace

std::string condition_words(const StudyPlan& result, std::size_t condition) {
  const PlanningCondition& one = result.states.conditions()[condition];
  const std::string states = result.states.words(one.states);
  if (!result.states.has_course()) return states;
  return fmt::format("{:.2f} h to {:.2f} h, about {}", one.from_s / kHour_s, one.to_s / kHour_s, states);
}

std::string conditions_list(const StudyPlan& result, const std::vector<std::size_t>& conditions) {
  std::string words;
  for (const std::size_t condition : conditions) {
    words += fmt::format("{}{}", words.empty() ? "" : "; ",
                         result.states.has_course()
                             ? fmt::format("{:.2f} h", result.states.conditions()[condition].from_s / kHour_s)
                             : condition_words(result, condition));
  }
  return words;
}

nlohmann::ordered_json states_json(const Study& study, const std::vector<double>& states) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t j = 0; j < states.size(); ++j) {
    if (!std::isnan(states[j])) json[state_column(study.machine.states[j])] = states[j];
  }
  return json;
}

std::string open_states_words(const StudyPlan& result) {
  return fmt::format("not determined at these states ({})", open_text(result.conditions));
}

std::string planned_states_text(const Study& study, const StudyPlan& result) {
  std::string text;
  if (!is_part_of_plan(result)) return text;
  text += fmt::format("\nat how many {} (uncertainty with prior knowledge of 20 um and 60 urad)\n",
                      result.states.has_course() ? "times" : "states");
  for (const ConditionsOfANumber& one : result.condition_curve) {
    if (!(one.with_prior > 0)) {
      text += fmt::format("  {:>3}: no time for readings\n", one.conditions.size());
      continue;
    }
    text += fmt::format("  {:>3}: {:>8.3f} um, {} readings{}{}\n", one.conditions.size(), 1e3 * one.with_prior,
                        one.readings, one.open > 0 ? "; " + open_text(one) : "", one.chosen ? "   <- taken" : "");
    text += fmt::format("       {}\n", conditions_list(result, one.conditions));
  }
  if (result.plan.status != PlanningStatus::done) return text;
  text += "\nwhen\n";
  const std::vector<double> times = reading_times(study, result.readings, result.states);
  for (const std::size_t condition : conditions_in_turn(result)) {
    double from = 0, to = 0;
    bool first = true;
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (result.readings[k].condition != condition) continue;
      if (first) from = times[k];
      first = false;
      to = times[k];
    }
    text +=
        fmt::format("  {:>5} readings, {:.2f} h to {:.2f} h: {}\n", readings_at_condition(result, condition),
                    from / kHour_s, to / kHour_s, result.states.words(result.states.conditions()[condition].states));
  }
  text += fmt::format("\nuncertainty where the errors are used (root mean square{})\n",
                      leaves_states_open(result) ? ", with prior knowledge" : "");
  // A dozen lines; JSON has all.
  const std::size_t step = std::max<std::size_t>(1, result.over_states.size() / kStatesInText);
  for (std::size_t k = 0; k < result.over_states.size(); k += step) {
    const UncertaintyAtStates& at = result.over_states[k];
    text += fmt::format("  {:>8.3f} um  {}{}\n", 1e3 * at.uncertainty,
                        result.states.has_course() ? fmt::format("{:.2f} h, ", at.time_s / kHour_s) : "",
                        result.states.words(at.states));
  }
  text += plain_states_text(result);
  if (!result.sensors.names.empty()) text += sensors_text(result.sensors);
  for (const std::string& note : result.states.notes()) text += "note: " + note + "\n";
  return text;
}

void add_planned_states(const Study& study, const StudyPlan& result, nlohmann::ordered_json& json) {
  if (!is_part_of_plan(result)) return;
  nlohmann::ordered_json states;
  for (const ConditionsOfANumber& one : result.condition_curve) {
    nlohmann::ordered_json entry = {{"conditions", one.conditions.size()}, {"possible", one.with_prior > 0}};
    if (one.with_prior > 0) {
      entry["readings"] = one.readings;
      entry["uncertainty_with_prior_um"] = 1e3 * one.with_prior;
      entry["open_directions"] = one.open;
      if (one.open > 0) entry["open_errors"] = one.open_words;
    }
    entry["taken"] = one.chosen;
    states["numbers"].push_back(entry);
  }
  for (const std::size_t condition : conditions_in_turn(result)) {
    const PlanningCondition& at = result.states.conditions()[condition];
    nlohmann::ordered_json entry = {{"states", states_json(study, at.states)}};
    if (result.states.has_course()) {
      entry["from_s"] = at.from_s;
      entry["to_s"] = at.to_s;
    }
    entry["readings"] = readings_at_condition(result, condition);
    states["conditions"].push_back(entry);
  }
  for (const UncertaintyAtStates& at : result.over_states) {
    nlohmann::ordered_json entry = {{"states", states_json(study, at.states)}};
    if (result.states.has_course()) entry["time_s"] = at.time_s;
    entry["uncertainty_um"] = 1e3 * at.uncertainty;
    states["uncertainty_over_states"].push_back(entry);
  }
  states["determined"] = !leaves_states_open(result);
  for (const PlainStates& plain : result.plain_states)
    states["against"].push_back(plain_states_json(study, result, plain));
  if (!result.sensors.names.empty()) states["sensors"] = sensors_json(result.sensors);
  if (!result.states.notes().empty()) states["notes"] = result.states.notes();
  json["states"] = states;
}

nlohmann::json planned_states_tables(const StudyPlan& result) {
  nlohmann::json tables = nlohmann::json::array();
  if (!is_part_of_plan(result)) return tables;
  nlohmann::json rows = nlohmann::json::array();
  for (const ConditionsOfANumber& one : result.condition_curve) {
    const bool possible = one.with_prior > 0;
    rows.push_back({std::to_string(one.conditions.size()), possible ? std::to_string(one.readings) : "",
                    possible ? fmt::format("{:.3f}", 1e3 * one.with_prior) : "no time",
                    one.open > 0 ? open_text(one) : "", conditions_list(result, one.conditions),
                    one.chosen ? "yes" : ""});
  }
  tables.push_back({{"title", result.states.has_course() ? "At how many times" : "At how many states"},
                    {"columns", {"number", "readings", "with prior / \xC2\xB5m", "open", "where", "taken"}},
                    {"rows", rows}});
  rows = nlohmann::json::array();
  for (const std::size_t condition : conditions_in_turn(result)) {
    rows.push_back({condition_words(result, condition), std::to_string(readings_at_condition(result, condition))});
  }
  tables.push_back({{"title", "When readings are taken"}, {"columns", {"states", "readings"}}, {"rows", rows}});
  rows = nlohmann::json::array();
  for (const UncertaintyAtStates& at : result.over_states) {
    rows.push_back({result.states.has_course() ? fmt::format("{:.2f}", at.time_s / kHour_s) : "",
                    result.states.words(at.states), fmt::format("{:.3f}", 1e3 * at.uncertainty)});
  }
  tables.push_back({{"title", "Uncertainty where the errors are used"},
                    {"columns", {"time / h", "states", "uncertainty / \xC2\xB5m"}},
                    {"rows", rows}});
  if (!result.plain_states.empty()) tables.push_back(plain_states_table(result));
  if (result.sensors.names.empty()) return tables;
  rows = nlohmann::json::array();
  for (const SensorStep& step : result.sensors.without) {
    const auto added = std::find_if(result.sensors.forward.begin(), result.sensors.forward.end(),
                                    [&](const SensorStep& one) { return one.sensor == step.sensor; });
    rows.push_back({result.sensors.names[step.sensor], fmt::format("{:.3f}", 1e3 * step.error),
                    std::to_string(added - result.sensors.forward.begin() + 1),
                    fmt::format("{:.3f}", 1e3 * added->error)});
  }
  std::string note =
      fmt::format("With all sensors {:.3f} \xC2\xB5m remain, without any {:.3f} \xC2\xB5m. {}.",
                  1e3 * result.sensors.all, 1e3 * result.sensors.none, enough_sensor_words(result.sensors));
  for (const SensorLikeness& one : result.sensors.alike)
    note += " " + likeness_words(result.sensors.courses, one) + ".";
  tables.push_back(
      {{"title", "Which sensors matter"},
       {"columns", {"sensor", "without it / \xC2\xB5m", "added as number", "with those added / \xC2\xB5m"}},
       {"rows", rows},
       {"note", note}});
  return tables;
}

std::string state_heads_of_plan(const Study& study, const StudyPlan& result) {
  std::string text;
  if (result.reading_states.empty()) return text;
  for (std::size_t j = 0; j < result.reading_states.front().size(); ++j) {
    if (!std::isnan(result.reading_states.front()[j])) text += "," + state_column(study.machine.states[j]);
  }
  return text;
}

std::string states_of_planned_reading(const StudyPlan& result, std::size_t reading) {
  std::string text;
  if (result.reading_states.empty()) return text;
  for (const double value : result.reading_states[reading]) {
    if (!std::isnan(value)) text += fmt::format(",{:.6g}", value);
  }
  return text;
}

}  // namespace abbe
