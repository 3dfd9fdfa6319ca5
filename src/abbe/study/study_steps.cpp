#include "abbe/study/study_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/error_states.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/study/identification/identified_expansions.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/identification/state_ranges.h"
#include "abbe/study/identification/streamed_identification.h"
#include "abbe/study/report/coverage.h"
#include "abbe/verify/known_range.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {
namespace {

/// The study without the terms that were not taken.
Study with_chosen_terms(const Study& study, const StudyResult& result) {
  Study chosen = study;
  if (result.terms) chosen.identification = result.terms->plan;
  return chosen;
}

/// Whether all errors with the state of a column are expansions of which something is known beforehand.
bool is_known_beforehand(const Study& study, const StudyResult& result, const std::string& column) {
  const IdentificationPlan& plan = result.terms ? result.terms->plan : *study.identification;
  for (std::size_t j = 0; j < study.machine.states.size(); ++j) {
    if (state_column(study.machine.states[j]) == column) return has_known_expansions_only(plan, j);
  }
  return false;
}

}  // namespace

IdentifyOptions identify_options(const Study& study) {
  const IdentificationPlan& plan = *study.identification;
  IdentifyOptions options;
  options.solver.max_iterations = plan.max_iterations;
  options.solver.relative_cost = plan.tolerance;
  options.solver.threads = study.threads;
  options.loss = plan.loss;
  options.loss_tuning = plan.loss_scale;
  return options;
}

void prepare_study(const Study& study, StudyResult& result) {
  find_start_values(study.machine, result.campaign);
  result.model = build_model(study, result.campaign);
  if (study.identification->rank_sensors && result.model.impossible.empty()) {
    result.sensors = rank_sensors(study, result.campaign, result.model.problem, identify_options(study));
  }
  if (!study.identification->select_terms || !result.model.impossible.empty()) return;
  result.terms = choose_terms(study, result.campaign, result.model.problem, identify_options(study));
  result.model = build_model(with_chosen_terms(study, result), result.campaign);
}

Problem prepared_problem(const Study& study) {
  StudyResult result;
  result.campaign = gather_readings(study);
  prepare_study(study, result);
  return result.model.problem;
}

void identify_study(const Study& study, StudyResult& result, const IdentificationJob& job) {
  prepare_study(study, result);
  result.warnings = result.campaign.warnings;
  if (!result.model.impossible.empty()) {
    result.identification.status = IdentifyStatus::rank_deficient;
    result.identification.message = result.model.impossible;
    return;
  }
  const IdentificationPlan& plan = *study.identification;
  Problem& problem = result.model.problem;
  IdentifyOptions options = identify_options(study);
  options.solver.stop = job.stop;
  if (!result.model.order_groups.empty()) {
    OrderSelectionOptions selection;
    selection.seed = study.seed;
    selection.identify = options;
    result.order_selection = select_model(with_chosen_terms(study, result), result.campaign, selection, result.model);
    if (!result.order_selection->done) {
      result.warnings.push_back(
          "orders: no model of the range could be identified with poses held out; the largest orders are used");
    }
  }
  options.solver.summation = job.summation;
  const VarianceComponentChoice variances{.variance_factor = plan.estimate_variance_factor,
                                          .pose_noise = plan.estimate_pose_noise || plan.estimate_block_noise,
                                          .by_block = plan.estimate_block_noise};
  result.walks = walks_to_estimate(result.campaign, problem);
  if (is_streamed(result.campaign)) {
    identify_streamed(study, options, job, result);
  } else if (!result.walks.empty()) {
    result.identification = identify_with_walks(problem, result.walks, options);
  } else if (variances.any()) {
    result.weighed = identify_with_variances(problem, variances, options);
    result.identification = std::move(result.weighed->identification);
  } else {
    StagedIdentification staged = identify_in_stages(problem, plan.strategy, options);
    result.stages = std::move(staged.stages);
    result.identification = std::move(staged.total);
  }
  // What a convention fixes is listed with the gauge; what had to be fixed without one is a warning.
  for (const GaugeConstraint& constraint : result.identification.gauge.constraints) {
    if (!constraint.by_convention) result.warnings.push_back(constraint.words + ": " + constraint.inseparable_words);
  }
  if (job.advice && result.identification.estimates.size() > 0) {
    result.advice = unseen_advice(problem, result.identification, possible_measurements(problem));
  }
  if (!result.usable()) return;
  if (plan.monte_carlo > 0) {
    MonteCarloOptions monte_carlo_options;
    monte_carlo_options.samples = static_cast<std::size_t>(plan.monte_carlo);
    monte_carlo_options.seed = study.seed;
    monte_carlo_options.threads = study.threads;
    monte_carlo_options.stop = job.stop;
    monte_carlo_options.work = job.work;
    monte_carlo_options.loss = options.loss;
    monte_carlo_options.loss_tuning = options.loss_tuning;
    result.monte_carlo =
        monte_carlo(result.weighed ? result.weighed->problem : problem, result.identification, monte_carlo_options);
    if (result.monte_carlo->not_settled > 0) {
      result.warnings.push_back(fmt::format("Monte Carlo: {} of {} robust fits had not settled",
                                            result.monte_carlo->not_settled, result.monte_carlo->samples));
    }
  }
  const std::string references = reference_words(study.machine, result.identification.errors);
  if (!references.empty()) {
    result.warnings.push_back(
        "some errors depend on states; figures and maps are those at the references of the states: " + references +
        " (map poses of a file: at the states that it gives)");
  }
  for (const CoveredState& state : covered_states(study, result)) {
    if (state.to - state.from > 1e-9 * (1 + std::abs(state.to))) continue;
    if (is_known_beforehand(study, result, state.column)) continue;
    result.warnings.push_back(
        fmt::format("{} is {:.6g} at all readings: errors with this state cannot be told from those without it, and "
                    "how they are divided is a convention; readings at another value would show them",
                    state.column, state.to));
  }
  result.not_identified = find_not_identified(study, result, job.advice);
  result.volumetric = study_volumetric_figures(study, result);
  if (job.progress) job.progress(1, 1);
}

