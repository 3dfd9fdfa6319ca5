#include "abbe/geometry/dual.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace abbe {
namespace {

using D = Dual<2>;

/// Every operation once, for any number.
template <typename S>
S everything(const S& x, const S& y) {
  using std::abs, std::asin, std::atan2, std::cos, std::sin, std::sqrt, std::tan;
  const S a = x * y + 3.0 * x - y / x + 2.0;
  const S b = sqrt(x * x + y * y) - sin(x) * cos(y) + tan(x * 0.1);
  return atan2(a, b) + abs(-a) * asin(x * 0.2) / (1.0 + b * b) - b;
}

TEST(Dual, DerivativesEqualCentralDifferences) {
  const double x = 0.7, y = -1.3, h = 1e-6;
  const D result = everything(D::variable(x, 0), D::variable(y, 1));
  EXPECT_DOUBLE_EQ(result.value, everything(x, y));
  EXPECT_NEAR(result.slope[0], (everything(x + h, y) - everything(x - h, y)) / (2 * h), 1e-8);
  EXPECT_NEAR(result.slope[1], (everything(x, y + h) - everything(x, y - h)) / (2 * h), 1e-8);
}

TEST(Dual, IsTheScalarOfSmallMatrices) {
  const Eigen::Matrix<D, 3, 1> a(D::variable(1, 0), D(2), D(3)), b(D(4), D::variable(5, 1), D(6));
  const D product = a.dot(b);
  EXPECT_DOUBLE_EQ(product.value, 32);
  EXPECT_DOUBLE_EQ(product.slope[0], 4);
  EXPECT_DOUBLE_EQ(product.slope[1], 2);
  const Eigen::Matrix<D, 3, 1> cross = a.cross(b);
  EXPECT_DOUBLE_EQ(cross[2].value, 5 - 8);
  EXPECT_DOUBLE_EQ(cross[2].slope[0], 5);
  EXPECT_DOUBLE_EQ(a.norm().slope[0], 1 / std::sqrt(14.0));
}

TEST(Dual, ComparesByValue) {
  EXPECT_TRUE(D::variable(1, 0) < D::variable(2, 0));
  EXPECT_TRUE(D::variable(1, 0) == D(1));
  EXPECT_DOUBLE_EQ(value_of(D::variable(3, 1)), 3);
}

}  // namespace
}  // namespace abbe
