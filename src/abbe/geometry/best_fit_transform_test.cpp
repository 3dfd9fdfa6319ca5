#include "abbe/geometry/best_fit_transform.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

struct Cloud {
  std::vector<Vector3d> source, target;
  RigidTransform truth;
};

Cloud cloud(std::uint64_t seed, std::size_t count, double noise) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 1);
  const auto vector = [&](double size) {
    return Vector3d(size * uniform(generator), size * uniform(generator), size * uniform(generator));
  };
  Cloud result;
  result.truth = {rotation_from_vector(vector(3)), vector(2000)};
  for (std::size_t i = 0; i < count; ++i) {
    result.source.push_back(vector(500));
    const Vector3d e(normal(generator), normal(generator), normal(generator));
    result.target.push_back(result.truth * result.source.back() + noise * e);
  }
  return result;
}

double difference(const RigidTransform& a, const RigidTransform& b) {
  return (a.rotation - b.rotation).norm() * 500 + (a.translation - b.translation).norm();
}

TEST(BestFitTransform, FindsTheExactMotionOfExactPoints) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Cloud c = cloud(seed, 3 + seed, 0);
    const BestFitTransform fit = best_fit_transform(c.source, c.target);
    ASSERT_EQ(fit.status, BestFitStatus::ok);
    EXPECT_LT(difference(fit.target_from_source, c.truth), 1e-9) << seed;
    EXPECT_LT(fit.rms, 1e-10);
  }
}

TEST(BestFitTransform, IsAMinimumOfTheWeightedSquares) {
  const Cloud c = cloud(7, 12, 5.0);
  std::vector<double> weights;
  for (int i = 0; i < 12; ++i) weights.push_back(0.1 + i % 4);
  const auto sum = [&](const RigidTransform& t) {
    double total = 0;
    for (std::size_t i = 0; i < 12; ++i) total += weights[i] * (c.target[i] - t * c.source[i]).squaredNorm();
    return total;
  };
  const BestFitTransform fit = best_fit_transform(c.source, c.target, weights);
  const double least = sum(fit.target_from_source);
  for (int k = 0; k < 6; ++k) {
    for (double sign : {-1.0, 1.0}) {
      RigidTransform moved = fit.target_from_source;
      if (k < 3) moved.translation[k] += sign * 1e-3;
      if (k >= 3) moved.rotation = rotation_about(Vector3d::Unit(k - 3), sign * 1e-6) * moved.rotation;
      // Turning about the origin also shifts; take the shift of the centre out again.
      EXPECT_GT(sum(moved), least);
    }
  }
  EXPECT_GT(std::abs(difference(best_fit_transform(c.source, c.target).target_from_source, fit.target_from_source)),
            1e-3);
}

TEST(BestFitTransform, NeverReflects) {
  Cloud c = cloud(8, 20, 0);
  for (Vector3d& p : c.target) p.x() = -p.x();
  EXPECT_NEAR(best_fit_transform(c.source, c.target).target_from_source.rotation.determinant(), 1, 1e-12);
}

TEST(BestFitTransform, SolvesPlanarPoints) {
  Cloud c = cloud(9, 8, 0);
  for (std::size_t i = 0; i < c.source.size(); ++i) {
    c.source[i].z() = 0;
    c.target[i] = c.truth * c.source[i];
  }
  const BestFitTransform fit = best_fit_transform(c.source, c.target);
  EXPECT_EQ(fit.status, BestFitStatus::ok);
  EXPECT_LT(difference(fit.target_from_source, c.truth), 1e-9);
}

TEST(BestFitTransform, SaysWhichRotationPointsOnALineLeaveOpen) {
  Cloud c = cloud(10, 6, 0);
  const Vector3d direction = Vector3d(1, 2, -3).normalized();
  for (std::size_t i = 0; i < c.source.size(); ++i) {
    c.source[i] = Vector3d(1000, 50, 3) + 100.0 * static_cast<double>(i * i) * direction;
    c.target[i] = c.truth * c.source[i];
  }
  const BestFitTransform fit = best_fit_transform(c.source, c.target);
  ASSERT_EQ(fit.status, BestFitStatus::collinear);
  EXPECT_NEAR(std::abs(fit.undetermined_direction.dot(c.truth.rotation * direction)), 1, 1e-12);
  EXPECT_LT(fit.rms, 1e-9);
}

TEST(BestFitTransform, SaysWhenPointsAreTooFewOrOne) {
  const std::vector<Vector3d> same(5, Vector3d(1, 2, 3));
  EXPECT_EQ(best_fit_transform(same, same).status, BestFitStatus::coincident);
  EXPECT_EQ(best_fit_transform(std::span(same).first(2), std::span(same).first(2)).status,
            BestFitStatus::too_few_points);
  EXPECT_EQ(BestFitTransform().status, BestFitStatus::not_run);
}

TEST(RobustBestFit, SurvivesFortyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Cloud c = cloud(seed, 60, 0.02);
    std::mt19937_64 generator(seed + 1000);
    std::uniform_real_distribution<double> uniform(-300, 300);
    // A common shift is the hardest: the outliers agree with each other.
    const Vector3d shift(120, -60, 80);
    for (std::size_t i = 0; i < 24; ++i) {
      c.target[i] += seed % 2 ? shift : Vector3d(uniform(generator), uniform(generator), uniform(generator));
    }
    const BestFitTransform fit = robust_best_fit_transform(c.source, c.target);
    ASSERT_EQ(fit.status, BestFitStatus::ok) << seed;
    EXPECT_LT(difference(fit.target_from_source, c.truth), 0.06) << seed;
    EXPECT_GT(difference(best_fit_transform(c.source, c.target).target_from_source, c.truth), 5) << seed;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < 60; ++i) wrong += fit.inliers[i] != (i >= 24);
    EXPECT_LE(wrong, 2u) << seed;
  }
}

TEST(RobustBestFit, LosesLittleOnCleanDataAndGivesTheNoise) {
  double robust = 0, plain = 0, scale = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Cloud c = cloud(seed, 50, 0.1);
    const BestFitTransform fit = robust_best_fit_transform(c.source, c.target);
    robust += std::pow(difference(fit.target_from_source, c.truth), 2);
    plain += std::pow(difference(best_fit_transform(c.source, c.target).target_from_source, c.truth), 2);
    scale += fit.scale / 100;
  }
  EXPECT_LT(robust / plain, 1.15);
  EXPECT_NEAR(scale, 0.1, 0.005);
}

TEST(RobustBestFit, IsTheSameEveryTime) {
  const Cloud c = cloud(3, 500, 0.1);
  const BestFitTransform first = robust_best_fit_transform(c.source, c.target);
  EXPECT_EQ(difference(first.target_from_source, robust_best_fit_transform(c.source, c.target).target_from_source), 0);
}

TEST(RobustBestFit, AdmitsThatUnrelatedPointsHaveNoCommonMotion) {
  const Cloud a = cloud(4, 100, 0), b = cloud(5, 100, 0);
  EXPECT_EQ(robust_best_fit_transform(a.source, b.target).status, BestFitStatus::no_consensus);
}

TEST(RobustBestFit, WorksOnExactData) {
  const Cloud c = cloud(6, 40, 0);
  const BestFitTransform fit = robust_best_fit_transform(c.source, c.target);
  EXPECT_EQ(fit.status, BestFitStatus::ok);
  EXPECT_LT(difference(fit.target_from_source, c.truth), 1e-8);
}

}  // namespace
}  // namespace abbe
