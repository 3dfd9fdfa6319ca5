#include "abbe/identify/variance_components.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/pose_noise_for_test.h"

namespace abbe {
namespace {

using test::DenseReadings;
using test::PoseObservations;
constexpr VarianceComponentChoice kBoth{.variance_factor = true, .pose_noise = true};

/// The restricted likelihood with whole matrices. A prior is one more observation of known variance.
struct DenseLikelihood {
  DenseReadings dense;
  Eigen::MatrixXd rows;  // J with the prior's row

  DenseLikelihood(const Observations& observations, std::size_t poses, double prior_uncertainty)
      : dense(observations, {}, poses) {
    rows = Eigen::MatrixXd::Zero(dense.jacobian.rows() + 1, dense.jacobian.cols());
    rows.topRows(dense.jacobian.rows()) = dense.jacobian;
    rows(rows.rows() - 1, 0) = 1 / prior_uncertainty;
  }
  Eigen::MatrixXd covariance(double factor, double pose) const {
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
    v.topLeftCorner(rows.rows() - 1, rows.rows() - 1) = dense.covariance(factor, pose);
    v(rows.rows() - 1, rows.rows() - 1) = 1;
    return v;
  }
  Eigen::MatrixXd projected(double factor, double pose) const {
    const Cholesky v(covariance(factor, pose));
    const Eigen::MatrixXd solved = v.solve_columns(rows);
    const Eigen::MatrixXd inverse = v.solve_columns(Eigen::MatrixXd::Identity(rows.rows(), rows.rows()));
    return inverse - solved * Cholesky(rows.transpose() * solved).solve_columns(solved.transpose());
  }
  double value(const Eigen::VectorXd& residuals, double factor, double pose) const {
    const Cholesky v(covariance(factor, pose));
    const Eigen::MatrixXd normal = rows.transpose() * v.solve_columns(rows);
    return -v.diagonal().array().log().sum() - Cholesky(normal).diagonal().array().log().sum() -
           0.5 * residuals.dot(projected(factor, pose) * residuals);
  }
};

struct PoseProblem {
  std::size_t poses;
  PoseObservations observations;
  Problem problem;
  PoseProblem(std::uint64_t seed, std::size_t pose_count, std::size_t per_pose, double factor, double noise)
      : poses(pose_count),
        observations(pose_count, PoseObservations::simulate(seed, pose_count, per_pose, factor, noise)),
        problem(function_problem({&observations})) {}
};

TEST(RestrictedLikelihood, agrees_with_whole_matrices_and_its_finite_differences) {
  PoseProblem one(11, 14, 3, 1.5, 0.04);
  one.problem.priors.push_back({estimated_parameters(one.problem)[0].id, 1.02, 0.01});
  // Residuals of the start, which the linear model turns into those of any weights.
  const DenseLikelihood dense(one.observations, one.poses, 0.01);
  Eigen::VectorXd at_start(dense.rows.rows());
  at_start << dense.dense.residuals, (1.02 - one.observations.unknown_values()[0]) / 0.01;
  for (const ReadingVariance variance : {ReadingVariance{1.3, 0.001}, ReadingVariance{0.8, 0}}) {
    WeighedObservations weighed(borrowed(one.observations), {});
    weighed.weigh(variance);
    Problem problem = one.problem;
    problem.observations[0].observations = borrowed(weighed);
    const Identification fit = identify(problem);
    ASSERT_EQ(fit.status, IdentifyStatus::converged);
    const RestrictedLikelihood found = restricted_likelihood(problem, fit);
    one.observations.start({0.5, -0.4, 0.2, 0.9, 0});

    const double factor = variance.factor, pose = variance.pose;
    const Eigen::MatrixXd p = dense.projected(factor, pose);
    const Eigen::Index n = p.rows() - 1;
    Eigen::MatrixXd by[2] = {Eigen::MatrixXd::Zero(n + 1, n + 1), Eigen::MatrixXd::Zero(n + 1, n + 1)};
    by[0].topLeftCorner(n, n).setIdentity();
    by[1].topLeftCorner(n, n) = dense.dense.displacement * dense.dense.displacement.transpose();
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l < 2; ++l) {
        const Eigen::MatrixXd left = p * by[k], right = p * by[l];
        const double expected = 0.5 * left.cwiseProduct(right.transpose()).sum();
        EXPECT_NEAR(found.information(k, l) / expected, 1, 1e-8) << k << l;
      }
    const double h = 1e-4, hp = pose > 0 ? 1e-4 * pose : 1e-8;
    const double by_factor =
        (dense.value(at_start, factor + h, pose) - dense.value(at_start, factor - h, pose)) / (2 * h);
    // A variance of -1e-8 mm^2 still leaves the covariance positive.
    const double by_pose =
        (dense.value(at_start, factor, pose + hp) - dense.value(at_start, factor, pose - hp)) / (2 * hp);
    EXPECT_NEAR(found.score[0] / by_factor, 1, 1e-5);
    EXPECT_NEAR(found.score[1] / by_pose, 1, 1e-4);
  }
}

TEST(VarianceComponents, no_other_variances_are_more_likely) {
  PoseProblem one(12, 16, 3, 2, 0.03);
  const DenseLikelihood dense(one.observations, one.poses, 1e6);
  Eigen::VectorXd at_start(dense.rows.rows());
  at_start << dense.dense.residuals, 0;
  const WeighedIdentification found = identify_with_variances(one.problem, kBoth);
  ASSERT_TRUE(found.components.converged) << found.identification.message;
  const ReadingVariance& variance = found.components.variance;
  // Newton's method on a likelihood of finite differences, from far away.
  Eigen::Vector2d x(std::log(1.0), std::log(1e-3));
  const auto value = [&](double a, double b) { return dense.value(at_start, std::exp(a), std::exp(b)); };
  for (int round = 0; round < 12; ++round) {
    const double h = 1e-3, here = value(x[0], x[1]);
    const double pa = value(x[0] + h, x[1]), ma = value(x[0] - h, x[1]), pb = value(x[0], x[1] + h),
                 mb = value(x[0], x[1] - h);
    const double aa = (pa + ma - 2 * here) / (h * h), bb = (pb + mb - 2 * here) / (h * h);
    const double ab = (value(x[0] + h, x[1] + h) - value(x[0] + h, x[1] - h) - value(x[0] - h, x[1] + h) +
                       value(x[0] - h, x[1] - h)) /
                      (4 * h * h);
    Eigen::Matrix2d hessian;
    hessian << aa, ab, ab, bb;
    const Eigen::Vector2d slope((pa - ma) / (2 * h), (pb - mb) / (2 * h));
    x -= (hessian.determinant() > 0 && aa < 0) ? Eigen::Vector2d(hessian.inverse() * slope)
                                               : Eigen::Vector2d(-0.05 * slope.cwiseMin(5).cwiseMax(-5));
  }
  EXPECT_NEAR(variance.factor / std::exp(x[0]), 1, 1e-5);
  EXPECT_NEAR(variance.pose / std::exp(x[1]), 1, 1e-5);
  // By the definition of restricted likelihood the weighted residuals have the degrees of freedom as sum of squares.
  EXPECT_NEAR(found.identification.statistics.variance_factor, 1, 1e-6);
}

TEST(VarianceComponents, are_found_within_their_uncertainty) {
  constexpr int kCampaigns = 60;
  double factor_mean = 0, pose_mean = 0, factor_square = 0, pose_square = 0, factor_pull = 0, pose_pull = 0;
  for (int i = 0; i < kCampaigns; ++i) {
    PoseProblem one(static_cast<std::uint64_t>(i) + 300, 25, 3, 1.6, 0.05);
    const VarianceComponents found = identify_with_variances(one.problem, kBoth).components;
    ASSERT_TRUE(found.converged);
    const double factor = found.variance.factor - 1.6, pose = found.variance.pose - 0.05 * 0.05;
    factor_mean += factor / kCampaigns;
    pose_mean += pose / kCampaigns;
    factor_square += factor * factor / kCampaigns;
    pose_square += pose * pose / kCampaigns;
    factor_pull += factor * factor / found.covariance(0, 0) / kCampaigns;
    pose_pull += pose * pose / found.covariance(1, 1) / kCampaigns;
  }
  const double root = std::sqrt(static_cast<double>(kCampaigns));
  EXPECT_LT(std::abs(factor_mean), 3 * std::sqrt(factor_square) / root);
  EXPECT_LT(std::abs(pose_mean), 3 * std::sqrt(pose_square) / root);
  EXPECT_NEAR(factor_pull, 1, 0.6);  // 3 sqrt(2 / 60)
  EXPECT_NEAR(pose_pull, 1, 0.6);
}

TEST(VarianceComponents, one_alone_is_estimated_with_the_other_as_stated) {
  PoseProblem one(21, 30, 3, 1, 0.05);
  const WeighedIdentification pose = identify_with_variances(one.problem, {.pose_noise = true});
  ASSERT_TRUE(pose.components.converged);
  EXPECT_EQ(pose.components.variance.factor, 1);
  EXPECT_NEAR(pose.components.pose_noise(), 0.05, 4 * pose.components.pose_noise_uncertainty());
  EXPECT_GT(pose.identification.statistics.p_value, 0.001);
  EXPECT_LT(pose.components.stated_p_value, 1e-6);

  one.observations.start({0.5, -0.4, 0.2, 0.9, 0});
  const WeighedIdentification factor = identify_with_variances(one.problem, {.variance_factor = true});
  ASSERT_TRUE(factor.components.converged);
  EXPECT_EQ(factor.components.variance.pose, 0);
  // Then it is chi-square / degrees of freedom, and so is its uncertainty.
  const double freedom = factor.components.stated_degrees_of_freedom;
  EXPECT_NEAR(factor.components.variance.factor / (factor.components.stated_chi_square / freedom), 1, 1e-9);
  EXPECT_NEAR(factor.components.variance_factor_uncertainty() / factor.components.variance.factor,
              std::sqrt(2 / freedom), 1e-9);
}

TEST(VarianceComponents, without_a_common_noise_the_estimate_is_often_exactly_zero) {
  int at_zero = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    PoseProblem one(seed + 900, 20, 3, 1, 0);
    const WeighedIdentification found = identify_with_variances(one.problem, kBoth);
    ASSERT_TRUE(found.components.converged);
    at_zero += found.components.pose_noise_at_zero;
    EXPECT_EQ(found.components.pose_noise_at_zero, found.components.variance.pose == 0);
    EXPECT_GT(found.components.pose_noise_uncertainty(), 0);
    EXPECT_NEAR(found.components.variance.factor, 1, 5 * found.components.variance_factor_uncertainty());
  }
  EXPECT_NEAR(at_zero, 20, 10);  // half, and three standard deviations
}

