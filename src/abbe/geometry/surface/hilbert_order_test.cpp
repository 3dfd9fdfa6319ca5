#include "abbe/geometry/surface/hilbert_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/parts_for_test.h"

namespace abbe {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

TEST(HilbertOrder, PassesAllCellsOfACubeByStepsToNeighbours) {
  // Eight cells along each side of a box of 1024: the curve of the coarser cells is as unbroken.
  constexpr int kSide = 8;
  Matrix3Xd points(3, kSide * kSide * kSide);
  Eigen::Index next = 0;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; ++z) points.col(next++) = Vector3d(x + 0.5, y + 0.5, z + 0.5);
    }
  }
  const std::vector<std::uint32_t> order = hilbert_order(points, Vector3d::Zero(), Vector3d::Constant(kSide), 2);
  std::vector<bool> seen(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    seen[order[i]] = true;
    if (i > 0) {
      EXPECT_EQ((points.col(order[i]) - points.col(order[i - 1])).lpNorm<1>(), 1) << i;
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), points.cols());
}

/// Skilling's algorithm as published: coordinates to the place on the curve, whose bits are those of the axes in turn.
std::uint32_t skilling_place(std::array<std::uint32_t, 3> x, int bits) {
  const std::uint32_t top = 1u << (bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    for (std::uint32_t& axis : x) {
      if ((axis & q) != 0) {
        x[0] ^= q - 1;
      } else {
        const std::uint32_t t = (x[0] ^ axis) & (q - 1);
        x[0] ^= t;
        axis ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    if ((x[2] & q) != 0) t ^= q - 1;
  }
  std::uint32_t place = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    for (const std::uint32_t axis : x) place = place << 1 | ((axis ^ t) >> bit & 1u);
  }
  return place;
}

TEST(HilbertOrder, IsThatOfSkillingsAlgorithmAtFullDepth) {
  test::Numbers numbers(11);
  Matrix3Xd points(3, 20000);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    std::array<std::uint32_t, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      cell[k] = static_cast<std::uint32_t>(numbers.uniform(0, 1024));
      points(static_cast<Eigen::Index>(k), i) = cell[k] + 0.5;
    }
    expected.emplace_back(skilling_place(cell, 10), static_cast<std::uint32_t>(i));
  }
  std::sort(expected.begin(), expected.end());
  const std::vector<std::uint32_t> order = hilbert_order(points, Vector3d::Zero(), Vector3d::Constant(1024), 1);
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], expected[i].second) << i;
}

TEST(HilbertOrder, IsTheSameForAnyNumberOfThreadsAndKeepsTheOrderOfEqualPoints) {
  test::Numbers numbers(3);
  Matrix3Xd points(3, 50000);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    // Many in few cells, so that both ways of sorting are used.
    points.col(i) = i % 3 == 0 ? Vector3d(0.25, 0.25, 0.25) : Vector3d(0.5 * numbers.normal3());
  }
  const Vector3d low(-1, -1, -1), high(1, 1, 1);
  const std::vector<std::uint32_t> one = hilbert_order(points, low, high, 1),
                                   three = hilbert_order(points, low, high, 3);
  EXPECT_EQ(one, three);
  std::vector<std::uint32_t> sorted = one, all(one.size()), equal;
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(sorted, all);
  for (const std::uint32_t i : one) {
    if (i % 3 == 0) equal.push_back(i);
  }
  EXPECT_TRUE(std::is_sorted(equal.begin(), equal.end()));
}

TEST(HilbertOrder, PointsOutsideTheBoxCountWhereTheyAreNearestToIt) {
  test::Numbers numbers(4);
  Matrix3Xd points(3, 2000);
  for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) = numbers.normal3();
  // Not quite to the upper side, whose cells end there.
  const Matrix3Xd moved = points.cwiseMax(-1).cwiseMin(1 - 1e-9);
  const Vector3d low(-1, -1, -1), high(1, 1, 1);
  const std::vector<std::uint32_t> order = hilbert_order(points, low, high, 1);
  EXPECT_EQ(order, hilbert_order(moved, low, high, 1));
  std::vector<std::uint32_t> as_they_came(order.size());
  std::iota(as_they_came.begin(), as_they_came.end(), 0u);
  EXPECT_NE(order, as_they_came);
}

TEST(HilbertOrder, TakesPointsFarOutsideABoxWithoutExtent) {
  Matrix3Xd points(3, 3);
  points << 1e300, 0, -1e300, 0, 0, 0, 5, 0, -5;
  EXPECT_EQ(hilbert_order(points, Vector3d::Zero(), Vector3d::Zero(), 1), (std::vector<std::uint32_t>{0, 1, 2}));
  // The curve begins at the lower corner, where the last two are moved to.
  EXPECT_EQ(hilbert_order(points, Vector3d::Zero(), Vector3d::Ones(), 1), (std::vector<std::uint32_t>{1, 2, 0}));
  EXPECT_TRUE(hilbert_order(points.leftCols(0), Vector3d::Zero(), Vector3d::Ones(), 1).empty());
}

}  // namespace
}  // namespace abbe
