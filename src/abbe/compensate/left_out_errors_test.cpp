#include "abbe/compensate/left_out_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// EXX and EXY of a three-axis mill, constant, both along X of the point.
struct TwoAlongX {
  TwoAlongX(double first, double second) {
    for (const auto& [name, value] : {std::pair{"X", first}, std::pair{"Y", second}}) {
      const std::size_t axis = machine.find_axis(name);
      const Axis& travel = machine.axes[axis];
      const Basis constant{.kind = BasisKind::legendre, .order = 0, .from = travel.travel_min, .to = travel.travel_max};
      errors.motions.push_back({axis, Component::X, constant, {value}, {}});
    }
    covariance = Eigen::MatrixXd::Zero(5, 5);
    covariance.topLeftCorner<2, 2>() << 1, 0, 0, 1;
  }
  void correlate(double u, double correlation) {
    covariance.topLeftCorner<2, 2>() << 1, correlation, correlation, 1;
    covariance *= u * u;
  }
  const Machine machine = test::three_axis_mill();
  ErrorSet errors;
  Eigen::MatrixXd covariance;
};

TEST(LeftOutErrors, ErrorsBelowTheirUncertaintyEverywhereAreLeftOutByName) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y");
  const Axis& travel = machine.axes[x];
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = travel.travel_min, .to = travel.travel_max};
  ErrorSet errors;
  // 1 um everywhere, u 1 um: below 2 u. A line that crosses zero but leaves its uncertainty at the ends stays.
  errors.motions.push_back({x, Component::Y, line, {1e-3, 0}, {1e-3, 0}});
  errors.motions.push_back({x, Component::Z, line, {0, 5e-3}, {1e-3, 0}});
  errors.motions.push_back({x, Component::A, line, {1e-9, 0}, {}});  // nothing is stated about it
  // A slope and its uncertainty are zero together in the middle.
  errors.motions.push_back({x, Component::B, line, {0, 1e-6}, {0, 1e-6}});
  errors.locations.push_back({y, Component::C, 4e-6, 3e-6});
  errors.locations.push_back({y, Component::A, 9e-6, 3e-6});
  ErrorSet kept = errors;
  const std::vector<std::string> names = leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2).names;
  EXPECT_THAT(names, testing::ElementsAre("EYX", "EBX", "EC0Y"));
  EXPECT_EQ(kept.motions[0].coefficients, (std::vector<double>{0, 0}));
  EXPECT_EQ(kept.motions[1].coefficients, errors.motions[1].coefficients);
  EXPECT_EQ(kept.locations[0].value, 0);
  EXPECT_EQ(kept.locations[1].value, 9e-6);
  // Two terms of one motion count together.
  errors.motions.push_back({x, Component::Y, line, {4e-3, 0}, {1e-4, 0}});
  kept = errors;
  EXPECT_THAT(leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2).names,
              testing::ElementsAre("EBX", "EC0Y"));
}

TEST(LeftOutErrors, ReversalValuesBelowTheirUncertaintyAreLeftOutByName) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y"), z = machine.find_axis("Z");
  ErrorSet errors;
  errors.locations.push_back({y, Component::C, 50e-6, 3e-6});
  errors.reversals = {{x, -0.002, 0.0015}, {y, -0.004, 0.0015}, {z, 0.001, 0}};
  ErrorSet kept = errors;
  EXPECT_THAT(leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2).names,
              testing::ElementsAre("reversal_X"));
  EXPECT_EQ(kept.reversals[0].value, 0);
  EXPECT_EQ(kept.reversals[1].value, -0.004);
  EXPECT_EQ(kept.reversals[2].value, 0.001);
}

TEST(LeftOutErrors, NothingIsWithoutStatedUncertainties) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::mixed_errors(machine, 3);
  ErrorSet all = errors;
  const LeftOutErrors left_out = leave_out_uncertain(machine, all, parameter_covariance(errors, {}), 2);
  EXPECT_THAT(left_out.names, IsEmpty());
  EXPECT_THAT(left_out.where, IsEmpty());
  EXPECT_EQ(all.parameters(), errors.parameters());
}

