// Tables of changes, and the same for programs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/study/comparison/compared_report.h"

namespace abbe {
namespace {

constexpr double kSmallestProbability = 1e-4;  // below it, only that it is below

std::string micro_text(double value, bool angle) {
  const std::string text = fmt::format("{:.2f}", micro_per_unit(angle) * value);
  return text == "-0.00" ? "0.00" : text;
}

const char* micro_symbol(bool angle) { return angle ? "\xC2\xB5rad" : "\xC2\xB5m"; }

/// "\xC2\xB5m", "\xC2\xB5rad / K".
std::string unit_text(const ComparedError& error) {
  return micro_symbol(error.is_angle) + (error.per.empty() || error.per == "1" ? std::string() : " / " + error.per);
}

std::string probability_text(double probability) {
  return probability < kSmallestProbability ? "< 0.0001" : fmt::format("{:.4f}", probability);
}

const char* verdict_words(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::changed:
      return "changed";
    case ChangeVerdict::not_significant:
      return "not significant";
    case ChangeVerdict::not_known:
      return "not known";
    case ChangeVerdict::partly:
      return "set in part";
    case ChangeVerdict::only_first:
    case ChangeVerdict::only_second:
    case ChangeVerdict::by_convention:
      return "set by convention";
  }
  return "";
}

std::vector<const ComparedError*> what_matters_first(const ComparedPair& pair) {
  std::vector<const ComparedError*> order;
  for (const ComparedError& error : pair.errors) {
    if (is_comparable(error.verdict)) order.push_back(&error);
  }
  std::stable_sort(order.begin(), order.end(), [](const ComparedError* a, const ComparedError* b) {
    const bool first = a->verdict == ChangeVerdict::changed, second = b->verdict == ChangeVerdict::changed;
    return first != second ? first : first && a->at_tool > b->at_tool;
  });
  return order;
}

std::string place_text(const Machine& machine, const ComparedError& error) {
  if (!error.is_motion) return "";
  const Axis& axis = machine.axes[error.axis];
  return fmt::format("{:.5g} {}", error.at / position_unit(axis), axis.kind == AxisKind::rotary ? "\xC2\xB0" : "mm");
}

/// Errors in rows, pairs in columns: "5.01 ± 1.20 *".
EvaluationTable table_of_pairs(const ComparedCampaigns& result, const std::string& caption, bool against_first) {
  EvaluationTable table{caption, {"error", "what it is", "unit"}, {}, true, true};
  std::vector<const ComparedPair*> pairs;
  for (const ComparedPair& pair : result.pairs) {
    const bool is_drift = pair.second == pair.first + 1;
    if (against_first ? pair.first != 0 : !is_drift) continue;
    pairs.push_back(&pair);
    table.headers.push_back(pair_words(pair));
  }
  std::vector<const ComparedError*> names;
  for (const ComparedPair* const pair : pairs) {
    for (const ComparedError& error : pair->errors) {
      const bool listed =
          std::any_of(names.begin(), names.end(), [&](const ComparedError* one) { return one->name == error.name; });
      if (is_comparable(error.verdict) && !listed) names.push_back(&error);
    }
  }
  for (const ComparedError* const named : names) {
    std::vector<std::string> row = {named->name, named->words, unit_text(*named)};
    for (const ComparedPair* const pair : pairs) {
      const auto found = std::find_if(pair->errors.begin(), pair->errors.end(), [&](const ComparedError& one) {
        return one.name == named->name && is_comparable(one.verdict);
      });
      if (found == pair->errors.end()) {
        row.emplace_back("\xE2\x80\x93");
        continue;
      }
      std::string text = micro_text(found->change, found->is_angle);
      if (found->expanded_uncertainty) {
        text += " \xC2\xB1 " + micro_text(*found->expanded_uncertainty, found->is_angle);
      }
      if (found->verdict == ChangeVerdict::changed) text += " *";
      if (found->verdict == ChangeVerdict::not_known) text += " ?";
      row.push_back(text);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

double micro_number(double value, bool angle) { return std::round(micro_per_unit(angle) * value * 1e9) / 1e9; }

nlohmann::ordered_json error_details(const Machine& machine, const ComparedError& error) {
  const bool angle = error.is_angle;
  const std::string unit = std::string("_") + micro_unit(angle);
  nlohmann::ordered_json json;
  json["name"] = error.name;
  json["words"] = error.words;
  if (!error.per.empty()) json["per"] = error.per;
  json["verdict"] = change_verdict_name(error.verdict);
  if (!is_comparable(error.verdict)) return json;
  json["change" + unit] = micro_number(error.change, angle);
  if (error.expanded_uncertainty) {
    json["expanded_uncertainty" + unit] = micro_number(*error.expanded_uncertainty, angle);
  }
  json["first" + unit] = micro_number(error.value[0], angle);
  json["second" + unit] = micro_number(error.value[1], angle);
  if (error.is_motion) {
    const Axis& axis = machine.axes[error.axis];
    const std::string suffix = std::string("_") + position_suffix(axis);
    json["at" + suffix] = error.at / position_unit(axis);
    json["range" + suffix] = {error.from / position_unit(axis), error.to / position_unit(axis)};
    if (error.beyond[0] > 0) json["only_described_in_first" + unit] = micro_number(error.beyond[0], angle);
    if (error.beyond[1] > 0) json["only_described_in_second" + unit] = micro_number(error.beyond[1], angle);
  }
  if (error.chi_square) {
    json["chi_square"] = *error.chi_square;
    json["degrees_of_freedom"] = error.rank;
    json["probability"] = error.probability;
    json["adjusted_probability"] = error.adjusted;
  }
  json["largest_at_tool_um"] = micro_number(error.at_tool, false);
  return json;
}

}  // namespace

std::string change_verdict_name(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::changed:
      return "changed";
    case ChangeVerdict::not_significant:
      return "not_significant";
    case ChangeVerdict::not_known:
      return "not_known";
    case ChangeVerdict::partly:
      return "partly_set";
    case ChangeVerdict::only_first:
      return "only_first";
    case ChangeVerdict::only_second:
      return "only_second";
    case ChangeVerdict::by_convention:
      return "by_convention";
  }
  return "";
}

std::string campaign_letter(std::size_t campaign) { return std::string(1, static_cast<char>('A' + campaign)); }

std::string pair_words(const ComparedPair& pair) {
  return campaign_letter(pair.second) + " \xE2\x88\x92 " + campaign_letter(pair.first);
}

std::string pair_suffix(const ComparedPair& pair) {
  return campaign_letter(pair.second) + "-" + campaign_letter(pair.first);
}

std::string changed_words(const ComparedPair& pair) {
  const std::size_t changed = pair.count(ChangeVerdict::changed);
  const std::size_t judged = changed + pair.count(ChangeVerdict::not_significant);
  const std::size_t not_known = pair.count(ChangeVerdict::not_known) + pair.count(ChangeVerdict::partly);
  std::string text;
  if (judged > 0) {
    text = fmt::format("{} of {} errors changed", changed == 0 ? "none" : std::to_string(changed), judged);
    std::string names;
    for (const ComparedError* const error : what_matters_first(pair)) {
      if (error->verdict == ChangeVerdict::changed) names += (names.empty() ? ": " : ", ") + error->name;
    }
    text += names;
  }
  if (not_known > 0) {
    text += (text.empty() ? "" : "; ") + fmt::format("significance of {} not known", not_known);
  }
  return text.empty() ? "there is no error to compare" : text;
}

EvaluationTable table_of_changes(const ComparedCampaigns& result, const ComparedPair& pair) {
  const std::string first = campaign_letter(pair.first), second = campaign_letter(pair.second);
  EvaluationTable table{fmt::format("Changes from {} ({}) to {} ({})", result.names[pair.first], first,
                                    result.names[pair.second], second),
                        {"error", "what it is", first, second, pair_words(pair), "U (k = 2)", "unit", "at", "p",
                         "p (Holm)", "at the tool / \xC2\xB5m", "verdict"},
                        {}};
  for (const ComparedError* const error : what_matters_first(pair)) {
    const bool angle = error->is_angle;
    table.rows.push_back({error->name, error->words, micro_text(error->value[0], angle),
                          micro_text(error->value[1], angle), micro_text(error->change, angle),
                          error->expanded_uncertainty ? micro_text(*error->expanded_uncertainty, angle) : "",
                          unit_text(*error), place_text(result.machine, *error),
                          error->chi_square ? probability_text(error->probability) : "",
                          error->chi_square ? probability_text(error->adjusted) : "", micro_text(error->at_tool, false),
                          verdict_words(error->verdict)});
  }
  return table;
}

EvaluationTable table_against_first(const ComparedCampaigns& result) {
  return table_of_pairs(
      result, fmt::format("Changes against {} (A), U with k = 2; *: significant", result.names.front()), true);
}

EvaluationTable table_of_drift(const ComparedCampaigns& result) {
  return table_of_pairs(result, "Changes from each campaign to the next, U with k = 2; *: significant", false);
}

EvaluationTable table_of_the_rest(const ComparedPair& pair) {
  EvaluationTable table{fmt::format("Not compared, {}", pair_words(pair)), {"error", "why"}, {}, false, true};
  const std::string first = campaign_letter(pair.first), second = campaign_letter(pair.second);
  for (const std::string& name : pair.only_first) table.rows.push_back({name, "identified in " + first + " only"});
  for (const std::string& name : pair.only_second) table.rows.push_back({name, "identified in " + second + " only"});
  for (const std::string& name : pair.apart) table.rows.push_back({name, "there is no range in common"});
  const auto set_in = [](const std::string& one, const std::string& other) {
    return fmt::format("identified in {} only: a convention sets it in {}", other, one);
  };
  for (const ComparedError& error : pair.errors) {
    switch (error.verdict) {
      case ChangeVerdict::only_first:
        table.rows.push_back({error.name, set_in(second, first)});
        break;
      case ChangeVerdict::only_second:
        table.rows.push_back({error.name, set_in(first, second)});
        break;
      case ChangeVerdict::by_convention:
        table.rows.push_back({error.name, "a convention sets it in both, or it is known exactly"});
        break;
      case ChangeVerdict::partly:
        table.rows.push_back({error.name, "a convention sets a part of it in one campaign only"});
        break;
      default:
        break;
    }
  }
  return table;
}

nlohmann::ordered_json comparison_details(const ComparedCampaigns& result) {
  nlohmann::ordered_json json;
  json["machine"] = result.machine.name;
  json["level"] = result.level;
  json["judged"] = result.is_judged();
  for (std::size_t k = 0; k < result.names.size(); ++k) {
    json["campaigns"].push_back({{"letter", campaign_letter(k)}, {"name", result.names[k]}});
  }
  for (const ComparedPair& pair : result.pairs) {
    nlohmann::ordered_json one;
    one["first"] = campaign_letter(pair.first);
    one["second"] = campaign_letter(pair.second);
    one["errors"] = nlohmann::ordered_json::array();
    for (const ComparedError& error : pair.errors) one["errors"].push_back(error_details(result.machine, error));
    one["only_in_first"] = pair.only_first;
    one["only_in_second"] = pair.only_second;
    if (!pair.apart.empty()) one["no_range_in_common"] = pair.apart;
    if (!pair.conventions.empty()) one["conventions_set"] = pair.conventions;
    if (pair.partial.is_partial()) {
      one["errors_in_both"] = pair.partial.known;
      one["errors_of_machine"] = pair.partial.all();
      one["not_in_both"] = pair.partial.missing;
    }
    if (pair.chi_square) {
      one["chi_square"] = *pair.chi_square;
      one["degrees_of_freedom"] = pair.rank;
      one["probability"] = pair.probability;
    }
    if (pair.change.statistics.count > 0) {
      one["poses"] = pair.change.statistics.count;
      one["description"] = pair.stated.words;
      one["volumetric_change_um"] = statistics_um(pair.change.statistics);
      if (pair.share) {
        one["expanded_uncertainty_um"] = statistics_um(sample_statistics(pair.expanded, pair.change.covered));
        one["share_beyond_uncertainty"] = *pair.share;
      }
    }
    json["pairs"].push_back(std::move(one));
  }
  return json;
}

}  // namespace abbe