TEST(VarianceComponents, poses_with_one_reading_do_not_tell_them_apart) {
  PoseProblem one(31, 40, 1, 1, 0.05);
  const WeighedIdentification both = identify_with_variances(one.problem, kBoth);
  EXPECT_FALSE(both.components.converged);
  EXPECT_EQ(both.identification.status, IdentifyStatus::rank_deficient);
  EXPECT_FALSE(both.identification.converged);
  EXPECT_NE(both.identification.message.find("do not tell the variance factor from the pose noise"), std::string::npos)
      << both.identification.message;
  // With stated uncertainties that are right, what is left is pose noise.
  one.observations.start({0.5, -0.4, 0.2, 0.9, 0});
  const WeighedIdentification pose = identify_with_variances(one.problem, {.pose_noise = true});
  ASSERT_TRUE(pose.components.converged);
  EXPECT_TRUE(pose.identification.converged);
  EXPECT_NEAR(pose.components.pose_noise(), 0.05, 4 * pose.components.pose_noise_uncertainty());
}

TEST(VarianceComponents, that_do_not_settle_are_no_result) {
  PoseProblem one(41, 20, 3, 1, 0.05);
  VarianceComponentChoice choice = kBoth;
  choice.max_iterations = 3;
  const WeighedIdentification found = identify_with_variances(one.problem, choice);
  EXPECT_EQ(found.identification.status, IdentifyStatus::no_convergence);
  EXPECT_FALSE(found.identification.converged);
  EXPECT_NE(found.identification.message.find("have not settled after 3"), std::string::npos);
}

