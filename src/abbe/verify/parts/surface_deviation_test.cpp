#include "abbe/verify/parts/surface_deviation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace {

/// A sheet 4 x 4 mm of two triangles in the plane z = 0.
TriangleMesh sheet() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 4, 4, 0, 0, 0, 4, 4, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

TEST(SurfaceDeviation, AgreesWithNumbersWorkedByHand) {
  Eigen::Matrix3Xd points(3, 6);
  points << 3, 3.5, 1, 0.5, 2, 9,  //
      1, 0.5, 3, 3.5, 1, 2,        //
      0.3, -0.1, 0.2, 0.2, 5, 0;
  const std::vector<SurfacePoint> closest = ClosestPointFinder(sheet()).closest(points);
  const std::uint32_t region[] = {0, 1};
  const SurfaceDeviation deviation = surface_deviation(
      closest,
      {.tolerance = DeviationTolerance{-0.05, 0.2}, .largest_mm = 1, .region_of_triangle = region, .regions = 2});
  EXPECT_EQ(deviation.beyond_border, 1u);
  EXPECT_EQ(deviation.too_far, 1u);
  EXPECT_EQ(deviation.counted, (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 0}));
  EXPECT_EQ(deviation.all.sample.count, 4u);
  EXPECT_NEAR(deviation.all.sample.mean, 0.15, 1e-15);
  EXPECT_NEAR(deviation.all.sample.rms, std::sqrt(0.18 / 4), 1e-15);
  EXPECT_NEAR(deviation.all.rms_about_mean, std::sqrt(0.09 / 4), 1e-15);
  EXPECT_NEAR(deviation.all.sample.deviation, std::sqrt(0.09 / 3), 1e-15);
  EXPECT_EQ(deviation.all.sample.minimum, -0.1);
  EXPECT_EQ(deviation.all.sample.maximum, 0.3);
  EXPECT_EQ(deviation.all.within, 0.5);
  ASSERT_EQ(deviation.regions.size(), 2u);
  EXPECT_NEAR(deviation.regions[0].sample.mean, 0.1, 1e-15);
  EXPECT_NEAR(deviation.regions[1].rms_about_mean, 0, 1e-15);
}

TEST(SurfaceDeviation, RegionsThatDoNotExistAreRefused) {
  const std::vector<SurfacePoint> closest =
      ClosestPointFinder(sheet()).closest(Eigen::Matrix3Xd(Eigen::Vector3d(1, 3, 1)));
  const std::uint32_t region[] = {0, 2};
  EXPECT_THROW(surface_deviation(closest, {.region_of_triangle = region, .regions = 2}), std::invalid_argument);
}

TEST(SurfaceDeviation, WithoutPointsIsEmpty) {
  const SurfaceDeviation deviation = surface_deviation({});
  EXPECT_EQ(deviation.all.sample.count, 0u);
  EXPECT_EQ(deviation.all.rms_about_mean, 0);
}

}  // namespace
}  // namespace abbe
