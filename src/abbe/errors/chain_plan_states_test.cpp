#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/errors/chain_plan_cases.h"
#include "abbe/errors/chain_plan_differences.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/pose_model.h"

namespace abbe {
namespace {

using chain_cases::add_random_states;
using chain_cases::all_parameters;
using chain_cases::Batch;
using chain_cases::bed_from_body;
using chain_cases::Case;
using chain_cases::expect_central_differences;
using chain_cases::kBodies;
using chain_cases::kOrders;
using chain_cases::random_case;
using chain_cases::Rows;

Case case_with_states(std::uint64_t seed, double size, ErrorOrder order = ErrorOrder::iso) {
  Case c = random_case(seed, size, order);
  add_random_states(c, seed, size);
  return c;
}

TEST(ChainPlanStates, AgreesWithTheActualPoseInEveryOrderBetweenAllBodies) {
  std::size_t with_states = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Case c = case_with_states(seed, 0.1, kOrders[seed % 3]);
    with_states += has_states(c.errors) ? 1 : 0;
    RandomStream random(seed, 8);
    for (const Body from : kBodies) {
      for (const Body to : kBodies) {
        if (from == to) continue;
        const ChainPlan plan(c.machine, c.errors, from, to);
        Batch batch(c.machine, 17, random);
        batch.transform(plan);
        for (std::size_t k = 0; k < batch.count(); ++k) {
          const std::vector<double> positions = batch.positions_of(k), given = batch.given_at(k);
          const RigidTransform expected =
              bed_from_body(c, positions, to, given).inverse() * bed_from_body(c, positions, from, given);
          EXPECT_LE((batch.seen_point(k) - expected * batch.start_point(k)).cwiseAbs().maxCoeff(), 2e-11)
              << "seed " << seed << " from " << static_cast<int>(from) << " to " << static_cast<int>(to);
          EXPECT_LE((batch.rotation_matrix(k) - expected.rotation).cwiseAbs().maxCoeff(), 1e-13) << "seed " << seed;
          EXPECT_EQ(batch.covered[k], 1);
        }
      }
    }
  }
  EXPECT_GT(with_states, 50U);
}

TEST(ChainPlanStates, DerivativesMatchCentralDifferencesByParametersCommandsAndStart) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Case c = case_with_states(seed, 0.1, kOrders[seed % 3]);
    expect_central_differences(c, seed, Body::tool, Body::workpiece);
    expect_central_differences(c, seed, Body::workpiece, Body::tool);
    expect_central_differences(c, seed, Body::bed, Body::tool);
  }
}

TEST(ChainPlanStates, DerivativesMatchInTheFirstOrderForm) {
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    Case c = case_with_states(seed, 0.1, kOrders[seed % 3]);
    c.errors.composition.first_order = true;
    expect_central_differences(c, seed, Body::tool, Body::workpiece);
  }
}

TEST(ChainPlanStates, DerivativesAgreeWithTheTwistsOfTheActualPose) {
  for (std::uint64_t seed = 40; seed < 60; ++seed) {
    const Case c = case_with_states(seed, 0.1);
    const std::size_t count = 5, axes = c.machine.axes.size(), parameters = c.errors.parameter_count();
    RandomStream random(seed);
    Batch batch(c.machine, count, random);
    const PoseModel model(c.machine, c.errors);
    std::vector<double> jacobian(count * 6 * parameters), by_position(count * 6 * axes);
    model.jacobian(batch.positions(), jacobian.data());
    model.jacobian_by_positions(batch.positions(), by_position.data());
    for (std::size_t k = 0; k < count; ++k) {
      Deviation deviation;
      Eigen::MatrixXd by_parameters, by_positions;
      EXPECT_EQ(tool_deviation(c.machine, c.errors, batch.positions_of(k), deviation, &by_parameters, &by_positions,
                               batch.given_at(k)),
                PoseStatus::ok);
      for (std::size_t r = 0; r < 6; ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        for (std::size_t p = 0; p < parameters; ++p) {
          const double expected = by_parameters(row, static_cast<Eigen::Index>(p));
          EXPECT_NEAR(jacobian[(k * 6 + r) * parameters + p], expected, 1e-10 * (1 + std::abs(expected)))
              << parameter_names(c.machine, c.errors)[p] << " seed " << seed;
        }
        for (std::size_t i = 0; i < axes; ++i) {
          const double expected = by_positions(row, static_cast<Eigen::Index>(i));
          EXPECT_NEAR(by_position[(k * 6 + r) * axes + i], expected, 1e-10 * (1 + std::abs(expected)))
              << "seed " << seed;
        }
      }
    }
  }
}

