#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/plan/readings/planning.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

PlanningCandidates twelve_candidates() {
  PlanningCandidates candidates;
  candidates.rows.resize(12, 3);
  RandomStream random(5);
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < 3; ++j) candidates.rows(i, j) = random.normal();
  for (std::size_t i = 0; i <= 12; ++i) candidates.first_row.push_back(i);
  return candidates;
}

TEST(PlanReadings, TakesNoMoreOfAGroupThanThereIsRoomForAndTheBestOfThese) {
  const PlanningCandidates candidates = twelve_candidates();
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  PlanningOptions options;
  options.count = 5;
  options.starts = 40;
  options.pass_gain = 0;
  for (std::uint32_t i = 0; i < 12; ++i) options.group.push_back(i % 3);
  options.most_of_group = {1, 3, 1};
  const ReadingPlan plan = plan_readings(space, options);
  ASSERT_EQ(plan.status, PlanningStatus::done);
  ASSERT_EQ(plan.chosen.size(), 5U);
  // All subsets of five that have room.
  double best = std::numeric_limits<double>::infinity();
  for (unsigned subset = 0; subset < 1U << 12; ++subset) {
    std::vector<std::size_t> chosen, left = options.most_of_group;
    bool room = true;
    for (std::size_t i = 0; i < 12; ++i) {
      if ((subset >> i & 1U) == 0) continue;
      chosen.push_back(i);
      room = room && left[options.group[i]]-- > 0;
    }
    if (!room || chosen.size() != 5) continue;
    Eigen::MatrixXd rows(5, 3);
    for (std::size_t k = 0; k < 5; ++k)
      rows.row(static_cast<Index>(k)) = candidates.rows.row(static_cast<Index>(chosen[k]));
    best = std::min(best, -std::log((rows.transpose() * rows).determinant()));
  }
  Eigen::MatrixXd rows(5, 3);
  std::vector<std::size_t> of_group(3, 0);
  for (std::size_t k = 0; k < 5; ++k) {
    rows.row(static_cast<Index>(k)) = candidates.rows.row(static_cast<Index>(plan.chosen[k]));
    ++of_group[options.group[plan.chosen[k]]];
  }
  EXPECT_EQ(of_group, options.most_of_group);
  EXPECT_NEAR(-std::log((rows.transpose() * rows).determinant()), best, 1e-9);
  options.group.pop_back();
  EXPECT_THROW(plan_readings(space, options), std::invalid_argument);
  options.group.push_back(3);
  EXPECT_THROW(plan_readings(space, options), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
