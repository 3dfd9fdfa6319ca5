#include "abbe/geometry/singular_values.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

TEST(RightSingular, KeepsSeenAndUnseenDirectionsApart) {
  std::mt19937_64 generator(3);
  for (const Eigen::Index size : {20, 60, 108, 150}) {
    for (const Eigen::Index unseen : {1, 7, 19}) {
      // Equal, spread and zero singular values together, as in an identification with many like parts.
      const Eigen::Index rank = size - unseen;
      Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
      for (Eigen::Index i = 0; i < rank; ++i)
        values[i] = i % 3 == 0 ? 0.5 : std::pow(10.0, -4.0 * static_cast<double>(i) / static_cast<double>(size));
      const Eigen::MatrixXd u = Qr(random_matrix(size, size, generator)).orthonormal(size);
      const Eigen::MatrixXd v = Qr(random_matrix(size, size, generator)).orthonormal(size);
      const Eigen::MatrixXd matrix = u * values.asDiagonal() * v.transpose();
      const RightSingular found = right_singular(matrix);
      std::sort(values.data(), values.data() + size, std::greater<>());
      EXPECT_LT((found.values - values).cwiseAbs().maxCoeff(), 1e-13) << size << " " << unseen;
      EXPECT_LT((matrix * found.vectors.rightCols(unseen)).norm(), 1e-12) << size << " " << unseen;
      EXPECT_LT((found.vectors.transpose() * found.vectors - Eigen::MatrixXd::Identity(size, size)).norm(), 1e-12);
    }
  }
}

TEST(RightSingular, HasTheNullSpaceOfAWideMatrixToo) {
  std::mt19937_64 generator(4);
  const Eigen::MatrixXd wide = random_matrix(5, 12, generator);
  const RightSingular found = right_singular(wide);
  EXPECT_EQ(found.values.size(), 5);
  ASSERT_EQ(found.vectors.cols(), 12);
  EXPECT_LT((wide * found.vectors.rightCols(7)).norm(), 1e-13);
}

}  // namespace
}  // namespace abbe