TEST(LeftOutErrors, WhatIsWellKnownInItsSumStaysAlthoughNoPartOfItIs) {
  // 10 um each, u 20 um each, but of their sum, 20 um, only 2.8 um.
  TwoAlongX two(10e-3, 10e-3);
  two.correlate(20e-3, -0.99);
  ErrorSet kept = two.errors;
  LeftOutErrors left_out = leave_out_uncertain(two.machine, kept, two.covariance, 2);
  EXPECT_THAT(left_out.names, IsEmpty());
  EXPECT_THAT(left_out.kept, UnorderedElementsAre("EXX", "EXY"));
  EXPECT_EQ(kept.parameters(), two.errors.parameters());
  // Without the correlation their sum has u 28 um.
  two.correlate(20e-3, 0);
  left_out = leave_out_uncertain(two.machine, kept, two.covariance, 2);
  EXPECT_THAT(left_out.names, ElementsAre("EXX", "EXY"));
  EXPECT_THAT(left_out.kept, IsEmpty());
  EXPECT_NEAR(left_out.largest_shift, 20e-3, 1e-9);
  EXPECT_EQ(left_out.where.size(), 3U);
  EXPECT_EQ(kept.motions[1].coefficients[0], 0);
}

TEST(LeftOutErrors, APartOfAWellKnownSumStaysBesideAKeptOne) {
  // The first is 0.5 u, the second 2.5 u; left alone the second would correct 50 um of 60 um that are known to 2.8 um.
  TwoAlongX two(10e-3, 50e-3);
  two.correlate(20e-3, -0.99);
  ErrorSet kept = two.errors;
  const LeftOutErrors left_out = leave_out_uncertain(two.machine, kept, two.covariance, 2);
  EXPECT_THAT(left_out.names, IsEmpty());
  EXPECT_THAT(left_out.kept, ElementsAre("EXX"));
}

TEST(LeftOutErrors, WhatAddsUpToMoreThanItsUncertaintyGoesBackInPart) {
  // Each is 1.9 u: their sum is 2.7 of its u.
  TwoAlongX two(1.9e-3, 1.8e-3);
  two.correlate(1e-3, 0);
  ErrorSet kept = two.errors;
  const LeftOutErrors left_out = leave_out_uncertain(two.machine, kept, two.covariance, 2);
  EXPECT_THAT(left_out.names, ElementsAre("EXY"));
  EXPECT_THAT(left_out.kept, ElementsAre("EXX"));
}

TEST(LeftOutErrors, NowhereAreTogetherTwoStandardUncertaintiesOfTheCorrection) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::mixed_errors(machine, 5);
  const auto n = static_cast<Eigen::Index>(errors.parameter_count());
  // A few large directions and small independent parts, of about the size of the errors.
  std::mt19937_64 generator(6);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(n, 6);
  const std::vector<double> values = errors.parameters();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < 6; ++k)
      root(i, k) = 0.5 * std::abs(values[static_cast<std::size_t>(i)]) * normal(generator);
  }
  Eigen::MatrixXd covariance = root * root.transpose();
  covariance.diagonal() *= 1.02;
  ErrorSet kept = errors;
  const LeftOutErrors left_out = leave_out_uncertain(machine, kept, covariance, 2);
  ASSERT_GT(left_out.names.size(), 1U);
  ASSERT_GT(left_out.kept.size(), 0U);
  double worst = 0, largest = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<double> position;
    for (const Axis& axis : machine.axes) {
      const double from = axis.endless ? 0 : axis.travel_min, to = axis.endless ? 6.28 : axis.travel_max;
      position.push_back(std::uniform_real_distribution<double>(from, to)(generator));
    }
    Deviation all, without;
    Eigen::MatrixXd by_parameters;
    tool_deviation(machine, errors, position, all, &by_parameters);
    tool_deviation(machine, kept, position, without);
    const Eigen::Vector3d missing = (all - without).head<3>();
    const Eigen::RowVectorXd slope = missing.normalized().transpose() * by_parameters.topRows<3>();
    worst = std::max(worst, missing.norm() / std::sqrt(slope.dot(slope * covariance)));
    largest = std::max(largest, missing.norm());
  }
  // At poses between those that were looked at it may be a little more.
  EXPECT_LT(worst, 2 * 1.15);
  EXPECT_LT(largest, 1.05 * left_out.largest_shift);
}

}  // namespace
}  // namespace abbe
