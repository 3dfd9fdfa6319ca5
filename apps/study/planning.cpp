#include "study/planning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "abbe/formats/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kPredictionPoses = 200;
constexpr double kShares[] = {0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6, 2};
constexpr int kTimeRounds = 6;

double move_time(const PlanningStudy& plan, const std::vector<double>& from, const std::vector<double>& to) {
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]) / plan.speed[i]);
  return longest;
}

/// Same readings, poses in an order of short travel; all readings of one pose together.
std::vector<SightReading> by_travel(const Machine& machine, const std::vector<SightReading>& readings) {
  std::map<std::vector<double>, std::vector<SightReading>> at;
  PoseList poses;
  for (const SightReading& reading : readings) {
    std::vector<SightReading>& here = at[reading.pose];
    if (here.empty()) poses.append(reading.pose);
    here.push_back(reading);
  }
  const PoseList ordered = order_by_travel(machine, poses);
  std::vector<SightReading> result;
  for (std::size_t k = 0; k < ordered.count(); ++k)
    for (const SightReading& reading : at[ordered.pose(k)]) result.push_back(reading);
  return result;
}

double total_time(const PlanningStudy& plan, const std::vector<SightReading>& readings) {
  double time = 0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    time += plan.reading;
    if (k > 0 && readings[k].pose == readings[k - 1].pose) continue;
    time += plan.settle + (k > 0 ? move_time(plan, readings[k - 1].pose, readings[k].pose) : 0);
  }
  return time;
}

double root_mean_square(const PlanValue& value, const Eigen::MatrixXd& predictions) {
  return std::sqrt(value.variance / (static_cast<double>(predictions.rows()) / 3));
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

}  // namespace

StudyPlan plan_study(const Study& study, const std::function<void(double)>& progress) {
  const PlanningModel model(study);
  const PlanningStudy& plan = *study.planning;
  const PoseList poses =
      plan.grid ? grid_plan(study.machine, plan.axes)
                : random_plan(study.machine, plan.axes, static_cast<std::size_t>(plan.candidates), study.seed);
  const PlanningModel::Candidates candidates = model.readings_at(poses, SightsPerPose::every);
  StudyPlan result;
  result.candidates = candidates.readings.size();
  result.hidden = candidates.hidden;
  result.forbidden = candidates.forbidden;
  if (result.candidates == 0) {
    throw InputError({.field = "plan"}, "no candidate has a line of sight outside the forbidden boxes",
                     "other stations, reflectors, ranges or boxes");
  }
  const PlanningSpace space(candidates.rows, model.known());
  result.parameters = space.parameter_count();
  result.seen = space.dimension();
  const Eigen::MatrixXd predictions =
      model.prediction_rows(random_plan(study.machine, plan.axes, kPredictionPoses, study.seed * 7919 + 1));
  const Eigen::VectorXd unseen = space.unseen_part(predictions);
  // Rows that are zero but for rounding have no direction.
  const Eigen::VectorXd sizes = space.functionals(predictions).rowwise().norm();
  for (Eigen::Index i = 0; i < unseen.size(); ++i)
    if (sizes[i] > 1e-9 * sizes.maxCoeff()) result.unseen_part = std::max(result.unseen_part, unseen[i]);

  PlanningOptions options;
  options.threads = study.threads;
  options.seed = study.seed;
  if (plan.goal != PlanningGoal::determinant) {
    options.criterion = PlanningCriterion::variance;
    options.functionals = plan.goal == PlanningGoal::volumetric ? predictions : model.parameter_rows();
  }
  if (progress) options.progress = [&](double share) { progress(0.6 * share); };

  const double quickest = plan.reading + plan.settle / static_cast<double>(model.sight_count());
  std::size_t count = plan.readings > 0 ? static_cast<std::size_t>(plan.readings) : result.candidates;
  if (plan.time > 0 && quickest > 0)
    count = std::min(count, static_cast<std::size_t>(std::max(1.0, plan.time / quickest)));
  for (int round = 0; round < kTimeRounds; ++round) {
    options.count = std::min(count, result.candidates);
    result.plan = plan_readings(space, options);
    result.readings.clear();
    for (const std::size_t chosen : result.plan.chosen) result.readings.push_back(candidates.readings[chosen]);
    result.readings = by_travel(study.machine, result.readings);
    result.time = total_time(plan, result.readings);
    if (result.plan.status != PlanningStatus::done || plan.time <= 0 || result.time <= plan.time) break;
    count =
        static_cast<std::size_t>(std::max(1.0, 0.99 * static_cast<double>(options.count) * plan.time / result.time));
  }
  if (result.plan.status != PlanningStatus::done) return result;
  result.uncertainty = root_mean_square(value_of(space, result.plan.chosen, predictions), predictions);

  PlanningOptions curve_options = options;
  curve_options.progress = nullptr;
  curve_options.most_passes = 2;
  std::vector<std::size_t> counts;
  for (const double share : kShares) {
    const auto number = static_cast<std::size_t>(share * static_cast<double>(result.readings.size()));
    if (number >= 1 && number <= result.candidates && (counts.empty() || number > counts.back()))
      counts.push_back(number);
  }
  const std::vector<ReadingPlan> curve = plan_curve(space, curve_options, counts);
  for (std::size_t k = 0; k < curve.size(); ++k) {
    PlanPoint point{counts[k], curve[k].status == PlanningStatus::done, 0};
    if (point.determined)
      point.uncertainty = root_mean_square(value_of(space, curve[k].chosen, predictions), predictions);
    result.curve.push_back(point);
  }
  say_what_is_enough(plan, result);
  if (progress) progress(0.8);
  compare_with_grids(model, space, predictions, result);
  if (progress) progress(1);
  return result;
}

}  // namespace abbe
