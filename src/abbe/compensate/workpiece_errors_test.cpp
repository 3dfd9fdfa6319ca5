#include "abbe/compensate/workpiece_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "abbe/compensate/corrected_poses.h"
#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

constexpr double kWarmer = 7;  // K

const WorkpieceExpansion kPart{.temperature = 27,
                               .coefficient = 23.4e-6,
                               .standard_uncertainty = 1e-6,
                               .temperature_uncertainty = 0.4,
                               .fixed_point = {120, -40, 35}};

/// Axis points, workpiece and tool anywhere, directions not all parallel to X, Y, Z.
Machine machine_anywhere(const char* chain, bool skew) {
  Machine machine = parse_chain(chain).machine;
  RandomStream random(3);
  for (Axis& axis : machine.axes) {
    axis.point = {random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-80, 80)};
    if (axis.kind == AxisKind::linear) {
      axis.travel_min = -500;
      axis.travel_max = 700;
    }
    if (skew) {
      const Eigen::Vector3d off(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
      axis.direction = (axis.direction + off).normalized();
    }
  }
  machine.bed_from_workpiece = RigidTransform::translate({30, -20, 60});
  machine.tool_reference = {4, -6, 210};
  machine.tool_offset = {3, 2, -90};
  return machine;
}

std::vector<double> anywhere(const Machine& machine, RandomStream& random) {
  std::vector<double> at;
  for (const Axis& axis : machine.axes) {
    at.push_back(axis.kind == AxisKind::rotary ? random.uniform(-1.5, 1.5) : random.uniform(-400, 600));
  }
  return at;
}

constexpr const char* kChains[] = {"w X' b Y Z t",     "w b X Y Z t",      "w C' A' Y' b X Z t", "w C' b X Y Z B t",
                                   "w b X Y Z C A t",  "w X' C' b Y Z t",  "w C' X' A' b Y Z t", "w b A B C t",
                                   "w C' b X Y Z W t", "w b X Y Z B C W t"};

TEST(WorkpieceErrors, DisplaceTheToolTowardsTheFixedPointOnMachinesOfAnyKind) {
  const double strain = kPart.coefficient * kWarmer, shrinkage = strain / (1 + strain);
  for (const char* const chain : kChains) {
    for (const bool skew : {false, true}) {
      const Machine machine = machine_anywhere(chain, skew);
      const ErrorSet errors = WorkpieceErrors(machine, kPart, kWarmer).with({});
      RandomStream random(8);
      for (int k = 0; k < 20; ++k) {
        const std::vector<double> at = anywhere(machine, random);
        EXPECT_TRUE(covers_commands(machine, errors, at)) << chain;
        const RigidTransform nominal = nominal_workpiece_from_tool(machine, at);
        const RigidTransform actual = actual_workpiece_from_tool(machine, errors, at);
        const Eigen::Vector3d expected = nominal.translation - shrinkage * (nominal.translation - kPart.fixed_point);
        EXPECT_LT((actual.translation - expected).norm(), 1e-11) << chain << " skew " << skew;
        EXPECT_LT((actual.rotation - nominal.rotation).norm(), 1e-14) << chain;
      }
    }
  }
}

TEST(WorkpieceErrors, ALongerToolMovesThePointByItsShare) {
  const double strain = kPart.coefficient * kWarmer, shrinkage = strain / (1 + strain);
  const Machine machine = machine_anywhere("w C' b X Y Z B t", false);
  const WorkpieceErrors part(machine, kPart, kWarmer);
  const Eigen::Vector3d longer(1, 2, 75);
  Machine with_tool = machine;
  with_tool.tool_offset -= longer;
  ErrorSet errors = part.with({});
  errors.tool_offset_error -= part.tool_length_share() * longer;
  RandomStream random(2);
  for (int k = 0; k < 10; ++k) {
    const std::vector<double> at = anywhere(machine, random);
    const Eigen::Vector3d nominal = nominal_workpiece_from_tool(with_tool, at).translation;
    const Eigen::Vector3d actual = actual_workpiece_from_tool(with_tool, errors, at).translation;
    EXPECT_LT((actual - nominal + shrinkage * (nominal - kPart.fixed_point)).norm(), 1e-11);
  }
}

