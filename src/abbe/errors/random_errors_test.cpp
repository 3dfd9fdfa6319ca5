#include "abbe/errors/random_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

Machine machine() {
  Machine m;
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  c.point = {700, 0, -100};
  c.endless = true;
  Axis x{.name = "X", .kind = AxisKind::linear, .side = ChainSide::workpiece, .primed = true};
  x.travel_max = 1400;
  Axis z{.name = "Z", .kind = AxisKind::linear, .side = ChainSide::tool};
  z.direction = Eigen::Vector3d::UnitZ();
  z.travel_min = -100;
  z.travel_max = 500;
  Axis a{.name = "A", .kind = AxisKind::rotary, .side = ChainSide::tool};
  a.point = {0, 0, 300};
  a.travel_min = -1.5;
  a.travel_max = 1.5;
  m.axes = {c, x, z, a};
  m.tool_reference = {0, 0, 300};
  m.tool_offset = {0, 0, -120};
  return m;
}

TEST(RandomErrors, SameSeedSameErrorsAndAnotherSeedOthers) {
  RandomErrorOptions options;
  const ErrorSet one = random_errors(machine(), options), two = random_errors(machine(), options);
  EXPECT_EQ(one.parameters(), two.parameters());
  options.seed = 2;
  EXPECT_NE(one.parameters(), random_errors(machine(), options).parameters());
}

TEST(RandomErrors, DrawsEveryMotionAndEveryValidLocationError) {
  const Machine m = machine();
  const ErrorSet errors = random_errors(m, {});
  EXPECT_EQ(errors.motions.size(), 24u);
  std::size_t valid = 0;
  for (const Axis& axis : m.axes) {
    for (int c = 0; c < kComponentCount; ++c) valid += location_error_is_valid(axis, static_cast<Component>(c));
  }
  EXPECT_EQ(errors.locations.size(), valid);
  for (double q : {-0.5, 0.0, 3.0, 7.0}) EXPECT_TRUE(errors.covers(0, q));
  EXPECT_TRUE(errors.covers(2, -100));
  EXPECT_FALSE(errors.covers(2, -101));
}

TEST(RandomErrors, ChoosingFewerErrorsDoesNotChangeThem) {
  RandomErrorOptions options;
  const ErrorSet all = random_errors(machine(), options);
  options.only = {"EXX", "EB0C"};
  const ErrorSet some = random_errors(machine(), options);
  ASSERT_EQ(some.motions.size(), 1u);
  ASSERT_EQ(some.locations.size(), 1u);
  EXPECT_EQ(some.motions[0], all.motions[6]);
  options.only = {"EXQ"};
  EXPECT_THROW(random_errors(machine(), options), std::invalid_argument);
}

TEST(RandomErrors, CoefficientsDecayAndConstantsAreLeftOut) {
  RandomErrorOptions options;
  options.decay = 0.5;
  double squares[5] = {};
  for (options.seed = 1; options.seed <= 300; ++options.seed) {
    for (const ErrorMotion& motion : random_errors(machine(), options).motions) {
      if (motion.axis != 1 || is_rotation(motion.component)) continue;
      for (std::size_t k = 0; k < 5; ++k) squares[k] += std::pow(1e3 * motion.coefficients[k], 2) / 900;
    }
  }
  EXPECT_EQ(squares[0], 0);
  double expected = 10;
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_NEAR(std::sqrt(squares[k]), expected, 0.1 * expected) << k;
    expected *= 0.5;
  }
}

TEST(RandomErrors, ScalingReachesTheStatedMeanAndMaximumByAnIndependentRoute) {
  const Machine m = machine();
  for (const VolumetricMeasure measure : {VolumetricMeasure::mean, VolumetricMeasure::maximum}) {
    ErrorSet errors = random_errors(m, {});
    errors.tool_offset_error = {0.01, 0, 0};
    VolumetricTarget target{.measure = measure, .value_um = 500};
    const double factor = scale_errors(m, errors, target);
    EXPECT_GT(factor, 0);
    EXPECT_NEAR(1e3 * volumetric_error(m, errors, target), 500, 1e-6);
    EXPECT_NEAR(errors.tool_offset_error.x(), 0.01 * factor, 1e-12);
    // The same by single poses at random.
    RandomStream random(4);
    double sum = 0, largest = 0;
    for (int k = 0; k < 3000; ++k) {
      Deviation deviation;
      const std::vector<double> q{random.uniform(0, 6.28), random.uniform(0, 1400), random.uniform(-100, 500),
                                  random.uniform(-1.5, 1.5)};
      ASSERT_EQ(tool_deviation(m, errors, q, deviation), PoseStatus::ok);
      sum += 1e3 * deviation.head<3>().norm() / 3000;
      largest = std::max(largest, 1e3 * deviation.head<3>().norm());
    }
    const double independent = measure == VolumetricMeasure::mean ? sum : largest;
    // The grid includes the ends of the travel, where the errors are largest.
    EXPECT_NEAR(independent, 450, 100);
  }
}

TEST(RandomErrors, RemovingTheRigidPartLeavesLess) {
  const Machine m = machine();
  const ErrorSet errors = random_errors(m, {});
  VolumetricTarget target;
  const double all = volumetric_error(m, errors, target);
  target.remove_rigid_motion = true;
  const double rest = volumetric_error(m, errors, target);
  EXPECT_LT(rest, 0.95 * all);
  EXPECT_GT(rest, 0.05 * all);
  ErrorSet scaled = errors;
  target.value_um = 30;
  EXPECT_GT(scale_errors(m, scaled, target), 0);
  EXPECT_NEAR(volumetric_error(m, scaled, target), 0.03, 1e-10);
}

TEST(RandomErrors, ErrorsWithoutEffectCannotBeScaled) {
  ErrorSet none;
  EXPECT_EQ(scale_errors(machine(), none, {}), 0);
}

TEST(Poses, GridBlocksAgreeWithSinglePoses) {
  PoseGrid grid{{{1, 2, 3}, {10, 20}, {5, 6, 7, 8}}};
  const PoseSource source = pose_source(grid);
  ASSERT_EQ(source.count, 24u);
  for (std::size_t first = 0; first < 24; ++first) {
    for (std::size_t number = 1; first + number <= 24; number += 5) {
      double a[24], b[24], c[24];
      double* axis[] = {a, b, c};
      source.fill(first, number, axis);
      for (std::size_t k = 0; k < number; ++k) {
        const std::size_t i = first + k;
        EXPECT_EQ(a[k], grid.values[0][i / 8]);
        EXPECT_EQ(b[k], grid.values[1][i / 4 % 2]);
        EXPECT_EQ(c[k], grid.values[2][i % 4]);
      }
    }
  }
}

}  // namespace
}  // namespace abbe