TEST(ChainPlanStates, GivesNoNumberWhereAnInputStateIsNotGiven) {
  std::size_t missed = 0;
  for (std::uint64_t seed = 100; seed < 120; ++seed) {
    const Case c = case_with_states(seed, 0.1);
    const std::vector<std::uint8_t> used = used_states(c.machine, c.errors);
    RandomStream random(seed);
    const Batch given(c.machine, 9, random);
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (!is_input(c.machine.states[j].kind)) continue;
      Batch batch = given;
      batch.states[j][4] = std::numeric_limits<double>::quiet_NaN();
      const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
      batch.transform(plan);
      for (std::size_t k = 0; k < batch.count(); ++k) {
        EXPECT_EQ(batch.covered[k], used[j] != 0 && k == 4 ? 0 : 1);
        EXPECT_EQ(std::isfinite(batch.seen[0][k]), used[j] == 0 || k != 4);
      }
      batch.states[j].clear();
      batch.transform(plan);
      for (std::size_t k = 0; k < batch.count(); ++k) {
        EXPECT_EQ(batch.covered[k], used[j] != 0 ? 0 : 1);
        EXPECT_EQ(std::isfinite(batch.seen[0][k]), used[j] == 0);
      }
      Deviation deviation;
      EXPECT_EQ(tool_deviation(c.machine, c.errors, batch.positions_of(0), deviation, nullptr, nullptr,
                               batch.given_at(0)) == PoseStatus::ok,
                used[j] == 0);
      missed += used[j];
    }
  }
  EXPECT_GT(missed, 20U);
}

TEST(ChainPlanStates, NothingGivenAtAllGivesNoNumberEither) {
  Case c;
  c.machine.axes.push_back({"X", AxisKind::linear, ChainSide::tool});
  c.machine.axes[0].travel_max = 100;
  c.machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  c.errors.motions.push_back(
      {0, Component::X, {.kind = BasisKind::legendre, .order = 0, .from = 0, .to = 100}, {0.0}, {}, 0});
  const double x[] = {50};
  const double* axis[] = {x};
  double seen[3] = {};
  const double start = 0;
  std::uint8_t covered = 7;
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::bed);
  plan.transform({axis, 1}, {&start, &start, &start}, {&seen[0], &seen[1], &seen[2]}, {}, &covered);
  EXPECT_EQ(covered, 0);
  EXPECT_TRUE(std::isnan(seen[0])) << "a coefficient of zero is no reason to take a factor of zero";
}

TEST(ChainPlanStates, AnApproachThatIsNotKnownIsTheMeanOfBothSides) {
  Case c;
  c.machine.axes.push_back({"X", AxisKind::linear, ChainSide::tool});
  c.machine.axes[0].travel_max = 100;
  c.machine.states.push_back({.name = "side", .kind = StateKind::approach, .axis = 0});
  c.errors.motions.push_back(
      {0, Component::Y, {.kind = BasisKind::legendre, .order = 0, .from = 0, .to = 100}, {0.01}, {}, 0});
  const double x[] = {50, 50, 50}, side[] = {1, -1, 0}, zero[] = {0, 0, 0};
  const double *axis[] = {x}, *state[] = {side};
  double seen[3][3];
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::bed);
  plan.transform({axis, 3, state}, {zero, zero, zero}, {seen[0], seen[1], seen[2]});
  EXPECT_THAT(seen[1], testing::ElementsAre(0.01, -0.01, 0));
  plan.transform({axis, 3}, {zero, zero, zero}, {seen[0], seen[1], seen[2]});
  EXPECT_THAT(seen[1], testing::ElementsAre(0, 0, 0));
}

