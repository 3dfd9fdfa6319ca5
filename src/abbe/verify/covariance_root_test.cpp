#include "abbe/verify/covariance_root.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace abbe {
namespace {

TEST(CovarianceRoot, ItsProductIsTheCovarianceInMmBesideRad) {
  Eigen::Matrix4d factor;
  factor << 1e-2, 0, 0, 0, 3e-3, 2e-3, 0, 0, 1e-6, -2e-6, 5e-7, 0, 0, 0, 0, 0;  // the last one is known exactly
  const Eigen::MatrixXd covariance = factor * factor.transpose();
  const Eigen::MatrixXd root = covariance_root(covariance);
  const Eigen::MatrixXd again = root * root.transpose();
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      EXPECT_NEAR(again(i, j), covariance(i, j), 1e-14 * scale) << i << ' ' << j;
    }
  }
}

TEST(CovarianceRoot, OfNoParametersIsEmpty) { EXPECT_EQ(covariance_root(Eigen::MatrixXd(0, 0)).size(), 0); }

TEST(CovarianceRoot, WhatIsNoCovarianceIsRefused) {
  EXPECT_THROW(covariance_root((Eigen::Matrix2d() << 1, 2, 2, 1).finished()), std::invalid_argument);
  EXPECT_THROW(covariance_root((Eigen::Matrix2d() << -1, 0, 0, 1).finished()), std::invalid_argument);
  EXPECT_THROW(covariance_root(Eigen::MatrixXd::Constant(1, 1, std::numeric_limits<double>::quiet_NaN())),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