/// Readings in blocks that have nothing to do with their poses: reading k belongs to block k % blocks.
TEST(VarianceComponents, noise_common_to_a_block_is_found_over_many_draws) {
  constexpr std::size_t kBlocks = 40, kPerBlock = 5, kDraws = 40;
  double mean_noise = 0, squares = 0;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    // Every reading is a pose of its own, so that poses alone would not show any common noise.
    PoseObservations observations(
        kBlocks * kPerBlock, [&] { return PoseObservations::simulate(100 + draw, kBlocks, kPerBlock, 1.44, 0.03); }());
    Problem problem = function_problem({&observations});
    for (std::size_t k = 0; k < kBlocks * kPerBlock; ++k) problem.observations[0].common.push_back(k % kBlocks);
    const WeighedIdentification found =
        identify_with_variances(problem, {.variance_factor = true, .pose_noise = true, .by_block = true});
    ASSERT_TRUE(found.components.converged) << found.identification.message;
    mean_noise += found.components.variance.pose / kDraws;
    const double deviation = (found.components.variance.pose - 0.0009) / std::sqrt(found.components.covariance(1, 1));
    squares += deviation * deviation / kDraws;
  }
  // The variance of one draw is about 0.0009 sqrt(2/115): 0.00012.
  EXPECT_NEAR(mean_noise, 0.0009, 4 * 0.00013 / std::sqrt(1.0 * kDraws));
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 1.7);
}

TEST(VarianceComponents, says_that_blocks_of_one_reading_show_nothing_in_common) {
  PoseObservations observations(30, PoseObservations::simulate(5, 30, 1, 1, 0.03));
  Problem problem = function_problem({&observations});
  for (std::size_t k = 0; k < 30; ++k) problem.observations[0].common.push_back(k);
  const WeighedIdentification found =
      identify_with_variances(problem, {.variance_factor = true, .pose_noise = true, .by_block = true});
  EXPECT_EQ(found.identification.status, IdentifyStatus::rank_deficient);
  EXPECT_NE(found.identification.message.find("block of time"), std::string::npos);
}

}  // namespace
}  // namespace abbe
