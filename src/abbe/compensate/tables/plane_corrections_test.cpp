#include "abbe/compensate/tables/plane_corrections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "abbe/compensate/tables/line_tables.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

LatticeOptions all_linear(const Machine& machine, const ErrorSet& errors) {
  LatticeOptions options;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::linear) continue;
    options.inputs.push_back(i);
    options.outputs.push_back(i);
  }
  options.reference = middle_of_travel(machine, errors);
  return options;
}

CorrectionSum all_planes(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options) {
  std::vector<std::unique_ptr<CommandCorrection>> parts;
  for (std::size_t pair = 0; pair < axis_pairs(options.inputs).size(); ++pair) {
    parts.push_back(std::make_unique<PlaneCorrection>(machine, errors, options, pair));
  }
  return CorrectionSum(std::move(parts));
}

PoseList random_poses(const Machine& machine, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  PoseList poses;
  for (std::size_t k = 0; k < count; ++k) poses.append(test::random_commands(machine, generator));
  return poses;
}

TEST(PlaneCorrections, AreOnePerTwoAxes) {
  using Pairs = std::vector<std::array<std::size_t, 2>>;
  EXPECT_EQ(axis_pairs({4, 2}), (Pairs{{4, 2}}));
  EXPECT_EQ(axis_pairs({0, 1, 2}), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_TRUE(axis_pairs({3}).empty());
}

TEST(PlaneCorrections, OfThreeAxesLeaveOfTheShiftWhatIsOfSecondOrderInTheErrors) {
  const Machine machine = test::three_axis_mill();
  const PoseList poses = random_poses(machine, 500, 3);
  // Errors a tenth as large leave a hundredth: what is left are products of errors.
  double left[2] = {0, 0}, before[2] = {0, 0};
  for (int run = 0; run < 2; ++run) {
    ErrorSet errors = random_errors(machine, {});
    const double scale = run == 0 ? 1 : 0.1;
    for (ErrorMotion& motion : errors.motions) {
      for (double& coefficient : motion.coefficients) coefficient *= scale;
    }
    for (LocationError& location : errors.locations) location.value *= scale;
    errors.tool_offset_error *= scale;
    PoseList added;
    all_planes(machine, errors, all_linear(machine, errors)).evaluate(poses, added);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const std::vector<double> pose = poses.pose(k);
      std::vector<double> corrected = pose;
      for (std::size_t i = 0; i < corrected.size(); ++i) corrected[i] += added.axis[i][k];
      const Eigen::Vector3d wanted = nominal_workpiece_from_tool(machine, pose).translation;
      before[run] =
          std::max(before[run], (actual_workpiece_from_tool(machine, errors, pose).translation - wanted).norm());
      left[run] =
          std::max(left[run], (actual_workpiece_from_tool(machine, errors, corrected).translation - wanted).norm());
    }
  }
  EXPECT_GT(before[0], 0.02);
  EXPECT_LT(left[0], 2e-3 * before[0]);
  EXPECT_NEAR(before[1], 0.1 * before[0], 1e-3 * before[0]);
  EXPECT_LT(left[1], 0.02 * left[0]);
}

TEST(PlaneCorrections, AreTheWholeCorrectionOnPlanesThroughTheReferenceAndOfTwoAxesEverywhere) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = random_errors(machine, {});
  LatticeOptions options = all_linear(machine, errors);
  for (std::size_t held = 0; held < 3; ++held) {
    PoseList poses = random_poses(machine, 50, 4 + held);
    std::fill(poses.axis[held].begin(), poses.axis[held].end(), options.reference[held]);
    PoseList sum, whole;
    all_planes(machine, errors, options).evaluate(poses, sum);
    LatticeFunction(machine, errors, options).evaluate(poses, whole);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < poses.count(); ++k) EXPECT_NEAR(sum.axis[i][k], whole.axis[i][k], 1e-12);
    }
  }
  options.inputs = {0, 2};
  const PoseList poses = random_poses(machine, 50, 7);
  PoseList plane, whole;
  PlaneCorrection(machine, errors, options, 0).evaluate(poses, plane);
  LatticeFunction(machine, errors, options).evaluate(poses, whole);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(plane.axis[i], whole.axis[i]);
}

}  // namespace
}  // namespace abbe
