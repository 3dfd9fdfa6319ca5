#include "abbe/study/planning/planning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/study/campaign.h"
#include "abbe/study/model.h"
#include "abbe/study/planning/planning_conditions.h"
#include "abbe/study/planning/planning_drift.h"
#include "abbe/study/planning/planning_schedule.h"
#include "abbe/study/planning/planning_setting.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/results_of_items.h"

namespace abbe {
namespace {

constexpr double kShares[] = {0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6, 2};
constexpr int kTimeRounds = 6;
constexpr int kCourseRounds = 20;
constexpr std::size_t kRandomDraws = 9;
constexpr int kRefinements = 4;
constexpr double kLeastCost_s = 1e-3;
constexpr std::size_t kMostTogether = 6;
constexpr std::size_t kPosesToCompare = 600;  // conditions by

/// Takes the share of the work that is done, 0 to 1, and throws Stopped where that was asked for.
using ShareCallback = std::function<void(double)>;

/// How far a plan is worked out.
enum class PlanningDepth {
  choice,  ///< readings and their uncertainty
  whole    ///< refined and compared with other choices
};

double root_mean_square(const PlanValue& value, const Eigen::MatrixXd& predictions) {
  return std::sqrt(value.variance / (static_cast<double>(predictions.rows()) / 3));
}

/// As many candidates as the plan has, without any choice.
void try_at_random(const PlanningSpace& space, const Eigen::MatrixXd& predictions, const Study& study,
                   const JobOptions& job, StudyPlan& result) {
  NumberedItems items{.name = "choices at random", .count = kRandomDraws, .threads = study.threads};
  items.fingerprint = [&] {
    Digest digest;
    digest.add_text(vector_instructions());
    digest.add(study.seed);
    digest.add(result.readings.size());
    for (const Eigen::MatrixXd* matrix : {&space.estimates_from_seen(), &predictions})
      digest.add_numbers({matrix->data(), static_cast<std::size_t>(matrix->size())});
    return digest.value();
  };
  items.compute = [&](std::size_t draw) -> ItemResult {
    stop_if_asked(job.stop);
    RandomStream random(study.seed + 2, draw);
    std::vector<std::size_t> order(space.count());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (std::size_t k = 0; k < result.readings.size(); ++k) {
      const double left = static_cast<double>(order.size() - k);
      std::swap(order[k], order[k + std::min(order.size() - k - 1, static_cast<std::size_t>(random.uniform() * left))]);
    }
    order.resize(result.readings.size());
    const PlanValue value = value_of(space, order, predictions);
    if (!value.determined) return {};
    return {{root_mean_square(value, predictions)}};
  };
  std::vector<double> found;
  for (const ItemResult& draw : results_of_items(job.work, items))
    found.insert(found.end(), draw.numbers.begin(), draw.numbers.end());
  result.random_tried = kRandomDraws;
  if (found.size() < (kRandomDraws + 1) / 2) return;
  std::sort(found.begin(), found.end());
  result.random_poses = PlanPoint{result.readings.size(), true, found[found.size() / 2], 0};
}

void say_what_is_enough(const PlanningStudy& plan, StudyPlan& result) {
  std::vector<std::size_t> counts, places;
  std::vector<double> uncertainty;
  for (std::size_t k = 0; k < result.curve.size(); ++k) {
    if (!result.curve[k].determined) continue;
    counts.push_back(result.curve[k].readings);
    uncertainty.push_back(result.curve[k].uncertainty);
    places.push_back(k);
  }
  result.enough = result.curve.size();
  if (plan.target > 0) {
    for (std::size_t k = uncertainty.size(); k-- > 0 && uncertainty[k] <= plan.target;) result.enough = places[k];
    result.enough_words = result.enough < result.curve.size()
                              ? fmt::format("the first of these numbers that reaches {:.4g} um", 1e3 * plan.target)
                              : fmt::format("none of these numbers reaches {:.4g} um", 1e3 * plan.target);
    return;
  }
  if (counts.size() < 2) {
    result.enough_words = "too few points of the curve determine everything";
    return;
  }
  const std::size_t enough = enough_points(counts, uncertainty);
  if (enough < counts.size()) {
    result.enough = places[enough];
    result.enough_words = "from here on, more readings only average noise";
  } else {
    result.enough_words = "the uncertainty still falls faster than by averaging: more readings are worth it";
  }
}

void check_costs(const Study& study) {
  for (const PlannedSetup& cost : study.planning->setups) {
    if (std::any_of(study.setups.begin(), study.setups.end(),
                    [&](const Setup& setup) { return setup.name == cost.name; })) {
      continue;
    }
    std::string names;
    for (const Setup& setup : study.setups) names += (names.empty() ? "" : ", ") + setup.name;
    throw InputError({.field = "plan.setup." + cost.name}, "there is no set-up of that name", "one of " + names);
  }
}

StudyPlan plan_all_setups(const Study& study, PlanningDepth depth, const ConditionsOfANumber& at,
                          const ShareCallback& progress, const JobOptions& job) {
  const std::stop_token& stop = job.stop;
  progress(0);
  const PlanningStudy& plan = *study.planning;
  const std::vector<std::size_t>& conditions = at.conditions;
  PlanningSetting setting = planning_setting(study, conditions, static_cast<std::size_t>(plan.candidates));
  const PlanningModel& model = *setting.model;
  PlanningModel::Candidates& candidates = setting.candidates;
  const Eigen::MatrixXd& predictions = setting.predictions;
  StudyPlan result;
  result.states = model.states();
  result.conditions = at;
  result.candidates = candidates.readings.size();
  result.hidden = candidates.hidden;
  result.forbidden = candidates.forbidden;
  add_reading_costs(study, candidates);
  auto space = std::make_unique<const PlanningSpace>(candidates.rows, model.known(), job.in_step, study.threads);
  result.parameters = space->parameter_count();
  result.seen = space->dimension();
  const Eigen::VectorXd unseen = space->unseen_part(predictions);
  // Rows that are zero but for rounding have no direction.
  const Eigen::VectorXd sizes = space->functionals(predictions).rowwise().norm();
  for (Eigen::Index i = 0; i < unseen.size(); ++i)
    if (sizes[i] > 1e-9 * sizes.maxCoeff()) result.unseen_part = std::max(result.unseen_part, unseen[i]);

  PlanningOptions options;
  options.threads = study.threads;
  options.in_step = job.in_step;
  options.seed = study.seed;
  if (plan.goal != PlanningGoal::determinant) {
    options.criterion = PlanningCriterion::variance;
    options.functionals = plan.goal == PlanningGoal::volumetric ? predictions : model.parameter_rows();
  }
  options.progress = [&](double share) { progress(0.6 * share); };

  const double sights = static_cast<double>(std::max<std::size_t>(1, model.sight_count()));
  const double quickest = plan.reading + plan.settle / sights;
  std::size_t count = plan.readings > 0 ? static_cast<std::size_t>(plan.readings) : result.candidates;
  if (plan.time > 0 && quickest > 0)
    count = std::min(count, static_cast<std::size_t>(std::max(1.0, plan.time / quickest)));
  const auto take = [&](const ReadingPlan& chosen, const PlanningModel::Candidates& from) {
    result.plan = chosen;
    result.readings.clear();
    for (const std::size_t i : chosen.chosen) result.readings.push_back(from.readings[i]);
    result.readings = scheduled_readings(study, result.states, result.readings);
    result.time = measuring_time(study, result.states, result.readings);
  };
  const bool has_costs = !candidates.rows.cost_s.empty();
  double set_up = 0;
  for (const Setup& setup : study.setups) set_up += plan.set_up_of(setup.name);
  const double fixed = set_up + model.states().change_time(conditions);
  double budget = plan.time - fixed;
  ConditionGroups groups(model);
  if (has_costs) count = plan.readings > 0 ? static_cast<std::size_t>(plan.readings) : result.candidates;
  for (int round = 0; round < (model.states().has_course() ? kCourseRounds : kTimeRounds); ++round) {
    options.count = std::min(count, result.candidates);
    if (has_costs) options.time_s = budget;
    groups.limit(candidates, options);
    take(plan_readings(*space, options), candidates);
    if (result.plan.status != PlanningStatus::done) break;
    const bool too_long = plan.time > 0 && result.time > plan.time;
    if (!groups.shrink(model, result.readings) && !too_long) break;
    if (!too_long) continue;
    if (has_costs) {
      budget *= 0.99 * (plan.time - fixed) / std::max(result.time - fixed, kLeastCost_s);
    } else {
      const double changes = fixed - set_up;
      count = static_cast<std::size_t>(
          std::max(1.0, 0.99 * static_cast<double>(options.count) * (plan.time - changes) / (result.time - changes)));
    }
  }
  if (result.plan.status != PlanningStatus::done) return result;
  const auto rows_of = [&](const std::vector<std::size_t>& chosen) {
    std::size_t count_rows = 0;
    for (const std::size_t i : chosen) count_rows += candidates.rows.first_row[i + 1] - candidates.rows.first_row[i];
    PlanningCandidates::Rows rows(static_cast<Eigen::Index>(count_rows), candidates.rows.rows.cols());
    Eigen::Index next = 0;
    for (const std::size_t i : chosen)
      for (std::size_t k = candidates.rows.first_row[i]; k < candidates.rows.first_row[i + 1]; ++k)
        rows.row(next++) = candidates.rows.rows.row(static_cast<Eigen::Index>(k));
    return rows;
  };
  // Of predictions; what is minimised is known.
  const auto predicted = [&](const ReadingPlan& chosen) {
    return plan.goal == PlanningGoal::volumetric ? chosen.value : value_of(*space, chosen.chosen, predictions);
  };
  const bool drifting = has_drift(study);
  if (depth == PlanningDepth::choice) {
    const PlanningCandidates::Rows rows =
        drifting ? rows_as_taken(model, result.readings).rows : rows_of(result.plan.chosen);
    result.with_prior = uncertainty_with_prior(model, rows, predictions);
    return result;
  }
  if (!drifting) try_at_random(*space, predictions, study, job, result);

  const bool stands_anywhere = may_stand_anywhere(model);
  options.progress = [&stop](double) { stop_if_asked(stop); };
  for (int round = 0; round < kRefinements && stands_anywhere; ++round) {
    std::vector<PosesAt> tried;
    for (const std::size_t condition : conditions) {
      const std::uint64_t seed = study.seed * 31 + static_cast<std::uint64_t>(round) + kSeedOfCondition * condition;
      tried.push_back({poses_around(plan, result.readings, condition, seed), condition});
      if (tried.back().poses.count() == 0) tried.pop_back();
    }
    PlanningModel::Candidates around = model.readings_at(tried);
    add_reading_costs(study, around);
    auto space_around = std::make_unique<const PlanningSpace>(around.rows, model.known(), job.in_step, study.threads);
    if (space_around->dimension() != space->dimension()) break;
    std::map<CandidateReading, std::size_t> places;
    for (std::size_t i = 0; i < around.readings.size(); ++i) places[around.readings[i]] = i;
    PlanningOptions refined = options;
    refined.count = result.plan.chosen.size();
    groups.limit(around, refined);
    for (const CandidateReading& reading : result.readings) refined.start.push_back(places.at(reading));
    const ReadingPlan better = plan_readings(*space_around, refined);
    if (better.status != PlanningStatus::done) break;
    const StudyPlan before = result;
    take(better, around);
    if ((plan.time > 0 && result.time > plan.time) || !ConditionGroups::fit(model, result.readings)) {
      result = before;
      break;
    }
    candidates = std::move(around);
    space = std::move(space_around);
    result.refinements = round + 1;
    progress(0.6 + 0.2 * (round + 1) / kRefinements);
  }
  TimedCandidates timed;
  if (drifting) {
    timed = choose_in_time(setting, *space, options, result, stop);
    if (result.plan.status != PlanningStatus::done) return result;
  } else {
    result.uncertainty = root_mean_square(predicted(result.plan), predictions);
    result.with_prior = uncertainty_with_prior(model, rows_of(result.plan.chosen), predictions);
  }

  if (!ConditionGroups::fit(model, result.readings)) {
    throw InputError({.field = "plan.course"}, "the readings do not end within their parts of the course",
                     "fewer readings, or longer parts");
  }
  judge_over_states(model, *space, predictions, result);
  if (result.plan.status != PlanningStatus::done) return result;

  PlanningOptions curve_options = options;
  groups.limit(candidates, curve_options);
  curve_options.most_passes = 2;
  curve_options.time_s = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> counts;
  for (const double share : kShares) {
    const auto number = static_cast<std::size_t>(share * static_cast<double>(result.readings.size()));
    if (number >= 1 && number <= space->count() && (counts.empty() || number > counts.back())) counts.push_back(number);
  }
  if (drifting) add_choices_in_time(setting, *space, timed, curve_options, counts, result, stop);
  const std::vector<ReadingPlan> curve =
      drifting ? std::vector<ReadingPlan>() : plan_curve(*space, curve_options, counts);
  for (std::size_t k = 0; k < curve.size(); ++k) {
    PlanPoint point{counts[k], curve[k].status == PlanningStatus::done, 0, 0};
    if (point.determined) point.with_prior = uncertainty_with_prior(model, rows_of(curve[k].chosen), predictions);
    if (point.determined) point.uncertainty = root_mean_square(predicted(curve[k]), predictions);
    result.curve.push_back(point);
  }
  say_what_is_enough(plan, result);
  progress(0.85);
  if (model.sights_stand_anywhere() && !model.has_given_readings() && !model.states().any()) {
    compare_with_grids(model, *space, predictions, result, job);
  }
  if (model.sights_stand_anywhere() && !model.has_given_readings() && model.states().any()) {
    compare_with_plain_states(model, *space, predictions, result, job);
  }
  result.not_identified = find_not_in_model(study, model.errors());
  progress(1);
  return result;
}

/// The study with some of its set-ups, and what is known of costs of these.
Study with_setups(const Study& study, std::size_t subset) {
  Study part = study;
  part.setups.clear();
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    if ((subset >> s & 1) != 0) part.setups.push_back(study.setups[s]);
  }
  std::erase_if(part.planning->setups, [&](const PlannedSetup& cost) {
    return std::none_of(part.setups.begin(), part.setups.end(),
                        [&](const Setup& setup) { return setup.name == cost.name; });
  });
  return part;
}

/// Of everything on which the best plans of combinations depend: costs, and the rows of some candidates.
std::uint64_t fingerprint_of_choice(const Study& study, const ConditionsOfANumber& conditions) {
  const PlanningStudy& plan = *study.planning;
  const PlanningSetting setting =
      planning_setting(study, conditions.conditions, static_cast<std::size_t>(plan.candidates));
  Digest digest;
  digest.add_text(vector_instructions());
  digest.add(study.seed);
  digest.add(static_cast<std::uint64_t>(plan.readings));
  digest.add(static_cast<std::uint64_t>(plan.goal));
  for (const double value : {plan.time, plan.reading, plan.settle}) digest.add_number(value);
  for (const Setup& setup : study.setups) {
    for (const double value : {plan.set_up_of(setup.name), plan.settle_of(setup.name), plan.reading_of(setup.name)}) {
      digest.add_number(value);
    }
  }
  digest.add_number(measuring_time(study, setting.model->states(), setting.candidates.readings));
  for (const std::size_t condition : conditions.conditions) digest.add(condition);
  const auto& rows = setting.candidates.rows.rows;
  digest.add_numbers({rows.data(), static_cast<std::size_t>(rows.size())});
  digest.add_numbers({setting.predictions.data(), static_cast<std::size_t>(setting.predictions.size())});
  return digest.value();
}

/// Which instruments are worth setting up: every combination of them is planned, and the one counts whose predicted
/// uncertainty, with the weak prior for what it does not see, is smallest.
std::vector<SetupChoice> try_combinations(const Study& study, const ConditionsOfANumber& conditions,
                                          const ShareCallback& progress, const JobOptions& job) {
  std::vector<SetupChoice> choices;
  const std::size_t combinations = (std::size_t{1} << study.setups.size()) - 1;
  std::size_t done = 0;
  NumberedItems items{.name = "combinations of set-ups", .count = combinations, .threads = study.threads};
  // Each has all threads.
  items.in_parallel = false;
  items.fingerprint = [&] { return fingerprint_of_choice(study, conditions); };
  items.compute = [&](std::size_t item) -> ItemResult {
    const Study part = with_setups(study, item + 1);
    double set_up = 0;
    for (const Setup& setup : part.setups) set_up += part.planning->set_up_of(setup.name);
    ItemResult result;
    if (set_up < part.planning->time) {
      const auto within = [&job](double) { stop_if_asked(job.stop); };
      const StudyPlan plan = plan_all_setups(part, PlanningDepth::choice, conditions, within, {.stop = job.stop});
      result.numbers = {plan.plan.status == PlanningStatus::done ? 1.0 : 0.0, static_cast<double>(plan.readings.size()),
                        plan.time, plan.with_prior};
    }
    progress(0.5 * static_cast<double>(++done) / static_cast<double>(combinations));
    return result;
  };
  const std::vector<ItemResult> results = results_of_items(job.work, items);
  for (std::size_t subset = 1; subset <= combinations; ++subset) {
    SetupChoice choice{subset, {}, 0, 0, 0, false};
    for (const Setup& setup : with_setups(study, subset).setups) choice.setups.push_back(setup.name);
    const std::vector<double>& found = results[subset - 1].numbers;
    if (!found.empty()) {
      choice.possible = found[0] != 0;
      choice.readings = static_cast<std::size_t>(found[1]);
      choice.time = found[2];
      choice.with_prior = found[3];
    }
    choices.push_back(std::move(choice));
  }
  return choices;
}

/// Whether errors with states are to be identified, or the plan has values for them.
bool names_states(const Study& study) {
  if (!study.identification) return false;
  const IdentificationPlan& plan = *study.identification;
  const auto has_state = [](const auto& one) { return one.state != kNoState; };
  return std::any_of(plan.motions.begin(), plan.motions.end(), has_state) ||
         std::any_of(plan.locations.begin(), plan.locations.end(), has_state) || !study.planning->states.empty() ||
         study.planning->course;
}

/// At which conditions the readings are to be taken; where errors have states, by trying.
std::vector<ConditionsOfANumber> conditions_to_take(const Study& study, const JobOptions& job) {
  const std::size_t count = PlanningModel(study).states().conditions().size();
  std::vector<std::size_t> all(count);
  for (std::size_t c = 0; c < count; ++c) all[c] = c;
  const auto poses = static_cast<std::size_t>(study.planning->candidates);
  const PlanningSetting setting = planning_setting(study, all, std::min(poses, kPosesToCompare));
  return choose_conditions({*setting.model, setting.candidates, setting.predictions}, job);
}

}  // namespace

