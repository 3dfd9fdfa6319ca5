#include "abbe/errors/reversal.h"

#include <gtest/gtest.h>

#include <vector>

#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

PoseList there_and_back() {
  PoseList poses;
  for (const double x : {0.0, 10.0, 20.0, 20.0, 10.0, 0.0}) poses.append({x, 5.0});
  return poses;
}

TEST(Reversal, SidesAreThoseOfTheLastMotion) {
  const std::vector<std::vector<std::int8_t>> sides = approach_in_order(there_and_back());
  EXPECT_EQ(sides[0], (std::vector<std::int8_t>{0, 1, 1, 1, -1, -1}));
  EXPECT_EQ(sides[1], (std::vector<std::int8_t>(6, 0)));
}

TEST(Reversal, JoinedPosesKeepTheirSidesAndSayWhereNoneIsKnown) {
  PoseList known = there_and_back(), unknown = there_and_back();
  known.approach = approach_in_order(known);
  PoseList all = unknown;
  join_poses(all, known);
  join_poses(all, unknown);
  ASSERT_EQ(all.count(), 18U);
  EXPECT_EQ(all.approach[0], (std::vector<std::int8_t>{0, 0, 0, 0, 0, 0, 0, 1, 1, 1, -1, -1, 0, 0, 0, 0, 0, 0}));
  join_poses(unknown, unknown);
  EXPECT_TRUE(unknown.approach.empty());
}

TEST(Reversal, TheDifferenceOfBothDirectionsIsTheReversalValue) {
  ErrorSet errors;
  errors.reversals.push_back({0, -0.008, 0});
  PoseList poses = there_and_back();
  poses.approach = approach_in_order(poses);
  ReversalShift shift(errors);
  ASSERT_TRUE(shift.acts_on(poses));
  // X = 10 from below and from above: B = after the positive approach less after the negative one.
  EXPECT_DOUBLE_EQ(shift.shift(poses, 0, 1) - shift.shift(poses, 0, 4), -0.008);
  EXPECT_EQ(shift.shift(poses, 0, 0), 0);
  EXPECT_EQ(shift.shift(poses, 1, 1), 0);
  std::vector<double> values = errors.parameters();
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(shift.axis_of(0), 0U);
  EXPECT_EQ(shift.axis_of(1), ReversalShift::npos);
  values[0] = 0.002;
  shift.set_parameters(values);
  EXPECT_DOUBLE_EQ(shift.shift(poses, 0, 4), -0.001);
}

TEST(Reversal, ReversalValuesStandTogetherAmongTheParameters) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), z = machine.find_axis("Z");
  ErrorSet errors;
  errors.locations = {{x, Component::C, 1e-5, 0}};
  errors.reversals = {{z, -0.008, 0}, {x, 0.002, 0}};
  const std::vector<std::string> names = parameter_names(machine, errors);
  const std::size_t first = first_reversal(errors);
  ASSERT_LT(first + 1, names.size());
  EXPECT_EQ(names[first], "reversal_Z");
  EXPECT_EQ(names[first + 1], "reversal_X");
  EXPECT_EQ(errors.parameters()[first], reversal_of(errors, z));
  EXPECT_EQ(reversal_of(errors, x), 0.002);
  EXPECT_EQ(reversal_of(errors, machine.find_axis("Y")), 0);
  errors.reversals.clear();
  EXPECT_EQ(parameter_names(machine, errors)[first_reversal(errors)], "tool_X");
}

TEST(Reversal, NothingActsWithoutAnApproachOrAReversal) {
  ErrorSet errors;
  PoseList poses = there_and_back();
  EXPECT_FALSE(ReversalShift(errors).acts_on(poses));
  errors.reversals.push_back({1, 0.01, 0});
  EXPECT_FALSE(ReversalShift(errors).acts_on(poses));
  EXPECT_EQ(ReversalShift(errors).shift(poses, 1, 2), 0);
}

TEST(Reversal, StandsBetweenLocationsAndToolAmongTheParameters) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  errors.locations.push_back({1, Component::B, 1e-5, 0});
  errors.reversals.push_back({0, 2e-5, 0});
  errors.reversals.push_back({machine.find_axis("Y"), -0.004, 0});
  errors.tool_offset_error = {0.1, 0.2, 0.3};
  const std::vector<std::string> names = parameter_names(machine, errors);
  ASSERT_EQ(names.size(), 6U);
  EXPECT_EQ(names[0], "EB0" + machine.axes[1].name);
  EXPECT_EQ(names[1], "reversal_" + machine.axes[0].name);
  EXPECT_EQ(names[2], "reversal_Y");
  EXPECT_EQ(names[3], "tool_X");
  EXPECT_EQ(parameters_are_angles(machine, errors), (std::vector<bool>{true, true, false, false, false, false}));
  std::vector<double> values = errors.parameters();
  for (double& value : values) value *= 2;
  errors.set_parameters(values);
  EXPECT_EQ(errors.reversals[1].value, -0.008);
  EXPECT_EQ(errors.tool_offset_error[2], 0.6);
  // Error motions are means of both directions: the pose without an approach does not depend on them.
  Deviation deviation;
  Eigen::MatrixXd by_parameters;
  tool_deviation(machine, errors, std::vector<double>(5, 1.0), deviation, &by_parameters);
  EXPECT_TRUE(by_parameters.middleCols(1, 2).isZero(0));
  EXPECT_GT(by_parameters.rightCols(3).norm(), 1);
}

}  // namespace
}  // namespace abbe
