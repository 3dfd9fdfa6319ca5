#include "abbe/study/report/found_values_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/instrument.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

constexpr std::size_t kNumbersShown = 12;
constexpr std::size_t kParametersShown = 4;

/// Decimals of a number so that its uncertainty has two significant digits, 0 to 9.
int decimals_for(double uncertainty) {
  int decimals = 0;
  for (double size = uncertainty; size > 0 && size < 9.5 && decimals < 9; size *= 10) ++decimals;
  return uncertainty > 0 ? decimals : 6;
}

/// Machine errors are small: um and urad. What is a size of a set-up reads in mm, its uncertainty as the others. A
/// scale has um/m.
std::string number_text(const FoundNumber& number, bool is_machine) {
  std::string text;
  const char* const small = number.is_pure_number ? kPureUnit : micro_unit(number.is_angle);
  const double to_small = number.is_pure_number ? kPurePerUnit : micro_per_unit(number.is_angle);
  const bool in_small = is_machine || number.is_angle || number.is_pure_number;
  const double unit = in_small ? to_small : 1;
  const char* const unit_name = in_small ? small : "mm";
  const int decimals = in_small ? 3 : 6;
  const std::string uncertainty =
      number.is_fixed ? "by convention" : fmt::format("{:.3g} {}", to_small * number.expanded_uncertainty, small);
  text += fmt::format("    {:<24} {:>16.{}f} {:<5} {:<16} {}\n", number.name, unit * number.value, decimals, unit_name,
                      uncertainty, number.words);
  return text;
}

std::string expansion_words(const FoundExpansion& found) {
  std::string text = fmt::format("    scale of {:<15} {:>16.3f} um/(m K)  ", found.axis, 1e6 * found.coefficient);
  const bool exact = found.stated.knowledge == Knowledge::exact;
  if (exact) return text + fmt::format("as stated; per K of {}\n", found.state);
  text += found.is_fixed ? "by convention" : fmt::format("{:.3g} um/(m K)", 1e6 * found.expanded_uncertainty);
  if (found.stated.knowledge == Knowledge::within) {
    text += fmt::format(", stated {:.6g}, U {:.3g}", 1e6 * found.stated.value, 2e6 * found.stated.standard_uncertainty);
  }
  text += fmt::format("; per K of {}", found.state);
  if (!found.correlated.empty())
    text += fmt::format(", correlation {:.2f} with {}", found.correlation, found.correlated);
  return text + "\n";
}

nlohmann::ordered_json expansions_json(const std::vector<FoundExpansion>& list) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const FoundExpansion& found : list) {
    nlohmann::ordered_json json;
    json["axis"] = found.axis;
    json["state"] = found.state;
    json["fixed_point_mm"] = found.fixed_point;
    json["coefficient_um_per_m_K"] = 1e6 * found.coefficient;
    if (found.is_fixed) json["by_convention"] = true;
    if (found.expanded_uncertainty > 0) {
      json["expanded_uncertainty_um_per_m_K"] = 1e6 * found.expanded_uncertainty;
    }
    if (found.stated.knowledge != Knowledge::open) json["stated_um_per_m_K"] = 1e6 * found.stated.value;
    if (found.stated.knowledge == Knowledge::within) {
      json["stated_standard_uncertainty_um_per_m_K"] = 1e6 * found.stated.standard_uncertainty;
    }
    if (!found.correlated.empty()) {
      json["largest_correlation"] = {{"with", found.correlated}, {"value", found.correlation}};
    }
    all.push_back(std::move(json));
  }
  return all;
}

/// What nothing was estimated of has no uncertainty; that is not an uncertainty of zero.
bool is_estimated(const Eigen::Vector3d& expanded) { return expanded.cwiseAbs().maxCoeff() > 0; }

