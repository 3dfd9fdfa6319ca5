#include "abbe/study/planning/planning_setting.h"

#include <algorithm>
#include <numbers>
#include <set>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/study/campaign.h"
#include "abbe/study/model.h"
#include "abbe/study/planning/planning_schedule.h"
#include "abbe/study/random_poses.h"

namespace abbe {
namespace {

constexpr std::size_t kPredictionPoses = 200;
constexpr std::size_t kPosesPerState = 8;      // and not fewer than these
constexpr std::size_t kPosesOfCondition = 40;  // under each condition
constexpr double kWholeTurn = 2 * std::numbers::pi * 0.99;
constexpr double kAtAnEnd = 0.4;
constexpr std::size_t kPosesAround = 6;
constexpr double kShortestReading_s = 1e-3;

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
  std::vector<PosesAt> tried;
  const std::size_t each = conditions.size() == 1 ? count : std::max(kPosesOfCondition, count / conditions.size());
  for (const std::size_t condition : conditions) {
    tried.push_back({poses_under(study, condition, each), condition});
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

PoseList poses_under(const Study& study, std::size_t condition, std::size_t count) {
  const PlanningStudy& plan = *study.planning;
  if (plan.grid) return grid_plan(study.machine, plan.axes);
  return candidate_poses(study.machine, plan, count, study.seed + kSeedOfCondition * condition);
}

PoseList poses_around(const PlanningStudy& plan, const std::vector<CandidateReading>& readings, std::size_t condition,
                      std::uint64_t seed) {
  PoseList poses;
  std::set<std::vector<double>> known;
  for (const CandidateReading& reading : readings)
    if (reading.condition == condition && known.insert(reading.pose).second) poses.append(reading.pose);
  const std::size_t given = poses.count();
  for (std::size_t k = 0; k < given; ++k)
    for (std::size_t n = 0; n < kPosesAround; ++n) {
      RandomStream random(seed, k * kPosesAround + n);
      std::vector<double> pose = poses.pose(k);
      for (std::size_t change = 0; change < 1 + n % 2; ++change) {
        const std::size_t i =
            std::min(pose.size() - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(pose.size())));
        const AxisRange& range = plan.axes[i];
        const double share = random.uniform(), anywhere = random.uniform(range.from, range.to);
        pose[i] = share < 0.25   ? range.from
                  : share < 0.5  ? range.to
                  : share < 0.65 ? (range.from + range.to) / 2
                                 : anywhere;
      }
      if (known.insert(pose).second) poses.append(pose);
    }
  return poses;
}

bool may_stand_anywhere(const PlanningModel& model) {
  const PlanningStudy& plan = *model.study().planning;
  return !plan.grid && model.sights_stand_anywhere() &&
         std::none_of(plan.axes.begin(), plan.axes.end(), [](const AxisRange& range) { return range.step > 0; });
}

void add_reading_costs(const Study& study, PlanningModel::Candidates& candidates) {
  const PlanningStudy& plan = *study.planning;
  if (plan.time <= 0 || plan.setups.empty()) return;
  for (const CandidateReading& reading : candidates.readings) {
    const std::string& setup = study.setups[reading.setup].name;
    candidates.rows.cost_s.push_back(std::max(kShortestReading_s, plan.settle_of(setup) + plan.reading_of(setup)));
  }
}

PlanningSetting planning_setting(const Study& study, const std::vector<std::size_t>& conditions, std::size_t count) {
  PlanningSetting setting;
  setting.model = std::make_unique<const PlanningModel>(study);
  const std::vector<PosesAt> poses = poses_to_try(study, conditions, count);
  const bool points_only = sees_points_only(study);
  setting.candidates = points_only ? setting.model->readings_at(poses) : setting.model->seen_at(poses);
  std::vector<AxisRange> predicted = study.planning->axes;
  // Trackers are planned for the ranges of the plan, which they can all see. What other instruments see decides where
  // errors can be known at all.
  if (!points_only && !setting.candidates.readings.empty()) {
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
