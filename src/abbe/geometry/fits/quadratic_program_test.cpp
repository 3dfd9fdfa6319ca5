#include "abbe/geometry/fits/quadratic_program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>

#include "abbe/geometry/fits/numbers_for_test.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Smallest t that no distance from a line exceeds: each is the largest of many components across the line, whose
/// slopes are nearly the same, so that more rows hold at the solution than it has unknowns.
TEST(QuadraticProgram, ManyRowsThatHoldTogetherEndAtTheirSolution) {
  constexpr Index kPoints = 12, kAround = 24, kParameters = 4;
  constexpr double kNear[] = {0, -0.01, 0.01, -0.03, 0.03, -0.1, 0.1};
  constexpr Index kRows = kAround + std::size(kNear);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::Numbers numbers(2026 + seed);
    MatrixXd rows(kRows * kPoints, kParameters + 1);
    VectorXd bound(kRows * kPoints);
    for (Index k = 0; k < kPoints; ++k) {
      // The line may move and tilt; the point is anywhere along it.
      const double along = numbers.uniform(-1, 1), own = std::numbers::pi * numbers.uniform(-1, 1);
      const double distance = 1 + 0.01 * numbers.uniform(-1, 1);
      for (Index r = 0; r < kRows; ++r) {
        const double turn =
            r < kAround ? (static_cast<double>(r) + 0.5) * 2 * std::numbers::pi / kAround : kNear[r - kAround];
        const double c = std::cos(own + turn), s = std::sin(own + turn);
        rows.row(kRows * k + r) << -c, -s, -along * c, -along * s, -1;
        bound[kRows * k + r] = -distance * std::cos(turn);
      }
    }
    VectorXd x = VectorXd::Unit(kParameters + 1, kParameters) * 2;
    const VectorXd cost = VectorXd::Unit(kParameters + 1, kParameters);
    const VectorXd lambda = quadratic_program(rows, bound, cost, MatrixXd::Zero(kParameters + 1, kParameters + 1), x);
    ASSERT_EQ(lambda.size(), bound.size()) << "seed " << seed;
    EXPECT_GE(lambda.minCoeff(), 0) << "seed " << seed;
    EXPECT_LT((cost + rows.transpose() * lambda).cwiseAbs().maxCoeff(), 1e-8) << "seed " << seed;
    EXPECT_LT((rows * x - bound).maxCoeff(), 1e-12) << "seed " << seed;
    EXPECT_NEAR(x[kParameters], -bound.dot(lambda), 1e-8) << "seed " << seed;  // value of the dual problem
  }
}

}  // namespace
}  // namespace abbe::fits