std::string place_text(const FoundPlace& place) {
  std::string text;
  const auto three = [](const Eigen::Vector3d& v, double unit, const Eigen::Vector3d& u, double u_unit) {
    std::string numbers;
    for (int k = 0; k < 3; ++k) {
      numbers += fmt::format("{}{:.{}f}", k > 0 ? ", " : "", unit * v[k], decimals_for(u_unit * u[k]));
    }
    return numbers;
  };
  const auto sizes = [](const Eigen::Vector3d& v, double unit) {
    return fmt::format("{:.3g}, {:.3g}, {:.3g}", unit * v[0], unit * v[1], unit * v[2]);
  };
  const std::string not_estimated = "not estimated: as stated or by convention";
  const auto turn = [&] {
    return is_estimated(place.turn_expanded)
               ? fmt::format("U of a turn about x, y, z ({}) urad", sizes(place.turn_expanded, 1e6))
               : not_estimated;
  };
  text += fmt::format("    {} in the frame of the {}\n", place.name, body_name(place.body));
  text +=
      fmt::format("      position x, y, z      ({}) mm, {}\n", three(place.position, 1, place.position_expanded, 1),
                  is_estimated(place.position_expanded) ? fmt::format("U ({}) um", sizes(place.position_expanded, 1e3))
                                                        : not_estimated);
  if (place.rotation) {
    text += fmt::format("      angles a, b, c        ({}) deg, {}\n",
                        three(place.angles(), 1 / kDegree, place.turn_expanded, 1 / kDegree), turn());
  } else if (place.direction) {
    text += fmt::format("      direction x, y, z     ({}), {}\n", three(*place.direction, 1, place.turn_expanded, 1),
                        turn());
  }
  return text;
}

nlohmann::ordered_json number_json(const FoundNumber& number, bool is_machine) {
  const bool in_small = is_machine || number.is_angle;
  const std::string small = std::string("_") + micro_unit(number.is_angle);
  const double to_small = micro_per_unit(number.is_angle);
  nlohmann::ordered_json json;
  json["name"] = number.name;
  if (!number.words.empty()) json["words"] = number.words;
  json["value" + (in_small ? small : std::string("_mm"))] = (in_small ? to_small : 1) * number.value;
  if (number.is_fixed) {
    json["by_convention"] = true;
  } else {
    json["expanded_uncertainty" + small] = to_small * number.expanded_uncertainty;
  }
  return json;
}

nlohmann::ordered_json three_json(const Eigen::Vector3d& v, double unit) {
  return {unit * v[0], unit * v[1], unit * v[2]};
}

nlohmann::ordered_json place_json(const FoundPlace& place) {
  nlohmann::ordered_json json;
  json["name"] = place.name;
  json["frame"] = body_name(place.body);
  json["position_mm"] = three_json(place.position, 1);
  if (is_estimated(place.position_expanded)) {
    json["position_expanded_uncertainty_um"] = three_json(place.position_expanded, 1e3);
  }
  if (place.rotation) {
    json["angles_deg"] = three_json(place.angles(), 1 / kDegree);
    json["rotation"] = nlohmann::ordered_json::array();
    for (int row = 0; row < 3; ++row) json["rotation"].push_back(three_json(place.rotation->row(row), 1));
  }
  if (place.direction) json["direction"] = three_json(*place.direction, 1);
  if ((place.rotation || place.direction) && is_estimated(place.turn_expanded)) {
    json["turn_expanded_uncertainty_urad"] = three_json(place.turn_expanded, 1e6);
  }
  return json;
}

nlohmann::ordered_json numbers_json(const std::vector<FoundNumber>& numbers, bool is_machine) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const FoundNumber& number : numbers) list.push_back(number_json(number, is_machine));
  return list;
}

std::string names_of(const Identification& identified, const GaugeConstraint& constraint) {
  std::string names;
  for (std::size_t i = 0; i < constraint.inseparable.size(); ++i) {
    if (i == kParametersShown) return names + fmt::format(" and {} more", constraint.inseparable.size() - i);
    names += (i > 0 ? ", " : "") + identified.parameters[constraint.inseparable[i]].name;
  }
  return names;
}

}  // namespace

