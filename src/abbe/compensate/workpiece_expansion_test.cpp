#include "abbe/compensate/workpiece_expansion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "abbe/compensate/corrected_poses.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/expansion.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

Machine warm_mill(const char* chain) {
  Machine mill = parse_chain(chain).machine;
  for (Axis& axis : mill.axes) {
    if (axis.kind == AxisKind::rotary) {
      axis.point = {0, 0, -60};
      continue;
    }
    axis.travel_min = -400;
    axis.travel_max = 600;
  }
  mill.tool_reference = {0, 0, 200};
  mill.tool_offset = {0, 0, -80};
  mill.states.push_back({.name = "part", .unit = "degC", .reference = 20});
  mill.states.push_back({.name = "scale", .unit = "degC", .reference = 20});
  return mill;
}

PoseList warm_poses(const Machine& machine, std::size_t count) {
  PoseList poses;
  RandomStream random(11);
  poses.state.resize(2);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> at;
    for (const Axis& axis : machine.axes) {
      at.push_back(axis.kind == AxisKind::rotary ? random.uniform(-0.9, 0.9) : random.uniform(-300, 500));
    }
    poses.append(at);
    poses.state[0].push_back(random.uniform(16, 31));
    poses.state[1].push_back(random.uniform(18, 26));
  }
  return poses;
}

const WorkpieceExpansion kAluminium{.state = 0, .coefficient = 23.4e-6, .fixed_point = {100, -50, 20}};

TEST(WorkpieceExpansion, PointsMoveAwayFromTheFixedOne) {
  // 1 m from the fixed point, 5 K: 23.4 * 5 = 117 um.
  const Eigen::Vector3d moved = expanded_point(kAluminium, 5, {1100, -50, 20});
  EXPECT_NEAR(moved.x(), 1100.117, 1e-12);
  EXPECT_EQ(expanded_point(kAluminium, 5, kAluminium.fixed_point), kAluminium.fixed_point);
  WorkpieceExpansion stated = kAluminium;
  stated.standard_uncertainty = 1e-6;
  stated.temperature_uncertainty = 0.5;
  // u^2 = (1 * 5)^2 + (23.4^2 + 1) 0.5^2 um^2 at 1 m
  EXPECT_NEAR(expanded_point_covariance(stated, 5, {1100, -50, 20})(0, 0), 1e-6 * (25 + 548.56 * 0.25), 1e-13);
}

TEST(WorkpieceExpansion, TheToolIsBroughtToThePointsOfTheWarmPart) {
  const Machine mill = warm_mill("w C' A' Y' b X Z t");
  RandomErrorOptions options;
  options.seed = 4;
  ErrorSet errors = random_errors(mill, options);
  scale_errors(mill, errors, {.measure = VolumetricMeasure::mean, .value_um = 60});
  for (ErrorMotion& term : expansion_terms(mill, {.axis = 3, .state = 1, .coefficient = 11e-6})) {
    errors.motions.push_back(term);
  }
  const PoseList poses = warm_poses(mill, 60);
  const CorrectedPoses result = corrected_poses(mill, errors, {}, poses, {.workpiece = kAluminium});
  ASSERT_EQ(result.problem, "");
  const GivenStates states(mill, errors);
  std::size_t reached = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (!reaches_point(result.status[k])) continue;
    ++reached;
    const RigidTransform nominal = nominal_workpiece_from_tool(mill, poses.pose(k));
    const double grown = 1 + 23.4e-6 * (poses.state[0][k] - 20);
    const Eigen::Vector3d fixed(100, -50, 20), wanted = fixed + grown * (nominal.translation - fixed);
    const RigidTransform actual =
        actual_workpiece_from_tool(mill, errors, result.commands.pose(k), states.at(poses, k));
    EXPECT_LT((actual.translation - wanted).norm(), 1e-9) << k;
    EXPECT_LT((actual.rotation * mill.tool_direction - nominal.rotation * mill.tool_direction).norm(), 1e-9);
    const RigidTransform before = actual_workpiece_from_tool(mill, errors, poses.pose(k), states.at(poses, k));
    EXPECT_NEAR(result.shift[k], (before.translation - wanted).norm(), 1e-10);
  }
  EXPECT_EQ(reached, poses.count());
}

