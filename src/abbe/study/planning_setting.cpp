#include "abbe/study/planning_setting.h"

#include <algorithm>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/study/campaign.h"
#include "abbe/study/model.h"
#include "abbe/study/planning_schedule.h"
#include "abbe/study/random_poses.h"

namespace abbe {
namespace {

constexpr std::size_t kPredictionPoses = 200;
constexpr std::size_t kPosesPerState = 8;      // and not fewer than these
constexpr std::size_t kPosesOfCondition = 40;  // under each condition
constexpr double kWholeTurn = 2 * std::numbers::pi * 0.99;
constexpr double kAtAnEnd = 0.4;

/// Random poses over the ranges. The best places of polynomials are the ends and the middle of a range, which random
/// positions of five axes never meet together: in every second pose each axis with two ends stands at one of these.
PoseList candidate_poses(const Machine& machine, const PlanningStudy& plan, std::size_t count, std::uint64_t seed) {
  PoseList poses = random_plan(machine, plan.axes, count, seed);
  for (std::size_t k = 1; k < poses.count(); k += 2) {
    RandomStream random(seed + 1, k);
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      const AxisRange& range = plan.axes[i];
      const double share = random.uniform();
      const bool turn = machine.axes[i].kind == AxisKind::rotary && range.to - range.from > kWholeTurn;
      if (turn || range.step > 0) continue;
      poses.axis[i][k] = share < kAtAnEnd ? range.from : share < 2 * kAtAnEnd ? range.to : (range.from + range.to) / 2;
    }
  }
  return poses;
}

/// The errors to be identified, of zero, over the ranges that an identification from all candidates would state.
/// @throws InputError if an axis with error motions stands still in all of them
ErrorSet measurable_errors(const Study& study, const PlanningModel::Candidates& candidates) {
  Campaign campaign;
  for (const InstrumentReadings& readings : candidates.of_setup) campaign.setups.emplace_back().readings = readings;
  StudyModel model;
  ErrorSet errors = model_errors(study, campaign, model);
  if (!model.impossible.empty()) {
    throw InputError({.field = "plan"}, model.impossible, "plans of the set-ups in which it moves");
  }
  errors.set_parameters(std::vector<double>(errors.parameter_count(), 0.0));
  return errors;
}

/// Candidates of the plan, shared out among the conditions.
std::vector<PosesAt> poses_to_try(const Study& study, const std::vector<std::size_t>& conditions, std::size_t count) {
  const PlanningStudy& plan = *study.planning;
  std::vector<PosesAt> tried;
  const std::size_t each = conditions.size() == 1 ? count : std::max(kPosesOfCondition, count / conditions.size());
  for (const std::size_t condition : conditions) {
    tried.push_back({plan.grid ? grid_plan(study.machine, plan.axes)
                               : candidate_poses(study.machine, plan, each, study.seed + kSeedOfCondition * condition),
                     condition});
  }
  return tried;
}

/// Poses at which errors are predicted, at all states at which they will be used in turn.
PoseList poses_of_use(const Study& study, const PlannedStates& states, const std::vector<AxisRange>& ranges) {
  const std::vector<std::vector<double>>& used = states.used_at();
  const std::size_t count = std::max(kPredictionPoses, kPosesPerState * used.size());
  PoseList poses = random_plan(study.machine, ranges, count, study.seed * 7919 + 1);
  std::vector<std::vector<double>> at;
  for (std::size_t k = 0; k < count; ++k) at.push_back(used[k % used.size()]);
  give_states(at, poses);
  return poses;
}

}  // namespace

PlanningSetting planning_setting(const Study& study, const std::vector<std::size_t>& conditions, std::size_t count) {
  PlanningSetting setting;
  setting.model = std::make_unique<const PlanningModel>(study);
  const std::vector<PosesAt> poses = poses_to_try(study, conditions, count);
  setting.candidates = setting.model->readings_at(poses);
  std::vector<AxisRange> predicted = study.planning->axes;
  // Trackers are planned for the ranges of the plan, which they can all see. What other instruments see decides where
  // errors can be known at all.
  if (!sees_points_only(study) && !setting.candidates.readings.empty()) {
    const ErrorSet errors = measurable_errors(study, setting.candidates);
    setting.model = std::make_unique<const PlanningModel>(study, &errors);
    setting.candidates = setting.model->readings_at(poses);
    predicted = unseen_ranges(study.machine, {&errors});
  }
  if (setting.candidates.readings.empty()) {
    throw InputError({.field = "plan"}, "no candidate has a line of sight outside the forbidden boxes",
                     "other stations, reflectors, ranges or boxes");
  }
  setting.predictions = setting.model->prediction_rows(poses_of_use(study, setting.model->states(), predicted));
  return setting;
}

}  // namespace abbe
