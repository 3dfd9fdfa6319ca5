// Other choices beside a plan while set-ups drift, and what the plan says about the drift.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/errors/random_stream.h"
#include "abbe/study/planning/planning_conditions.h"
#include "abbe/study/planning/planning_drift.h"
#include "abbe/study/planning/planning_schedule.h"

namespace abbe {
namespace {

constexpr std::size_t kDrawsInTime = 9;

std::vector<CandidateReading> ordered_choice(const PlanningModel& model, const TimedCandidates& timed,
                                             const std::vector<std::size_t>& chosen) {
  std::vector<CandidateReading> readings;
  for (const std::size_t i : chosen) readings.push_back(timed.candidates.readings[i]);
  return scheduled_readings(model.study(), model.states(), readings);
}

/// As many candidates as the plan has, without any choice.
void draw_in_time(const PlanningModel& model, const PlanningSpace& space, const TimedCandidates& timed,
                  const Eigen::MatrixXd& predictions, StudyPlan& result, const std::stop_token& stop) {
  std::vector<double> found;
  const std::size_t count = timed.candidates.readings.size(), wanted = std::min(count, result.readings.size());
  for (std::size_t draw = 0; draw < kDrawsInTime; ++draw) {
    stop_if_asked(stop);
    RandomStream random(model.study().seed + 2, draw);
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = i;
    for (std::size_t k = 0; k < wanted; ++k) {
      const auto step = static_cast<std::size_t>(random.uniform() * static_cast<double>(count - k));
      std::swap(order[k], order[k + std::min(count - k - 1, step)]);
    }
    order.resize(wanted);
    const auto point = point_as_taken(model, space, predictions, ordered_choice(model, timed, order));
    if (point) found.push_back(point->uncertainty);
  }
  result.random_tried = kDrawsInTime;
  if (found.size() < (kDrawsInTime + 1) / 2) return;
  std::sort(found.begin(), found.end());
  result.random_poses = PlanPoint{wanted, true, found[found.size() / 2], 0};
}

}  // namespace

void add_choices_in_time(const PlanningSetting& setting, const PlanningSpace& space, const TimedCandidates& timed,
                         const PlanningOptions& options, std::span<const std::size_t> counts, StudyPlan& result,
                         const std::stop_token& stop) {
  const PlanningModel& model = *setting.model;
  draw_in_time(model, space, timed, setting.predictions, result, stop);
  PlanningOptions own = options;
  own.group.clear();
  own.most_of_group.clear();
  own.start.clear();
  if (own.criterion == PlanningCriterion::variance) {
    own.functionals = with_drifts(options.functionals, model, *timed.model);
  }
  const std::vector<ReadingPlan> curve = plan_curve(*timed.space, own, counts);
  for (std::size_t k = 0; k < curve.size(); ++k) {
    PlanPoint point{counts[k], false, 0, 0};
    if (curve[k].status == PlanningStatus::done) {
      const std::vector<CandidateReading> readings = ordered_choice(model, timed, curve[k].chosen);
      if (!ConditionGroups::fit(model, readings)) continue;  // the course has no time for them
      point = point_as_taken(model, space, setting.predictions, readings).value_or(point);
    }
    result.curve.push_back(point);
  }
}

std::string planned_drift_text(const StudyPlan& result) {
  const PlanBesideDrift& drift = result.drift;
  if (drift.setups.empty()) return "";
  std::string text = "\nbeside the drift of set-ups, which is found from the same readings\n";
  for (const std::string& setup : drift.setups) text += "  " + setup + "\n";
  if (!drift.determined) {
    return text +
           "  these readings do not separate it from the errors: take more of them, over a longer time or at more "
           "poses, or let less drift\n";
  }
  text += fmt::format("  {:.3f} um; {:.3f} um if nothing drifted\n", 1e3 * result.uncertainty, 1e3 * drift.still);
  text += fmt::format("  {} poses in {} parts of the measurement; {} are revisited later, {} visits at most\n",
                      drift.poses, drift.parts, drift.returned_to, drift.most_visits);
  return text;
}

nlohmann::ordered_json planned_drift_json(const StudyPlan& result) {
  const PlanBesideDrift& drift = result.drift;
  nlohmann::ordered_json json = {{"setups", drift.setups}, {"determined", drift.determined}};
  if (!drift.determined) return json;
  json["uncertainty_if_nothing_drifted_um"] = 1e3 * drift.still;
  json["parts"] = drift.parts;
  json["poses"] = drift.poses;
  json["poses_returned_to"] = drift.returned_to;
  json["most_visits_of_a_pose"] = drift.most_visits;
  return json;
}

}  // namespace abbe