/// Linear axes alone: the part is one more expansion of each axis, with the opposite sign.
ErrorSet as_scale_expansions(const Machine& mill, double coefficient, const Eigen::Vector3d& fixed) {
  ErrorSet errors;
  const std::vector<double> zero(mill.axes.size(), 0.0);
  const Eigen::Vector3d at_zero = nominal_workpiece_from_tool(mill, zero).translation;
  for (std::size_t axis = 0; axis < mill.axes.size(); ++axis) {
    const int along = static_cast<int>(expansion_direction(mill.axes[axis]).component);
    const ScaleExpansion expansion{
        .axis = axis, .state = 0, .coefficient = -coefficient, .fixed_point = fixed[along] - at_zero[along]};
    for (const ErrorMotion& term : expansion_terms(mill, expansion)) errors.motions.push_back(term);
  }
  return errors;
}

TEST(WorkpieceExpansion, OnLinearAxesIsTheSameAsExpansionsOfTheScales) {
  const Machine mill = warm_mill("w X' b Y Z t");  // a positive command of X' moves the tool to +X against the table
  const PoseList poses = warm_poses(mill, 40);
  const CorrectedPoses part = corrected_poses(mill, {}, {}, poses, {.workpiece = kAluminium});
  const CorrectedPoses scales =
      corrected_poses(mill, as_scale_expansions(mill, kAluminium.coefficient, kAluminium.fixed_point), {}, poses);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t i = 0; i < mill.axes.size(); ++i) {
      // To first order: the scale expands where the tool goes, the part where it should be.
      const double second_order = 2 * std::pow(23.4e-6 * 11, 2) * 900;
      EXPECT_NEAR(part.commands.axis[i][k], scales.commands.axis[i][k], second_order) << k << " " << i;
    }
  }
}

TEST(WorkpieceExpansion, UncertaintyIsThatOfManyDrawnParts) {
  const Machine mill = warm_mill("w C' A' Y' b X Z t");
  WorkpieceExpansion stated = kAluminium;
  stated.standard_uncertainty = 1e-6;
  stated.temperature_uncertainty = 0.5;
  const PoseList poses = warm_poses(mill, 12);
  const CorrectedPoses result = corrected_poses(mill, {}, {}, poses, {.workpiece = stated});
  ASSERT_EQ(result.uncertainty.size(), poses.count());
  constexpr int kDraws = 4000;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    const Eigen::Vector3d point = nominal_workpiece_from_tool(mill, poses.pose(k)).translation;
    const double factor = poses.state[0][k] - 20;
    const Eigen::Vector3d meant = expanded_point(stated, factor, point), along = (meant - point).normalized();
    RandomStream random(5, k);
    double squares = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      WorkpieceExpansion real = stated;
      real.coefficient += stated.standard_uncertainty * random.normal();
      const double real_factor = factor + stated.temperature_uncertainty * random.normal();
      squares += std::pow(along.dot(expanded_point(real, real_factor, point) - meant), 2);
    }
    EXPECT_NEAR(std::sqrt(squares / kDraws) / result.uncertainty[k], 1, 0.05) << k;
  }
}

TEST(WorkpieceExpansion, PosesWithoutItsTemperatureAreNotFinite) {
  const Machine mill = warm_mill("w X' b Y Z t");
  PoseList poses = warm_poses(mill, 3);
  poses.state[0][1] = std::nan("");
  const CorrectedPoses result = corrected_poses(mill, {}, {}, poses, {.workpiece = kAluminium});
  EXPECT_EQ(result.status[0], CorrectionStatus::reached);
  EXPECT_EQ(result.status[1], CorrectionStatus::not_finite);
  EXPECT_TRUE(std::isnan(result.shift[1]));
  EXPECT_EQ(result.commands.axis[0][1], poses.axis[0][1]);
}

}  // namespace
}  // namespace abbe
