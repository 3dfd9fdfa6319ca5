#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/errors/chain_plan_cases.h"

/// Central differences of ChainPlan::transform() against ChainPlan::differentiate(), for tests.
namespace abbe::chain_cases {

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

inline Derivatives differentiate(const ChainPlan& plan, Batch& batch, const Rows& rows,
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

inline std::vector<std::size_t> all_parameters(const ErrorSet& errors) {
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

/// Small against the coefficients, of which monotone tables are no linear function: those with a state may be small.
inline std::vector<double> parameter_steps(const ErrorSet& errors, const std::vector<bool>& angle) {
  std::vector<double> steps;
  for (const ErrorMotion& motion : errors.motions) {
    double step = is_rotation(motion.component) ? 1e-8 : 1e-5;
    if (motion.state != kNoState && motion.basis.kind == BasisKind::table_monotone) {
      double largest = 0;
      for (const double value : motion.coefficients) largest = std::max(largest, std::abs(value));
      step = std::min(step, 3e-3 * largest);
    }
    steps.insert(steps.end(), motion.coefficients.size(), step);
  }
  while (steps.size() < angle.size()) steps.push_back(angle[steps.size()] ? 1e-8 : 1e-5);
  return steps;
}

inline void expect_central_differences(const Case& c, std::uint64_t seed, Body from, Body to) {
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

  // Factors of hundreds make curvature and rounding of a difference larger.
  const double tolerance = c.machine.states.empty() ? 2e-7 : 1e-6;
  const std::vector<double> steps = parameter_steps(c.errors, angle);
  for (const std::size_t p : parameters) {
    const double scale = angle[p] ? 1000.0 : 1.0;
    const std::vector<double> expected = central_difference(rows, batch.count(), steps[p], rigid, [&](double h) {
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
      EXPECT_NEAR(d.jacobian[p * d.stride + i] / scale, expected[i] / scale,
                  tolerance * (1 + std::abs(expected[i] / scale)))
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

}  // namespace abbe::chain_cases
