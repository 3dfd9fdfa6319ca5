#pragma once

// For plans of readings: candidates, and where their errors are predicted.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// Seeds of the poses under different conditions lie so far apart.
inline constexpr std::uint64_t kSeedOfCondition = 1009;

/// Candidates at some conditions, and what is to be predicted from them.
struct PlanningSetting {
  std::unique_ptr<const PlanningModel> model;
  PlanningModel::Candidates candidates;
  Eigen::MatrixXd predictions;
};

/// @param count  poses at random, shared out among the conditions
/// @throws InputError where nothing can be read
PlanningSetting planning_setting(const Study& study, const std::vector<std::size_t>& conditions, std::size_t count);

/// Poses from which readings under a condition may be chosen: as many at random, or the grid of the plan.
PoseList poses_under(const Study& study, std::size_t condition, std::size_t count);

/// The poses of readings, and beside each some in which one or two axes stand elsewhere (coordinate exchange; Meyer and
/// Nachtsheim, Technometrics 37 (1995) 60): at an end, in the middle, or anywhere.
PoseList poses_around(const PlanningStudy& plan, const std::vector<CandidateReading>& readings, std::size_t condition,
                      std::uint64_t seed);

/// Whether poses beside those of the candidates may be tried: they are no grid and have no steps.
bool may_stand_anywhere(const PlanningModel& model);

/// What every candidate costs, s, without the way to it; where some cost something else than others.
void add_reading_costs(const Study& study, PlanningModel::Candidates& candidates);

}  // namespace abbe
