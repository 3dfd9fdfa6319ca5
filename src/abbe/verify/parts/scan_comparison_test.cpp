#include "abbe/verify/parts/scan_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(ScanComparison, KeepsThePointsThatCountAndTheirDeviations) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {20, 10, 5});
  const ClosestPointFinder surface(block, 1);
  Eigen::Matrix3Xd points(3, 4);
  points << 10, 5, 3, 12, 5, 4, 5, 5, 5.02, 4.99, 9, -0.03;
  ScanComparisonOptions options;
  options.largest_mm = 1;
  options.tolerance = DeviationTolerance{-0.02, 0.025};
  options.faces = surface_faces(block, 0.5, 1);
  options.threads = 1;
  const ScanComparison result = compare_scan(surface, points, options);
  ASSERT_EQ(result.counted_mm.size(), 3U);
  EXPECT_EQ(result.deviation.too_far, 1U);
  EXPECT_NEAR(result.counted_mm[0], 0.02, 1e-12);
  EXPECT_NEAR(result.counted_mm[1], -0.01, 1e-12);
  EXPECT_NEAR(result.counted_mm[2], 0.03, 1e-12);
  EXPECT_EQ(result.counted_points.col(2), points.col(3));
  EXPECT_NEAR(result.deviation.all.within, 2.0 / 3, 1e-12);
  ASSERT_EQ(result.deviation.regions.size(), 6U);
  std::size_t in_faces = 0;
  for (const DeviationStatistics& face : result.deviation.regions) in_faces += face.sample.count;
  EXPECT_EQ(in_faces, 3U);
  EXPECT_TRUE(compare_scan(surface, points).deviation.regions.empty());
}

}  // namespace
}  // namespace abbe