TEST(WorkpieceErrors, CorrectedForThemTheToolIsWhereThePartIs) {
  const Machine machine = machine_anywhere("w C' A' Y' b X Z t", false);
  RandomErrorOptions options;
  options.seed = 9;
  ErrorSet errors = random_errors(machine, options);
  scale_errors(machine, errors, {.measure = VolumetricMeasure::mean, .value_um = 40});
  const ErrorSet together = WorkpieceErrors(machine, kPart, kWarmer).with(errors);
  PoseList poses;
  RandomStream random(21);
  for (int k = 0; k < 40; ++k) {
    std::vector<double> at = anywhere(machine, random);
    for (std::size_t i = 0; i < at.size(); ++i) at[i] *= 0.5;
    poses.append(at);
  }
  const CorrectedPoses as_part = corrected_poses(machine, errors, {}, poses, {.workpiece = kPart});
  const CorrectedPoses as_errors = corrected_poses(machine, together, {}, poses);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    ASSERT_TRUE(reaches_point(as_part.status[k]) && reaches_point(as_errors.status[k])) << k;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      // Together: error motions of the angles act on the displacement of the part, 1e-4 of 0.1 mm.
      EXPECT_NEAR(as_part.commands.axis[i][k], as_errors.commands.axis[i][k], 2e-5) << k << " " << i;
    }
  }
  const CorrectedPoses alone = corrected_poses(machine, {}, {}, poses, {.workpiece = kPart});
  const CorrectedPoses as_errors_alone =
      corrected_poses(machine, WorkpieceErrors(machine, kPart, kWarmer).with({}), {}, poses);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      EXPECT_NEAR(alone.commands.axis[i][k], as_errors_alone.commands.axis[i][k], 3e-9) << "without a remainder";
    }
  }
}

TEST(WorkpieceErrors, UncertaintyIsThatOfTheExpandedPoint) {
  const std::array<double, 3> longer = {0, 0, 60};
  for (const char* const chain : kChains) {
    const Machine machine = machine_anywhere(chain, false);
    const WorkpieceErrors part(machine, kPart, kWarmer);
    ErrorSet errors;
    errors.reversals.push_back({0, 1e-3, 2e-4});
    const ErrorSet together = part.with(errors);
    for (const std::array<double, 3>& length : {std::array<double, 3>{}, longer}) {
      const Eigen::MatrixXd covariance = part.covariance_with(errors, stated_variances(errors), length);
      ASSERT_EQ(covariance.rows(), static_cast<Eigen::Index>(together.parameter_count()));
      EXPECT_EQ(covariance(covariance.rows() - 4, covariance.rows() - 4), 4e-8) << "of the reversal value";
      Machine with_tool = machine;
      with_tool.tool_offset[2] -= length[2];
      RandomStream random(4);
      const std::vector<double> at = anywhere(machine, random);
      Deviation deviation;
      Eigen::MatrixXd by_parameters;
      tool_deviation(with_tool, together, at, deviation, &by_parameters, nullptr);
      const Eigen::MatrixXd found = by_parameters.topRows<3>() * covariance * by_parameters.topRows<3>().transpose();
      const Eigen::Matrix3d expected =
          expanded_point_covariance(kPart, kWarmer, nominal_workpiece_from_tool(with_tool, at).translation);
      EXPECT_LT((found - expected).norm(), 1e-3 * expected.norm()) << chain;
    }
  }
  const Machine machine = machine_anywhere("w b X Y Z t", false);
  WorkpieceExpansion known = kPart;
  known.standard_uncertainty = known.temperature_uncertainty = 0;
  EXPECT_EQ(WorkpieceErrors(machine, known, kWarmer).covariance_with({}, {}).size(), 0);
  EXPECT_EQ(WorkpieceErrors(machine, kPart, 0).with({}).parameters()[1], 0) << "at 20 degC";
  EXPECT_GT(WorkpieceErrors(machine, kPart, 0).covariance_with({}, {})(1, 1), 0) << "which is not known exactly";
}

TEST(WorkpieceErrors, OfLinearAxesAloneAreOneExpansionEach) {
  const Machine mill = machine_anywhere("w X' b Y Z t", false);
  const ErrorSet errors = WorkpieceErrors(mill, kPart, kWarmer).with({});
  ASSERT_EQ(errors.motions.size(), 3U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(errors.motions[axis].axis, axis);
    EXPECT_EQ(errors.motions[axis].component, static_cast<Component>(axis));
    EXPECT_EQ(errors.motions[axis].coefficients[0], 0);
  }
  EXPECT_EQ(errors.tool_offset_error, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace abbe
