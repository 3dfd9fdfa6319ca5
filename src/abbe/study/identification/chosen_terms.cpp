#include "abbe/study/identification/chosen_terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/study/planning/planned_terms.h"

namespace abbe {
namespace {

bool grows_by_coefficients(BasisKind kind) {
  return kind == BasisKind::monomial || kind == BasisKind::legendre || kind == BasisKind::chebyshev ||
         kind == BasisKind::fourier;
}

std::size_t functions_at(const Basis& basis, int order) {
  if (!grows_by_coefficients(basis.kind)) return basis.size();
  const auto n = static_cast<std::size_t>(order);
  return basis.kind == BasisKind::fourier ? 2 * n + 1 : n + 1;
}

}  // namespace

std::vector<PlannedTerm> planned_terms(const Study& study, const ErrorSet& errors, TermsWanted wanted) {
  const IdentificationPlan& plan = *study.identification;
  std::vector<PlannedTerm> result;
  std::size_t next = 0;
  for (std::size_t m = 0; m < errors.motions.size(); ++m) {
    const std::size_t first = next;
    next += errors.motions[m].coefficients.size();
    const IdentifiedMotion& motion = plan.motions[m];
    const bool several = motion.smallest_order < motion.basis.order && grows_by_coefficients(motion.basis.kind);
    if (motion.state == kNoState) continue;
    if (!(motion.optional || several) && wanted == TermsWanted::to_be_chosen) continue;
    PlannedTerm planned;
    planned.state = motion.state;
    planned.index = m;
    planned.term.name = error_motion_name(study.machine, motion.axis, motion.component, motion.state);
    planned.term.least = motion.optional ? 0 : 1;
    std::size_t done = 0;
    for (int order = several ? motion.smallest_order : motion.basis.order; order <= motion.basis.order; ++order) {
      std::vector<std::size_t>& level = planned.term.levels.emplace_back();
      const std::size_t end = functions_at(errors.motions[m].basis, order);
      for (; done < end; ++done) level.push_back(first + done);
    }
    result.push_back(std::move(planned));
  }
  for (std::size_t l = 0; l < errors.locations.size(); ++l, ++next) {
    const IdentifiedLocation& location = plan.locations[l];
    if (location.state == kNoState || (!location.optional && wanted == TermsWanted::to_be_chosen)) continue;
    const std::string name = location_error_name(study.machine, location.axis, location.component, location.state);
    result.push_back({{name, {{next}}, location.optional ? 0U : 1U}, true, l, location.state});
  }
  return result;
}

std::vector<TimeBlocks> blocks_of_time(const Study& study, const Campaign& campaign, const std::string& what) {
  const IdentificationPlan& plan = *study.identification;
  std::vector<std::vector<double>> times;
  for (const CampaignSetup& setup : campaign.setups) {
    if (setup.readings.time_s.empty()) {
      throw InputError({.field = setup.name}, what + " by blocks of time, and readings have no times",
                       "a column time_s");
    }
    times.push_back(setup.readings.time_s);
  }
  return divide_by_time(times, plan.time_blocks, plan.time_gap_s);
}

namespace {

IdentificationPlan plan_of(const IdentificationPlan& all, const std::vector<PlannedTerm>& terms,
                           const std::vector<std::size_t>& levels) {
  IdentificationPlan plan = all;
  std::vector<std::uint8_t> keeps_motion(plan.motions.size(), 1), keeps_location(plan.locations.size(), 1);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    (terms[t].is_location ? keeps_location : keeps_motion)[terms[t].index] = levels[t] > 0 ? 1 : 0;
    if (terms[t].is_location || levels[t] == 0) continue;
    IdentifiedMotion& motion = plan.motions[terms[t].index];
    if (terms[t].term.levels.size() > 1) motion.basis.order = motion.smallest_order + static_cast<int>(levels[t]) - 1;
    motion.smallest_order = motion.basis.order;
  }
  const auto keep = [](auto& list, const std::vector<std::uint8_t>& keeps) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (keeps[i] != 0) list[kept++] = list[i];
    }
    list.resize(kept);
  };
  keep(plan.motions, keeps_motion);
  keep(plan.locations, keeps_location);
  return plan;
}

/// "order 2" where there were several.
std::string level_words(const ChosenTerms& terms, const TakenTerm& taken) {
  return terms.most[taken.candidate] > 1 ? fmt::format(" (step {} of {})", taken.levels, terms.most[taken.candidate])
                                         : std::string();
}

}  // namespace

ChosenTerms choose_terms(const Study& study, const Campaign& campaign, const Problem& problem,
                         const IdentifyOptions& options) {
  const IdentificationPlan& plan = *study.identification;
  const std::vector<TimeBlocks> blocks = blocks_of_time(study, campaign, "terms with states are chosen");
  ChosenTerms result;
  const std::vector<PlannedTerm> planned = planned_terms(study, problem.errors, TermsWanted::to_be_chosen);
  std::vector<CandidateTerm> candidates;
  for (const PlannedTerm& one : planned) {
    result.candidates.push_back(one.term.name);
    result.most.push_back(one.term.levels.size());
    candidates.push_back(one.term);
  }
  TermSelectionOptions selection;
  selection.identify = options;
  result.selection = select_terms(problem, candidates, blocks, selection);
  result.plan = result.selection.done ? plan_of(plan, planned, result.selection.levels) : plan;
  return result;
}

std::string chosen_terms_text(const ChosenTerms& terms) {
  const TermSelection& found = terms.selection;
  if (!found.done) {
    return fmt::format("  terms with states: not chosen ({} without them); all {} are identified\n",
                       status_text(found.status), terms.candidates.size());
  }
  std::string text = fmt::format(
      "  terms with states chosen by {} held-out blocks of time: {} of {}\n    held-out residual without them {:.3f} "
      "standard uncertainties\n",
      found.blocks, std::count_if(found.levels.begin(), found.levels.end(), [](std::size_t n) { return n > 0; }),
      terms.candidates.size(), found.first_rms);
  for (const TakenTerm& taken : found.taken) {
    text += fmt::format("    with {}{}: {:.3f}\n", terms.candidates[taken.candidate], level_words(terms, taken),
                        taken.after);
  }
  if (found.left_out > 0) {
    text += fmt::format("    {} blocks are not predicted: without them the readings do not determine what they need\n",
                        found.left_out);
  }
  return text;
}

nlohmann::ordered_json chosen_terms_json(const ChosenTerms& terms) {
  const TermSelection& found = terms.selection;
  nlohmann::ordered_json json;
  json["chosen"] = found.done;
  if (!found.done) json["status"] = status_text(found.status);
  json["candidates"] = terms.candidates;
  if (!found.done) return json;
  json["blocks_of_time"] = found.blocks;
  json["blocks_not_predicted"] = found.left_out;
  json["models_tried"] = found.tried;
  json["held_out_rms_without"] = found.first_rms;
  json["held_out_rms"] = found.last_rms;
  json["taken"] = nlohmann::ordered_json::array();
  for (const TakenTerm& taken : found.taken) {
    json["taken"].push_back({{"term", terms.candidates[taken.candidate]},
                             {"step", taken.levels},
                             {"steps", terms.most[taken.candidate]},
                             {"held_out_rms_before", taken.before},
                             {"held_out_rms", taken.after},
                             {"probability_by_chance", taken.probability}});
  }
  return json;
}

}  // namespace abbe
