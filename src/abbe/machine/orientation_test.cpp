#include "abbe/machine/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double angle() { return std::uniform_real_distribution<double>(-pi, pi)(generator_); }
  Vector3d direction() {
    std::normal_distribution<double> normal;
    return Vector3d(normal(generator_), normal(generator_), normal(generator_)).normalized();
  }

 private:
  std::mt19937_64 generator_;
};

/// Angle brought into (-pi, pi].
double wrapped(double angle) { return std::remainder(angle, 2 * pi); }

TEST(Orientation, AnglesKeepTheirDigitsNearZeroAndHalfATurn) {
  for (double angle : {1e-12, 1e-8, 1e-4, 1.0}) {
    const Vector3d turned = rotation_about(Vector3d::UnitX(), angle) * Vector3d::UnitZ();
    EXPECT_NEAR(angle_between(Vector3d::UnitZ(), turned), angle, 1e-15 * (1 + angle));
    EXPECT_NEAR(angle_between(-Vector3d::UnitZ(), turned), pi - angle, 1e-15 * pi);
    EXPECT_NEAR(angle_about(Vector3d::UnitX(), Vector3d::UnitZ(), turned), angle, 1e-15 * (1 + angle));
  }
}

TEST(Orientation, TwoAxesOfAnyDirectionsReachADirectionOnBothBranches) {
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d axes[2] = {random.direction(), random.direction()};
    const Vector3d start = random.direction();
    const double angles[2] = {random.angle(), random.angle()};
    const Vector3d target = rotation_about(axes[0], angles[0]) * rotation_about(axes[1], angles[1]) * start;
    const RotaryBranches branches = turn_direction(axes, start, target, 0);
    ASSERT_EQ(branches.count, 2);
    bool found = false;
    for (const RotaryAngles& branch : branches.branch) {
      const Vector3d reached =
          rotation_about(axes[0], branch.angle[0]) * rotation_about(axes[1], branch.angle[1]) * start;
      EXPECT_LE((reached - target).norm(), 1e-13);
      EXPECT_EQ(branch.miss, 0);
      found = found || (std::abs(wrapped(branch.angle[0] - angles[0])) < 1e-9 &&
                        std::abs(wrapped(branch.angle[1] - angles[1])) < 1e-9);
    }
    EXPECT_TRUE(found);
  }
}

TEST(Orientation, SmallTiltsOfAForkHeadKeepAllDigits) {
  const Vector3d axes[2] = {Vector3d::UnitZ(), Vector3d::UnitX()};
  for (double tilt : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const Vector3d target = rotation_about(axes[0], 0.7) * Vector3d(0, -std::sin(tilt), std::cos(tilt));
    const RotaryBranches branches = turn_direction(axes, Vector3d::UnitZ(), target, 0);
    ASSERT_EQ(branches.count, 2);
    EXPECT_NEAR(std::abs(branches.branch[0].angle[1]), tilt, 2e-16);
    EXPECT_NEAR(std::abs(branches.branch[1].angle[1]), tilt, 2e-16);
    EXPECT_NEAR(branches.branch[0].margin, tilt, 2e-16);
  }
}

TEST(Orientation, ATargetAlongTheFirstAxisLeavesItFreeAndHeld) {
  const Vector3d axes[2] = {Vector3d::UnitZ(), Vector3d::UnitX()};
  for (double sign : {1.0, -1.0}) {
    const RotaryBranches branches = turn_direction(axes, Vector3d::UnitZ(), sign * Vector3d::UnitZ(), 0.6);
    ASSERT_EQ(branches.count, 1);
    EXPECT_EQ(branches.branch[0].singularity, RotarySingularity::first_axis_free);
    EXPECT_EQ(branches.branch[0].angle[0], 0.6);
    EXPECT_NEAR(std::abs(branches.branch[0].angle[1]), sign > 0 ? 0 : pi, 1e-15);
    EXPECT_LE(branches.branch[0].miss, 1e-15);
  }
}

TEST(Orientation, OutOfReachTheNearestDirectionIsGivenWithItsMiss) {
  Random random(2);
  int out_of_reach = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d axes[2] = {random.direction(), random.direction()};
    const Vector3d start = random.direction(), target = random.direction();
    const RotaryBranches branches = turn_direction(axes, start, target, 0);
    const RotaryAngles& best = branches.branch[0];
    const Vector3d reached = rotation_about(axes[0], best.angle[0]) * rotation_about(axes[1], best.angle[1]) * start;
    EXPECT_NEAR(angle_between(reached, target), best.miss, 1e-7);
    if (best.miss == 0) continue;
    ++out_of_reach;
    EXPECT_EQ(branches.count, 1);
    EXPECT_EQ(best.singularity, RotarySingularity::branches_meet);
    // No pair of angles on a grid comes nearer.
    double nearest = pi;
    for (int k = 0; k < 360; ++k) {
      const Vector3d turned = rotation_about(axes[1], k * pi / 180) * start;
      // The best first angle for that second one: turn it into the target's half plane.
      const Vector3d seen = rotation_about(axes[0], angle_about(axes[0], turned, target)) * turned;
      nearest = std::min(nearest, angle_between(seen, target));
    }
    EXPECT_GE(nearest, best.miss - 1e-12);
    EXPECT_LE(nearest, best.miss + 0.02);
  }
  EXPECT_GT(out_of_reach, 50);
}

TEST(Orientation, ThreeAxesOfAnyDirectionsReachAFrameOnBothBranches) {
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d axes[3] = {random.direction(), random.direction(), random.direction()};
    const double angles[3] = {random.angle(), random.angle(), random.angle()};
    Matrix3d target = Matrix3d::Identity();
    for (std::size_t k = 0; k < 3; ++k) target = target * rotation_about(axes[k], angles[k]);
    const RotaryBranches branches = turn_frame(axes, target, 0);
    ASSERT_EQ(branches.count, 2);
    bool found = false;
    for (const RotaryAngles& branch : branches.branch) {
      EXPECT_LE(branch.miss, 1e-13);
      bool same = true;
      for (std::size_t k = 0; k < 3; ++k) same = same && std::abs(wrapped(branch.angle[k] - angles[k])) < 1e-8;
      found = found || same;
    }
    EXPECT_TRUE(found);
  }
}

TEST(Orientation, FewerThanThreeAxesGiveTheNearestFrame) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vector3d axes[2] = {random.direction(), random.direction()};
    const Matrix3d target = rotation_about(random.direction(), random.angle());
    const RotaryAngles two = turn_frame(axes, target, 0).branch[0];
    const RotaryAngles one = turn_frame(std::span(axes, 1), target, 0).branch[0];
    EXPECT_LE(two.miss, one.miss + 1e-12);
    for (int k = 0; k < 400; ++k) {
      const double a = random.angle(), b = random.angle();
      const Matrix3d turned = rotation_about(axes[0], a) * rotation_about(axes[1], b);
      EXPECT_GE(rotation_vector(turned.transpose() * target).norm(), two.miss - 1e-12);
      EXPECT_GE(rotation_vector(rotation_about(axes[0], a).transpose() * target).norm(), one.miss - 1e-12);
    }
    const Matrix3d reachable = rotation_about(axes[0], 0.3) * rotation_about(axes[1], -2.1);
    const RotaryAngles exact = turn_frame(axes, reachable, 0).branch[0];
    EXPECT_LE(exact.miss, 1e-14);
    EXPECT_NEAR(wrapped(exact.angle[0] - 0.3), 0, 1e-12 / std::sin(angle_between(axes[0], axes[1])));
  }
}

}  // namespace
}  // namespace abbe
