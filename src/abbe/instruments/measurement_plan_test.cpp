#include "abbe/instruments/measurement_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

const Machine& machine() {
  static const Machine aguado = test::aguado_case().machine;
  return aguado;
}

TEST(MeasurementPlan, GridHasEveryCombinationOnceAndMovesOneAxisByOneStep) {
  std::vector<AxisRange> ranges = full_ranges(machine(), 5);
  ranges[0].count = 4;
  ranges[2].count = 3;
  const PoseList plan = grid_plan(machine(), ranges);
  ASSERT_EQ(plan.count(), 60u);
  std::set<std::vector<long>> different;
  const double steps[] = {90 * kDegree, 350, 300};
  for (std::size_t k = 0; k < 60; ++k) {
    std::vector<long> indices;
    double moved = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      indices.push_back(std::lround(plan.axis[i][k] / steps[i]));
      if (k > 0) moved += std::abs(plan.axis[i][k] - plan.axis[i][k - 1]) / steps[i];
    }
    different.insert(indices);
    if (k > 0) {
      EXPECT_NEAR(moved, 1, 1e-9) << k;
    }
  }
  EXPECT_EQ(different.size(), 60u);
  EXPECT_NEAR(*std::max_element(plan.axis[0].begin(), plan.axis[0].end()), 270 * kDegree, 1e-12);
}

TEST(MeasurementPlan, RestrictedPlansHoldTheirAxes) {
  // Aguado et al., fig. 5: B) C fixed, C) X and Z fixed with C in steps of 5 degrees.
  std::vector<AxisRange> b = full_ranges(machine(), 7);
  b[0] = AxisRange::fixed(30 * kDegree);
  const PoseList plane = grid_plan(machine(), b);
  EXPECT_EQ(plane.count(), 49u);
  for (double c : plane.axis[0]) EXPECT_EQ(c, 30 * kDegree);
  std::vector<AxisRange> c = full_ranges(machine(), 72);
  c[1] = AxisRange::fixed(700);
  c[2] = AxisRange::fixed(100);
  const PoseList turn = grid_plan(machine(), c);
  EXPECT_EQ(turn.count(), 72u);
  EXPECT_NEAR(turn.axis[0][1], 5 * kDegree, 1e-12);
  EXPECT_EQ(turn.axis[1][71], 700);
  EXPECT_EQ(join(plane, turn).count(), 121u);
}

TEST(MeasurementPlan, RandomPosesFillTheRangeInWholeStepsAndDependOnSeedAndNumberOnly) {
  std::vector<AxisRange> ranges = full_ranges(machine(), 2);
  ranges[0].step = 5 * kDegree;
  const PoseList plan = random_plan(machine(), ranges, 4000, 3), longer = random_plan(machine(), ranges, 5000, 3);
  double mean = 0;
  for (std::size_t k = 0; k < 4000; ++k) {
    EXPECT_NEAR(std::remainder(plan.axis[0][k], 5 * kDegree), 0, 1e-12);
    EXPECT_EQ(plan.axis[1][k], longer.axis[1][k]);
    mean += plan.axis[1][k] / 4000;
  }
  EXPECT_NEAR(mean, 700, 4 * 1400 / std::sqrt(12.0 * 4000));
  EXPECT_NE(random_plan(machine(), ranges, 10, 4).axis[1], random_plan(machine(), ranges, 10, 3).axis[1]);
}

TEST(MeasurementPlan, SpiralStaysInTheEllipseAndFillsItEvenly) {
  std::vector<AxisRange> ranges = full_ranges(machine(), 2);
  const PoseList plan = spiral_plan(machine(), ranges, 1001, 10, 1, 2);
  std::size_t inner = 0;
  for (std::size_t k = 0; k < plan.count(); ++k) {
    const double r = std::hypot((plan.axis[1][k] - 700) / 700, (plan.axis[2][k] - 300) / 300);
    EXPECT_LE(r, 1 + 1e-12);
    inner += r < 0.5;
  }
  EXPECT_NEAR(static_cast<double>(inner) / 1001, 0.25, 0.01);
  EXPECT_EQ(plan.axis[0].back(), machine().axes[0].travel_max);
}

TEST(MeasurementPlan, OrderingKeepsThePosesAndShortensTheWay) {
  const PoseList plan = random_plan(machine(), full_ranges(machine(), 2), 300, 1);
  const PoseList ordered = order_by_travel(machine(), plan);
  std::multiset<double> before(plan.axis[1].begin(), plan.axis[1].end());
  std::multiset<double> after(ordered.axis[1].begin(), ordered.axis[1].end());
  EXPECT_EQ(before, after);
  EXPECT_LT(travel(machine(), ordered), 0.35 * travel(machine(), plan));
}

TEST(MeasurementPlan, RefusesPosesOutsideTheTravel) {
  std::vector<AxisRange> ranges = full_ranges(machine(), 2);
  ranges[1].to = 1401;
  EXPECT_THROW(grid_plan(machine(), ranges), std::invalid_argument);
  ranges.pop_back();
  EXPECT_THROW(random_plan(machine(), ranges, 5, 1), std::invalid_argument);
}

TEST(MeasurementPlan, ALineMayRunDownwards) {
  const Machine machine = test::three_axis_mill();
  const PoseList plan = line_plan(machine, {{0, 600, 5, 0}, {400, 100, 5, 0}, AxisRange::fixed(-10)}, 4);
  EXPECT_EQ(plan.axis[1], (std::vector<double>{400, 300, 200, 100}));
  EXPECT_THROW(line_plan(machine, {{0, 600, 5, 0}, {400, -100, 5, 0}, AxisRange::fixed(-10)}, 4),
               std::invalid_argument);
  EXPECT_THROW(grid_plan(machine, {{0, 600, 5, 0}, {400, 100, 5, 0}, AxisRange::fixed(-10)}), std::invalid_argument);
}

TEST(MeasurementPlan, AStepDiagonalMovesOneAxisAtATimeInTheOrderGiven) {
  const Machine machine = test::three_axis_mill();
  const std::vector<AxisRange> ranges = {{0, 600, 5, 0}, {400, 100, 5, 0}, {-450, 0, 5, 0}};
  const std::vector<std::size_t> order = {2, 0, 1};
  const PoseList plan = step_diagonal_plan(machine, ranges, 3, order);
  ASSERT_EQ(plan.count(), 10u);
  EXPECT_EQ(plan.pose(0), (std::vector<double>{0, 400, -450}));
  EXPECT_EQ(plan.pose(9), (std::vector<double>{600, 100, 0}));
  for (std::size_t k = 1; k < plan.count(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double step = (ranges[axis].to - ranges[axis].from) / 3;
      EXPECT_NEAR(plan.axis[axis][k] - plan.axis[axis][k - 1], axis == order[(k - 1) % 3] ? step : 0, 1e-9) << k;
    }
  }
  EXPECT_THROW(step_diagonal_plan(machine, ranges, 0, order), std::invalid_argument);
  EXPECT_THROW(step_diagonal_plan(machine, ranges, 3, {0, 1}), std::invalid_argument);
  EXPECT_THROW(step_diagonal_plan(machine, ranges, 3, {0, 1, 2, 1}), std::invalid_argument);
  EXPECT_THROW(step_diagonal_plan(machine, ranges, 3, {0, 1, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
