#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/errors/chain_plan_cases.h"

namespace abbe {
namespace {

using chain_cases::Batch;
using chain_cases::Case;
using chain_cases::kBodies;
using chain_cases::kOrders;
using chain_cases::random_case;

/// Quantities force . t + moment . w with random forces and moments.
struct Rows {
  std::vector<std::array<std::vector<double>, 6>> values;
  std::vector<RowArrays> arrays;

  Rows(std::size_t rows, std::size_t count, RandomStream& random) : values(rows) {
    for (auto& row : values) {
      for (std::vector<double>& component : row) {
        component.resize(count);
        for (double& value : component) value = random.uniform(-1, 1);
      }
      // A moment's derivative is of the size of an angle; scaled like a lever it weighs as much as the force.
      for (std::size_t i = 3; i < 6; ++i) {
        for (double& value : row[i]) value *= 100;
      }
    }
    for (const auto& row : values) {
      arrays.push_back({{row[0].data(), row[1].data(), row[2].data()}, {row[3].data(), row[4].data(), row[5].data()}});
    }
  }
  /// Change of the quantity between two results of transform().
  double change(std::size_t row, std::size_t k, const Batch& after, const Batch& before, bool rigid) const {
    const auto& v = values[row];
    const Eigen::Vector3d force(v[0][k], v[1][k], v[2][k]), moment(v[3][k], v[4][k], v[5][k]);
    const double moved = force.dot(after.seen_point(k) - before.seen_point(k));
    if (!rigid) return moved;
    return moved + moment.dot(rotation_vector(after.rotation_matrix(k) * before.rotation_matrix(k).transpose()));
  }
};

struct Derivatives {
  std::vector<double> jacobian, by_position, by_start_values;
  std::vector<PointArrays> by_start;
  std::size_t stride = 0;
};

Derivatives differentiate(const ChainPlan& plan, Batch& batch, const Rows& rows,
                          const std::vector<std::size_t>& parameters, std::size_t axes) {
  Derivatives d;
  const std::size_t n = batch.count(), r = rows.arrays.size();
  d.stride = r * n + 3;
  d.jacobian.assign(d.stride * parameters.size(), -1e300);
  d.by_position.assign(axes * r * n, -1e300);
  d.by_start_values.assign(3 * r * n, -1e300);
  for (std::size_t i = 0; i < r; ++i) {
    double* x = d.by_start_values.data() + 3 * i * n;
    d.by_start.push_back({x, x + n, x + 2 * n});
  }
  plan.differentiate(batch.positions(), batch.start_arrays(), batch.const_seen(), rows.arrays, parameters,
                     d.jacobian.data(), d.stride, d.by_start.data(), d.by_position.data());
  return d;
}

std::vector<std::size_t> all_parameters(const ErrorSet& errors) {
  std::vector<std::size_t> parameters(errors.parameter_count());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  return parameters;
}

/// Central difference of every quantity along a line, extrapolated once (error of the fourth order in the step).
template <class At>
std::vector<double> central_difference(const Rows& rows, std::size_t count, double step, bool rigid, const At& at) {
  const Batch far_up = at(step), far_down = at(-step), up = at(0.5 * step), down = at(-0.5 * step);
  std::vector<double> slope(rows.arrays.size() * count);
  for (std::size_t row = 0; row < rows.arrays.size(); ++row) {
    for (std::size_t k = 0; k < count; ++k) {
      const double wide = rows.change(row, k, far_up, far_down, rigid) / (2 * step);
      slope[row * count + k] = (4 * rows.change(row, k, up, down, rigid) / step - wide) / 3;
    }
  }
  return slope;
}

void expect_central_differences(const Case& c, std::uint64_t seed, Body from, Body to) {
  const bool rigid = !c.errors.composition.first_order;
  RandomStream random(seed, 9);
  ChainPlan plan(c.machine, c.errors, from, to);
  Batch batch(c.machine, 5, random);
  batch.transform(plan);
  Rows rows(2, batch.count(), random);
  if (!rigid) {
    for (RowArrays& row : rows.arrays) row.moment = {};
  }
  const std::vector<std::size_t> parameters = all_parameters(c.errors);
  const Derivatives d = differentiate(plan, batch, rows, parameters, c.machine.axes.size());
  const std::vector<double> values = c.errors.parameters();
  const std::vector<bool> angle = parameters_are_angles(c.machine, c.errors);
  const std::size_t rows_and_poses = 2 * batch.count();

  for (const std::size_t p : parameters) {
    const double scale = angle[p] ? 1000.0 : 1.0;
    const std::vector<double> expected = central_difference(rows, batch.count(), 1e-5 / scale, rigid, [&](double h) {
      std::vector<double> moved = values;
      moved[p] += h;
      plan.set_parameters(moved);
      Batch result = batch;
      const std::size_t tool = values.size() - 3;
      if (p >= tool && from == Body::tool && to != Body::tool) {
        for (double& value : result.start[p - tool]) value += h;
      }
      result.transform(plan);
      if (p >= tool && to == Body::tool && from != Body::tool) {
        for (double& value : result.seen[p - tool]) value -= h;
      }
      return result;
    });
    for (std::size_t i = 0; i < rows_and_poses; ++i) {
      EXPECT_NEAR(d.jacobian[p * d.stride + i] / scale, expected[i] / scale, 2e-7 * (1 + std::abs(expected[i] / scale)))
          << parameter_names(c.machine, c.errors)[p] << " seed " << seed << " " << static_cast<int>(from)
          << static_cast<int>(to);
    }
  }
  plan.set_parameters(values);
  for (std::size_t axis = 0; axis < c.machine.axes.size(); ++axis) {
    const double scale = c.machine.axes[axis].kind == AxisKind::rotary ? 1000.0 : 1.0;
    const std::vector<double> expected = central_difference(rows, batch.count(), 1e-5 / scale, rigid, [&](double h) {
      Batch result = batch;
      for (double& value : result.commands[axis]) value += h;
      result.transform(plan);
      return result;
    });
    for (std::size_t i = 0; i < rows_and_poses; ++i) {
      EXPECT_NEAR(d.by_position[axis * rows_and_poses + i] / scale, expected[i] / scale,
                  2e-7 * (1 + std::abs(expected[i] / scale)))
          << c.machine.axes[axis].name << " seed " << seed;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> expected = central_difference(rows, batch.count(), 1e-3, rigid, [&](double h) {
      Batch result = batch;
      for (double& value : result.start[i]) value += h;
      result.transform(plan);
      return result;
    });
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t k = 0; k < batch.count(); ++k) {
        const double* component = i == 0 ? d.by_start[row].x : i == 1 ? d.by_start[row].y : d.by_start[row].z;
        EXPECT_NEAR(component[k], expected[row * batch.count() + k], 2e-7);
      }
    }
  }
}

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