VolumetricFigures study_volumetric_figures(const Study& study, const StudyResult& result) {
  const ErrorSet& identified = result.identification.errors;
  const ErrorSet* const truth = result.campaign.truth ? &*result.campaign.truth : nullptr;
  std::vector<const ErrorSet*> known = {&identified};
  if (truth != nullptr) known.push_back(truth);
  StatedPoses poses = stated_grid(study.machine, known);
  stand_at_references(study.machine, poses.poses);
  return volumetric_figures(study.machine, &identified,
                            machine_covariance(result.identification, identified.parameter_count()), truth, poses,
                            study.threads);
}

StudyMap map_study(const Study& study, const StudyResult& result, const ProgressCallback& progress,
                   const WorkDriver& work) {
  const Machine& machine = study.machine;
  const ErrorSet& identified = result.identification.errors;
  StudyMap map;
  if (study.map && study.map->poses_file) {
    map.poses = read_poses(*study.map->poses_file, machine);
    map.description = fmt::format("{} poses of {}", map.poses.count(), study.map->poses_file->filename().string());
  } else {
    std::vector<AxisRange> ranges;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      if (!study.map) {
        ranges.push_back(known_range(machine, identified, i, machine.axes.size() > 3 ? 5 : 9));
        continue;
      }
      // Outside the measured range there is no result; a range entirely outside stays, and its poses are left out.
      AxisRange range = study.map->axes[i];
      if (!range.is_fixed() && narrow_to_known_range(machine, identified, i, range) && range.from < range.to) {
        map.moved.push_back(moved_range_sentence(machine.axes[i], study.map->axes[i], range));
        ranges.push_back(range);
      } else {
        ranges.push_back(study.map->axes[i]);
      }
    }
    StatedPoses stated = grid_over(machine, ranges);
    map.grid = std::move(stated.grid);
    map.poses = std::move(stated.poses);
    map.description = "grid of";
    for (std::size_t i = 0; i < map.grid.size(); ++i)
      map.description += fmt::format("{} {}", i == 0 ? "" : " x", map.grid[i]);
    map.description += map.moved.empty() ? " poses" : " poses over the range in which the errors are known";
  }
  stand_at_references(machine, map.poses);
  const PoseSource poses = pose_source(map.poses);
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  options.threads = study.threads;
  options.progress = progress;
  options.work = work;
  map.against_truth = result.campaign.truth.has_value();
  ParameterCovariance covariance;
  covariance.covariance = machine_covariance(result.identification, identified.parameter_count());
  for (std::size_t p = 0; p < identified.parameter_count(); ++p) covariance.parameters.push_back(p);
  ErrorMapOptions with_uncertainty = options;
  with_uncertainty.covariance = &covariance;
  map.predicted = error_map(machine, identified, nullptr, poses, with_uncertainty);
  if (map.against_truth) {
    map.before = error_map(machine, *result.campaign.truth, nullptr, poses, options);
    map.after = error_map(machine, *result.campaign.truth, &identified, poses, options);
  } else {
    map.before = map.predicted;
  }
  std::vector<ErrorMap*> maps = {&map.before, &map.predicted};
  if (map.after) maps.push_back(&*map.after);
  keep_common_poses(maps);
  return map;
}

}  // namespace abbe
