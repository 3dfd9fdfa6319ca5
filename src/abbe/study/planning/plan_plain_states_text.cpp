// Plans over states against grids at plain states: text, JSON, table.
#include <fmt/format.h>

#include <optional>

#include "abbe/study/planning/plan_states_text.h"

namespace abbe {
namespace {

std::string plain_words(const StudyPlan& result, const PlainStates& plain) {
  const std::string where = conditions_list(result, plain.conditions);
  if (plain.kind == PlainStates::Kind::ends) return "a grid at the lowest and highest states (" + where + ")";
  return (result.states.has_course() ? "a grid at one time, from " : "a grid at one state, ") + where;
}

/// By how much the plan is better; none where one of the two leaves something open.
std::optional<double> gain_over(const StudyPlan& result, const PlainStates& plain) {
  if (!plain.grids.determined || leaves_states_open(result)) return std::nullopt;
  return plain.grids.determined->value.uncertainty / result.uncertainty;
}

}  // namespace

std::string plain_states_text(const StudyPlan& result) {
  if (result.plain_states.empty()) return "";
  std::string text = "\nagainst as many readings at plain states\n";
  for (const PlainStates& plain : result.plain_states) {
    text += "  " + plain_words(result, plain) + "\n";
    if (const auto gain = gain_over(result, plain)) {
      text += fmt::format("    {:.3f} um with {} readings ({}): the plan's is {:.2f} times smaller\n",
                          1e3 * plain.grids.determined->value.uncertainty, plain.grids.determined->value.readings,
                          plain.grids.determined->words, *gain);
    } else {
      text += fmt::format("    none of {} grids determines everything that the plan does\n", plain.grids.tried);
    }
    if (!plain.grids.any) continue;
    const GridPoint& any = *plain.grids.any;
    text += fmt::format(
        "    with prior knowledge in both {:.3f} um ({}): the plan's {:.3f} um is {:.2f} times smaller\n",
        1e3 * any.value.with_prior, any.words, 1e3 * result.with_prior, any.value.with_prior / result.with_prior);
    if (any.open > 0)
      text += fmt::format("    by itself it leaves {} directions open, most of all in {}\n", any.open, any.open_words);
  }
  return text;
}

nlohmann::json plain_states_table(const StudyPlan& result) {
  nlohmann::json rows = nlohmann::json::array();
  for (const PlainStates& plain : result.plain_states) {
    const auto gain = gain_over(result, plain);
    const std::string with_prior =
        plain.grids.any ? fmt::format("{:.3f}", 1e3 * plain.grids.any->value.with_prior) : "";
    rows.push_back(
        {plain_words(result, plain),
         plain.grids.determined ? fmt::format("{:.3f}", 1e3 * plain.grids.determined->value.uncertainty) : "open",
         gain ? fmt::format("{:.2f}", *gain) : "", with_prior,
         plain.grids.any ? fmt::format("{:.2f}", plain.grids.any->value.with_prior / result.with_prior) : ""});
  }
  return {{"title", "Against as many readings at plain states"},
          {"columns",
           {"readings", "uncertainty / \xC2\xB5m", "over the plan's", "with prior / \xC2\xB5m", "over the plan's"}},
          {"rows", rows}};
}

nlohmann::ordered_json plain_states_json(const Study& study, const StudyPlan& result, const PlainStates& plain) {
  nlohmann::ordered_json json;
  json["kind"] = plain.kind == PlainStates::Kind::ends ? "lowest_and_highest" : "one";
  for (const std::size_t condition : plain.conditions) {
    json["at"].push_back(states_json(study, result.states.conditions()[condition].states));
  }
  json["grids_tried"] = plain.grids.tried;
  json["determined"] = plain.grids.determined.has_value();
  if (plain.grids.determined) {
    json["uncertainty_um"] = 1e3 * plain.grids.determined->value.uncertainty;
    json["readings"] = plain.grids.determined->value.readings;
  }
  if (const auto gain = gain_over(result, plain)) json["gain"] = *gain;
  if (plain.grids.any) {
    json["uncertainty_with_prior_um"] = 1e3 * plain.grids.any->value.with_prior;
    json["open_directions"] = plain.grids.any->open;
    json["gain_with_prior"] = plain.grids.any->value.with_prior / result.with_prior;
  }
  return json;
}

}  // namespace abbe