TEST(ChainPlanStates, StatesThatNoErrorUsesChangeNoBit) {
  for (std::uint64_t seed = 200; seed < 210; ++seed) {
    const Case plain = random_case(seed, 0.1);
    Case c = plain;
    add_random_states(c, seed, 0.1, std::numeric_limits<std::size_t>::max());
    ASSERT_FALSE(has_states(c.errors));
    RandomStream random(seed);
    Batch batch(plain.machine, 150, random), with = batch;
    batch.transform(ChainPlan(plain.machine, plain.errors, Body::tool, Body::workpiece));
    with.transform(ChainPlan(c.machine, plain.errors, Body::tool, Body::workpiece));
    EXPECT_EQ(batch.seen, with.seen);
    EXPECT_EQ(batch.rotation, with.rotation);
  }
}

TEST(ChainPlanStates, FoldingTheGivenStatesChangesNoPose) {
  for (std::uint64_t seed = 300; seed < 330; ++seed) {
    const Case c = case_with_states(seed, 0.1);
    RandomStream random(seed);
    Batch batch(c.machine, 20, random);
    // One state for all poses.
    for (std::size_t j = 0; j < batch.states.size(); ++j) {
      if (is_input(c.machine.states[j].kind)) std::fill(batch.states[j].begin(), batch.states[j].end(), 21.5);
    }
    const std::vector<double> values(c.machine.states.size(), 21.5);
    Eigen::MatrixXd by_parameters;
    const ErrorSet folded = at_state(c.machine, c.errors, values, &by_parameters);
    const std::vector<double> before = c.errors.parameters(), after = folded.parameters();
    const Eigen::VectorXd expected =
        by_parameters * Eigen::Map<const Eigen::VectorXd>(before.data(), static_cast<Eigen::Index>(before.size()));
    for (std::size_t p = 0; p < after.size(); ++p) {
      EXPECT_NEAR(after[p], expected[static_cast<Eigen::Index>(p)], 1e-15) << parameter_names(c.machine, folded)[p];
    }
    const std::vector<std::uint8_t> used = used_states(c.machine, folded);
    for (std::size_t j = 0; j < used.size(); ++j) EXPECT_FALSE(used[j] != 0 && is_input(c.machine.states[j].kind));
    Batch plain = batch;
    for (std::size_t j = 0; j < plain.states.size(); ++j) {
      if (is_input(c.machine.states[j].kind)) plain.states[j].clear();
    }
    batch.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::workpiece));
    plain.transform(ChainPlan(c.machine, folded, Body::tool, Body::workpiece));
    EXPECT_EQ(plain.covered, batch.covered);
    for (std::size_t k = 0; k < batch.count(); ++k) {
      EXPECT_LE((batch.seen_point(k) - plain.seen_point(k)).norm(), 2e-11) << "seed " << seed;
    }
  }
}

TEST(ChainPlanStates, DoesNotDependOnHowManyPosesAreEvaluatedTogether) {
  const Case c = case_with_states(1, 0.4);
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
  RandomStream random(5);
  Batch all(c.machine, 300, random);
  all.transform(plan);
  for (const std::size_t pose : {std::size_t{0}, std::size_t{127}, std::size_t{128}, std::size_t{299}}) {
    Batch one(c.machine, 1, random);
    for (std::size_t i = 0; i < one.commands.size(); ++i) one.commands[i][0] = all.commands[i][pose];
    for (std::size_t j = 0; j < one.states.size(); ++j) {
      if (!one.states[j].empty()) one.states[j][0] = all.states[j][pose];
    }
    for (std::size_t i = 0; i < 3; ++i) one.start[i][0] = all.start[i][pose];
    one.transform(plan);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(one.seen[i][0], all.seen[i][pose]);
  }
}

}  // namespace
}  // namespace abbe