StudyPlan plan_study(const Study& study, const JobOptions& options) {
  const ShareCallback progress = [report = stoppable_progress(options)](double share) {
    constexpr std::size_t kParts = 1000;
    report(static_cast<std::size_t>(kParts * share), kParts);
  };
  if (!study.planning) throw InputError({.field = "plan"}, "there is nothing to plan", "a table [plan]");
  check_costs(study);
  const bool set_up_costs = std::any_of(study.planning->setups.begin(), study.planning->setups.end(),
                                        [](const PlannedSetup& setup) { return setup.set_up > 0; });
  const std::size_t setups = study.setups.size();
  std::vector<ConditionsOfANumber> curve;
  ConditionsOfANumber conditions;
  conditions.conditions = {0};
  if (names_states(study)) {
    progress(0);
    curve = conditions_to_take(study, options);
    for (const ConditionsOfANumber& one : curve) {
      if (one.chosen || &one == &curve.back()) conditions = one;
      if (one.chosen) break;
    }
  }
  if (!set_up_costs || study.planning->time <= 0 || setups < 2 || setups > kMostTogether) {
    StudyPlan plan = plan_all_setups(study, PlanningDepth::whole, conditions, progress, options);
    plan.condition_curve = std::move(curve);
    return plan;
  }
  std::vector<SetupChoice> choices = try_combinations(study, conditions, progress, options);
  const auto worse = [](const SetupChoice& a, const SetupChoice& b) {
    return a.possible != b.possible ? b.possible : a.with_prior > b.with_prior;
  };
  const SetupChoice& best = *std::max_element(choices.begin(), choices.end(), worse);
  std::vector<std::size_t> kept;
  for (std::size_t s = 0; s < setups; ++s) {
    if ((best.subset >> s & 1) != 0) kept.push_back(s);
  }
  const auto rest = [&](double share) { progress(0.5 + 0.5 * share); };
  StudyPlan plan = plan_all_setups(with_setups(study, best.subset), PlanningDepth::whole, conditions, rest, options);
  plan.condition_curve = std::move(curve);
  for (CandidateReading& reading : plan.readings) reading.setup = kept[reading.setup];
  plan.combinations = std::move(choices);
  return plan;
}

}  // namespace abbe