std::string found_values_text(const FoundValues& found, const char* shows_all) {
  std::string text;
  const bool of_machine =
      !found.expansions.empty() || !found.locations.empty() || !found.reversals.empty() || !found.tool.empty();
  if (!of_machine && found.setups.empty()) return text;
  text += "\nidentified values, U: expanded uncertainty (k = 2)\n";
  if (of_machine) {
    text += fmt::format("  machine                  {:>19}       {}\n", "value", "U");
    for (const FoundExpansion& one : found.expansions) text += expansion_words(one);
    for (const auto* list : {&found.locations, &found.reversals, &found.tool}) {
      for (const FoundNumber& number : *list) text += number_text(number, true);
    }
    if (found.tool_offset) {
      text += fmt::format("    tool offset with its error ({:.4f}, {:.4f}, {:.4f}) mm\n", (*found.tool_offset)[0],
                          (*found.tool_offset)[1], (*found.tool_offset)[2]);
    }
  }
  for (const FoundSetup& setup : found.setups) {
    text += fmt::format("  set-up {} ({})\n", setup.name, setup.instrument);
    for (const FoundPlace& place : setup.places) text += place_text(place);
    const std::size_t shown =
        shows_all == nullptr ? setup.numbers.size() : std::min(setup.numbers.size(), kNumbersShown);
    for (std::size_t i = 0; i < shown; ++i) text += number_text(setup.numbers[i], false);
    if (shown < setup.numbers.size()) text += fmt::format("    {} more: {}\n", setup.numbers.size() - shown, shows_all);
  }
  return text;
}

nlohmann::ordered_json found_values_json(const FoundValues& found) {
  nlohmann::ordered_json json;
  json["coverage_factor"] = 2;
  if (!found.expansions.empty()) json["expansions"] = expansions_json(found.expansions);
  json["location_errors"] = numbers_json(found.locations, true);
  json["reversals"] = numbers_json(found.reversals, true);
  if (found.tool_offset) {
    json["tool_offset_error"] = numbers_json(found.tool, true);
    json["tool_offset_mm"] = three_json(*found.tool_offset, 1);
  }
  json["setups"] = nlohmann::ordered_json::array();
  for (const FoundSetup& setup : found.setups) {
    nlohmann::ordered_json entry = {{"name", setup.name}, {"instrument", setup.instrument}};
    entry["places"] = nlohmann::ordered_json::array();
    for (const FoundPlace& place : setup.places) entry["places"].push_back(place_json(place));
    entry["values"] = numbers_json(setup.numbers, false);
    json["setups"].push_back(entry);
  }
  return json;
}

std::string gauge_table_text(const Identification& identified) {
  std::string text;
  const std::vector<GaugeConstraint>& constraints = identified.gauge.constraints;
  if (constraints.empty()) return text;
  std::size_t width = 0;
  for (const GaugeConstraint& constraint : constraints) width = std::max(width, constraint.words.size());
  text += "\nwhat the readings cannot tell apart, and what was assumed instead\n";
  text += fmt::format("  {:<{}}  {}\n", "assumed", width, "because these are not separable");
  for (const GaugeConstraint& constraint : constraints) {
    text += fmt::format("  {:<{}}  {}\n", constraint.words, width, names_of(identified, constraint));
  }
  return text;
}

nlohmann::ordered_json gauge_table_json(const Identification& identified) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const GaugeConstraint& constraint : identified.gauge.constraints) {
    std::vector<std::string> names;
    for (const std::size_t p : constraint.inseparable) names.push_back(identified.parameters[p].name);
    list.push_back(
        {{"assumed", constraint.words}, {"not_separable", names}, {"by_convention", constraint.by_convention}});
  }
  return list;
}

}  // namespace abbe
