#include "abbe/geometry/rigid_transform.h"

#include <gtest/gtest.h>

#include <random>

namespace abbe {
namespace {

// Written out, the products must stay what they are in Eigen: results are compared byte by byte.
TEST(RigidTransform, HasTheBitsOfEigen) {
#if !defined(__SSE2__) || defined(__FMA__)
  GTEST_SKIP() << "Eigen adds in another order here";
#endif
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> number(-3, 3);
  const auto any = [&] {
    RigidTransform t;
    for (int i = 0; i < 3; ++i) {
      t.translation[i] = 100 * number(random);
      for (int j = 0; j < 3; ++j) t.rotation(i, j) = number(random);
    }
    return t;
  };
  for (int k = 0; k < 1000; ++k) {
    const RigidTransform a = any(), b = any(), product = a * b, back = a.inverse();
    EXPECT_EQ(product.rotation, Eigen::Matrix3d(a.rotation * b.rotation));
    EXPECT_EQ(product.translation, Eigen::Vector3d(a.rotation * b.translation + a.translation));
    EXPECT_EQ(a * b.translation, product.translation);
    EXPECT_EQ(back.rotation, Eigen::Matrix3d(a.rotation.transpose()));
    EXPECT_EQ(back.translation, Eigen::Vector3d(-(a.rotation.transpose() * a.translation)));
  }
}

TEST(RigidTransform, TheInverseBringsBack) {
  RigidTransform t;
  t.rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  t.translation << 1, 2, 3;
  const RigidTransform none = t.inverse() * t;
  EXPECT_EQ(none.rotation, Eigen::Matrix3d::Identity());
  EXPECT_EQ(none.translation, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace abbe
