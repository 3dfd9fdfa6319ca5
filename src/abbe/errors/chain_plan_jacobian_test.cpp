#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/errors/chain_plan_cases.h"
#include "abbe/errors/chain_plan_differences.h"

namespace abbe {
namespace {

using chain_cases::all_parameters;
using chain_cases::Batch;
using chain_cases::Case;
using chain_cases::Derivatives;
using chain_cases::differentiate;
using chain_cases::expect_central_differences;
using chain_cases::kBodies;
using chain_cases::kOrders;
using chain_cases::random_case;
using chain_cases::Rows;

TEST(ChainPlanJacobian, MatchesCentralDifferencesForEveryParameterCommandAndStartPoint) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    for (const Body from : kBodies) {
      for (const Body to : kBodies) {
        expect_central_differences(random_case(seed, 0.1, kOrders[seed % 3]), seed, from, to);
      }
    }
  }
}

TEST(ChainPlanJacobian, MatchesCentralDifferencesForLargeErrors) {
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    expect_central_differences(random_case(seed, 5, kOrders[seed % 3]), seed, Body::tool, Body::workpiece);
    expect_central_differences(random_case(seed, 5, kOrders[seed % 3]), seed, Body::workpiece, Body::tool);
  }
}

TEST(ChainPlanJacobian, MatchesCentralDifferencesInTheFirstOrderForm) {
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    Case c = random_case(seed, 1, kOrders[seed % 3]);
    c.errors.composition.first_order = true;
    expect_central_differences(c, seed, Body::tool, Body::workpiece);
    expect_central_differences(c, seed, Body::workpiece, Body::bed);
  }
}

TEST(ChainPlanJacobian, AgreesWithTheTwistsOfTheActualPose) {
  for (std::uint64_t seed = 40; seed < 60; ++seed) {
    const Case c = random_case(seed, 0.1);
    const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
    RandomStream random(seed);
    const std::size_t count = 37;
    Batch batch(c.machine, count, random);
    const Eigen::Vector3d offset = c.machine.tool_offset + c.errors.tool_offset_error;
    for (int i = 0; i < 3; ++i)
      std::fill(batch.start[static_cast<std::size_t>(i)].begin(), batch.start[static_cast<std::size_t>(i)].end(),
                offset[i]);
    batch.transform(plan);
    Rows rows(6, count, random);
    for (std::size_t row = 0; row < 6; ++row) {
      for (std::size_t i = 0; i < 6; ++i) std::fill(rows.values[row][i].begin(), rows.values[row][i].end(), row == i);
    }
    const Derivatives d = differentiate(plan, batch, rows, all_parameters(c.errors), c.machine.axes.size());
    for (std::size_t k = 0; k < count; ++k) {
      Deviation deviation;
      Eigen::MatrixXd by_parameters, by_positions;
      tool_deviation(c.machine, c.errors, batch.positions_of(k), deviation, &by_parameters, &by_positions);
      for (Eigen::Index row = 0; row < 6; ++row) {
        const double lever = row < 3 ? 1000.0 : 1.0;
        for (Eigen::Index p = 0; p < by_parameters.cols(); ++p) {
          const double value =
              d.jacobian[static_cast<std::size_t>(p) * d.stride + static_cast<std::size_t>(row) * count + k];
          EXPECT_NEAR(value, by_parameters(row, p), 1e-12 * lever);
        }
        for (Eigen::Index axis = 0; axis < by_positions.cols(); ++axis) {
          const double value = d.by_position[static_cast<std::size_t>(axis * 6 + row) * count + k];
          EXPECT_NEAR(value, by_positions(row, axis), 1e-12 * lever);
        }
      }
    }
  }
}

TEST(ChainPlanJacobian, GivesTheSameColumnsForAnyOrderOfParametersAnyCountAndAnyNumberOfRows) {
  for (std::uint64_t seed = 60; seed < 66; ++seed) {
    const Case c = random_case(seed, 0.1);
    const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
    RandomStream random(seed);
    const std::size_t count = ChainPlan::kBlockSize, row_count = 9, axes = c.machine.axes.size();
    Batch batch(c.machine, count, random);
    batch.transform(plan);
    Rows rows(row_count, count, random);
    const std::vector<std::size_t> sorted = all_parameters(c.errors);
    const Derivatives d = differentiate(plan, batch, rows, sorted, axes);

    std::vector<std::size_t> mixed = sorted;
    for (std::size_t i = mixed.size(); i > 1; --i) std::swap(mixed[i - 1], mixed[random.bits() % i]);
    mixed.push_back(mixed.front());
    const Derivatives again = differentiate(plan, batch, rows, mixed, axes);
    for (std::size_t j = 0; j < mixed.size(); ++j) {
      for (std::size_t i = 0; i < row_count * count; ++i) {
        ASSERT_EQ(again.jacobian[j * again.stride + i], d.jacobian[mixed[j] * d.stride + i]);
      }
      ASSERT_EQ(again.jacobian[j * again.stride + row_count * count], -1e300) << "wrote past the rows";
    }

    for (const std::size_t pose : {std::size_t{0}, std::size_t{77}}) {
      Batch one(c.machine, 1, random);
      for (std::size_t axis = 0; axis < axes; ++axis) one.commands[axis][0] = batch.commands[axis][pose];
      for (std::size_t i = 0; i < 3; ++i) one.start[i][0] = batch.start[i][pose], one.seen[i][0] = batch.seen[i][pose];
      Rows one_row(1, 1, random);
      for (std::size_t i = 0; i < 6; ++i) one_row.values[0][i][0] = rows.values[8][i][pose];
      const Derivatives single = differentiate(plan, one, one_row, sorted, axes);
      for (const std::size_t p : sorted) {
        ASSERT_EQ(single.jacobian[p * single.stride], d.jacobian[p * d.stride + 8 * count + pose]);
      }
      for (std::size_t axis = 0; axis < axes; ++axis) {
        ASSERT_EQ(single.by_position[axis], d.by_position[(axis * row_count + 8) * count + pose]);
      }
    }
  }
}

}  // namespace
}  // namespace abbe
