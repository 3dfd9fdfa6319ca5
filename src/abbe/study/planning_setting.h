#pragma once

// For plans of readings: candidates, and where their errors are predicted.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "abbe/study/planning.h"

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

}  // namespace abbe
