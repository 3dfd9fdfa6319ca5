#include "abbe/study/report/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/study/study_result.h"

namespace abbe {
namespace {

/// Of each remedy; where nothing is determined there are as many directions as unknowns.
constexpr std::size_t kDirectionsShown = 4;

}  // namespace

nlohmann::ordered_json advice_json(const StudyResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Advice& advice : result.advice) {
    std::vector<std::string> names;
    for (const std::size_t p : advice.parameters) names.push_back(result.identification.parameters[p].name);
    list.push_back({{"kind", kind_text(advice.kind)},
                    {"parameters", names},
                    {"text", advice.text},
                    {"words", advice.words},
                    {"remedy", advice.remedy},
                    {"verified", advice.shown}});
    if (advice.factor > 0) list.back()["uncertainty_falls_times"] = advice.factor;
  }
  return list;
}

void tell_datum_apart(StudyResult& result, const UnseenPoses& unseen) {
  if (!unseen.open_known) return;
  const std::size_t constraints = result.identification.gauge.constraints.size();
  for (std::size_t i = 0; i < std::min(constraints, result.advice.size()); ++i) {
    Advice& advice = result.advice[i];
    const std::vector<std::size_t>& open = unseen.open_constraints;
    if (advice.kind != AdviceKind::not_measured || std::find(open.begin(), open.end(), i) != open.end()) continue;
    advice.kind = AdviceKind::datum;
    advice.remedy = "none is needed: the volumetric error does not depend on it";
  }
}

std::string advice_text(const StudyResult& result, const char* shows_all) {
  std::string text;
  std::vector<std::string> remedies;
  std::size_t conventions = 0, set_up = 0, datum = 0;
  for (const Advice& advice : result.advice) {
    conventions += advice.kind == AdviceKind::convention ? 1U : 0U;
    const bool no_harm = advice.kind == AdviceKind::set_up && !advice.shown;
    set_up += no_harm ? 1U : 0U;
    datum += advice.kind == AdviceKind::datum ? 1U : 0U;
    if (advice.kind == AdviceKind::convention || advice.kind == AdviceKind::datum || no_harm) continue;
    if (std::find(remedies.begin(), remedies.end(), advice.remedy) == remedies.end()) remedies.push_back(advice.remedy);
  }
  if (!remedies.empty()) text += "\nnot measured, and what would show more (tried with simulated readings)\n";
  for (const std::string& remedy : remedies) {
    text += fmt::format("  {}:\n", remedy);
    std::size_t found = 0;
    for (const Advice& advice : result.advice) {
      if (advice.remedy != remedy) continue;
      if (++found > kDirectionsShown && shows_all != nullptr) continue;
      text += fmt::format("    {}{}\n", advice.text,
                          advice.factor > 0 ? fmt::format(" (would fall {:.1f} times)", advice.factor) : "");
      if (!advice.words.empty()) text += fmt::format("      ({})\n", advice.words);
    }
    if (found > kDirectionsShown && shows_all != nullptr) {
      const std::size_t more = found - kDirectionsShown;
      text += fmt::format("    and {} more such direction{}: {}\n", more, more == 1 ? "" : "s", shows_all);
    }
  }
  if (conventions > 0)
    text += fmt::format("\n{} of the directions not seen {}: no measurement would show {}\n", conventions,
                        conventions > 1 ? "are conventions" : "is a convention", conventions > 1 ? "them" : "it");
  if (datum > 0)
    text +=
        fmt::format("{} move{} the workpiece as a whole or not at all; the volumetric error does not depend on {}\n",
                    datum, datum > 1 ? "" : "s", datum > 1 ? "them" : "it");
  if (set_up > 0)
    text += fmt::format("{} concern{} the set-up alone; the machine's errors do not depend on {}\n", set_up,
                        set_up > 1 ? "" : "s", set_up > 1 ? "them" : "it");
  return text;
}

}  // namespace abbe
