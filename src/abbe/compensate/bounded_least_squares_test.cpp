#include "abbe/compensate/bounded_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

SmallMatrix random_matrix(std::mt19937_64& generator, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  SmallMatrix a(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 0; k < columns; ++k) a(i, k) = normal(generator);
  }
  return a;
}

TEST(BoundedLeastSquares, InsideTheBallItIsTheLeastSquaresSolution) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Index rows = 1 + i % 3, columns = 1 + (i / 3) % 3;
    const SmallMatrix a = random_matrix(generator, rows, columns);
    const SmallVector b = random_matrix(generator, rows, 1);
    bool bounded = true;
    const SmallVector y = bounded_least_squares(a, b, 1e9, bounded);
    EXPECT_FALSE(bounded);
    const Eigen::VectorXd expected = CompleteOrthogonal(a).solve(b);
    EXPECT_LE((y - expected).norm(), 1e-10 * (1 + expected.norm()));
  }
}

TEST(BoundedLeastSquares, NeverLeavesTheBallAndIsLittleWorseThanTheBestOfIt) {
  std::mt19937_64 generator(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Index rows = 2 + i % 2, columns = 2 + (i / 2) % 2;
    SmallMatrix a = random_matrix(generator, rows, columns);
    if (i % 5 == 0) a.col(1) = 1e-9 * a.col(1) + a.col(0);  // nearly singular
    if (i % 7 == 0) a.col(0).setZero();
    const SmallVector b = random_matrix(generator, rows, 1);
    const double largest = i % 3 == 0 ? 0.1 : 1.0;
    bool bounded = false;
    const SmallVector y = bounded_least_squares(a, b, largest, bounded);
    EXPECT_LE(y.norm(), largest * (1 + 1e-12));
    const double left = (a * y - b).norm();
    for (int trial = 0; trial < 200; ++trial) {
      SmallVector other(columns);
      for (Eigen::Index k = 0; k < columns; ++k) other[k] = normal(generator);
      other *= largest * std::pow(0.5, trial % 4) / other.norm();
      EXPECT_GE((a * other - b).norm(), left - 0.39 * b.norm());
    }
  }
}

TEST(BoundedLeastSquares, DoesNotJumpWhileASingularValuePassesZero) {
  const double largest = 0.01;
  SmallVector b(2);
  b << 3e-5, 1e-4;
  SmallVector before;
  for (int i = -3000; i <= 3000; ++i) {
    SmallMatrix a(2, 2);
    a << 1, 0.2, 0, 1e-5 * i;
    bool bounded = false;
    const SmallVector y = bounded_least_squares(a, b, largest, bounded);
    if (std::abs(i) <= 1050) {
      EXPECT_TRUE(bounded) << i;  // |b| / largest is 0.01044, the smaller singular value 0.98e-5 i
    }
    if (std::abs(i) >= 1080) {
      EXPECT_FALSE(bounded) << i;
    }
    if (before.size() > 0) {
      EXPECT_LE((y - before).norm(), 3e-5);
    }
    before = y;
  }
}

TEST(BoundedLeastSquares, WithoutUnknownsThereIsNothingToSay) {
  bool bounded = true;
  EXPECT_EQ(bounded_least_squares(SmallMatrix(3, 0), SmallVector::Ones(3), 1, bounded).size(), 0);
  EXPECT_FALSE(bounded);
}

}  // namespace
}  // namespace abbe
