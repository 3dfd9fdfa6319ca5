#include "abbe/identify/trust/sample_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace abbe {
namespace {

using Eigen::Index;

Eigen::MatrixXd drawn(Index p, Index n) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd samples(p, n);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < p; ++k) samples(k, i) = normal(random) + (k > 0 ? 0.5 * samples(k - 1, i) : 0);
  return samples;
}

SampleMoments moments(const Eigen::MatrixXd& samples, const WorkDriver& driver = {}) {
  return sample_moments(samples, 2, driver, [] { return std::uint64_t{1}; });
}

void expect_moments_of_definition(const Eigen::MatrixXd& samples, double relative) {
  const SampleMoments found = moments(samples);
  const Eigen::VectorXd mean = samples.rowwise().mean();
  const Eigen::MatrixXd centred = samples.colwise() - mean;
  const Eigen::MatrixXd covariance = centred * centred.transpose() / static_cast<double>(samples.cols() - 1);
  const double spread = std::sqrt(covariance.diagonal().maxCoeff());
  EXPECT_LE((found.mean - mean).cwiseAbs().maxCoeff(), relative * (spread + mean.cwiseAbs().maxCoeff()));
  EXPECT_LE((found.covariance - covariance).cwiseAbs().maxCoeff(), relative * spread * spread);
  EXPECT_EQ(found.covariance, found.covariance.transpose());
}

TEST(SampleMoments, agree_with_their_definition_for_any_number_of_samples) {
  for (const Index n : {2, 3, 255, 257, 16383, 16384, 16385, 16386, 50000}) {
    SCOPED_TRACE(n);
    expect_moments_of_definition(drawn(5, n), 1e-12);
  }
}

TEST(SampleMoments, a_mean_far_from_zero_does_not_take_digits_from_the_covariance) {
  Eigen::MatrixXd samples = drawn(3, 40000);
  const SampleMoments near = moments(samples);
  samples.array() += 1e6;
  const SampleMoments far = moments(samples);
  // What adding 1e6 has rounded off the samples, 6e-11, is all that may be missing.
  EXPECT_LE((far.covariance - near.covariance).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LE((far.mean - near.mean).cwiseAbs().maxCoeff() - 1e6, 1e-9);
}

TEST(SampleMoments, samples_that_are_all_equal_have_no_covariance) {
  const SampleMoments found = moments(Eigen::MatrixXd::Constant(2, 20000, 0.1));
  EXPECT_LE(found.covariance.cwiseAbs().maxCoeff(), 1e-27) << "the square of what the mean is rounded by";
}

TEST(SampleMoments, have_the_same_bits_if_blocks_come_as_bytes_and_backwards) {
  const Eigen::MatrixXd samples = drawn(4, 70000);
  const auto by_bytes = [](const NumberedWork& work) {
    std::vector<std::vector<std::byte>> bytes(work.blocks);
    for (std::size_t block = work.blocks; block-- > 0;) {
      work.compute(block);
      work.pack(block, bytes[block]);
    }
    // Of each block the results are overwritten by what the bytes say.
    for (std::size_t block = 0; block < work.blocks; ++block) work.unpack(block, bytes[block]);
  };
  const SampleMoments one = moments(samples), other = moments(samples, by_bytes);
  EXPECT_EQ(one.mean, other.mean);
  EXPECT_EQ(one.covariance, other.covariance);
}

TEST(SampleMoments, a_sample_that_is_not_finite_makes_the_mean_so) {
  Eigen::MatrixXd samples = drawn(2, 20000);
  samples(1, 19000) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isfinite(moments(samples).mean[0]));
  EXPECT_FALSE(std::isfinite(moments(samples).mean[1]));
}

}  // namespace
}  // namespace abbe
