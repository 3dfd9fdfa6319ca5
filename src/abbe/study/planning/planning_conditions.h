#pragma once

// For plans of readings of errors with states: at which conditions, and what that is worth over the states.
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// What is needed to judge conditions: candidates at all of them.
struct ConditionsToJudge {
  const PlanningModel& model;
  const PlanningModel::Candidates& candidates;
  const Eigen::MatrixXd& predictions;
};

/// About the time of one reading with its way, s.
/// @param together  at a pose at which everything is read that can be; else each at a pose of its own
double time_of_reading(const PlanningModel& model, bool together);

/// How many readings a time has room for after the changes between conditions and the set-ups; 0: none.
std::size_t readings_within(const PlanningModel& model, const std::vector<std::size_t>& conditions);

/// The best conditions of every number, from one on, and which of them the plan takes: the smallest number that leaves
/// no more open than all conditions do and is within 2 % of the best.
std::vector<ConditionsOfANumber> choose_conditions(const ConditionsToJudge& judged, const JobOptions& job);

/// Groups by conditions: in a course no more readings than there is time for.
struct ConditionGroups {
  std::vector<std::size_t> room;  ///< [conditions] readings; empty: no limits

  explicit ConditionGroups(const PlanningModel& model);
  void limit(const PlanningModel::Candidates& candidates, PlanningOptions& options) const;
  /// Less room where readings do not end with their part of the course. @return false if all do
  bool shrink(const PlanningModel& model, const std::vector<CandidateReading>& readings);
  /// Whether all readings end within their parts of the course.
  static bool fit(const PlanningModel& model, const std::vector<CandidateReading>& readings);
};

/// States of the readings at their times, the uncertainty over the states at which errors will be used, and the sensors
/// that matter. Puts the uncertainty at the real states in the place of that at the conditions.
void judge_over_states(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
                       StudyPlan& result);

}  // namespace abbe
