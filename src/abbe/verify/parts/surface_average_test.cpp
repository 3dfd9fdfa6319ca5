#include "abbe/verify/parts/surface_average.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace abbe {
namespace {

/// Both sides of a sheet in z = 0, 40 x 20 mm: what lies on the upper side is x um high, on the lower -50 um.
SurfaceReadings sheet(Eigen::Index n) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> along(0, 40), across(0, 20);
  SurfaceReadings readings;
  readings.foot.resize(3, n);
  readings.normal.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool upper = i % 2 == 0;
    readings.foot.col(i) = Eigen::Vector3d(along(engine), across(engine), 0);
    readings.normal.col(i) = Eigen::Vector3d(0, 0, upper ? 1 : -1);
    readings.deviation_mm.push_back(upper ? 1e-3 * readings.foot(0, i) : -0.05);
  }
  return readings;
}

TEST(SurfaceAverage, IsTheMeanOfTheReadingsWithinTheRadiusOnTheSameSide) {
  const SurfaceReadings readings = sheet(4000);
  Eigen::Matrix3Xd places(3, 4), normals(3, 4);
  places << 10, 0, 33.3, 10, 10, 0, 4, 10, 0, 0, 0, 0;
  normals << 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, -1, 0;
  const double radius = 1.5;
  const SurfaceAverage found = surface_average(readings, places, normals, radius, 2);
  for (Eigen::Index place = 0; place < 4; ++place) {
    double sum = 0;
    std::uint32_t count = 0;
    for (Eigen::Index i = 0; i < readings.foot.cols(); ++i) {
      const bool side = normals(2, place) == 0 || normals(2, place) == readings.normal(2, i);
      if (!side || (readings.foot.col(i) - places.col(place)).norm() > radius) continue;
      sum += readings.deviation_mm[static_cast<std::size_t>(i)];
      ++count;
    }
    const auto k = static_cast<std::size_t>(place);
    ASSERT_GT(count, 3U);
    EXPECT_EQ(found.count[k], count);
    EXPECT_NEAR(found.mean_mm[k], sum / count, 1e-15);
  }
  EXPECT_NEAR(found.mean_mm[0], 0.010, 5e-4);
  EXPECT_DOUBLE_EQ(found.mean_mm[2], -0.05);
}

TEST(SurfaceAverage, APlaceWithoutReadingsHasNone) {
  Eigen::Matrix3Xd places(3, 2), normals(3, 2);
  places << 20, 20, 10, 10, 5, 1e7;
  normals << 0, 0, 0, 0, 1, 1;
  const SurfaceAverage found = surface_average(sheet(1000), places, normals, 2, 1);
  EXPECT_EQ(found.count[0], 0U);
  EXPECT_EQ(found.count[1], 0U);
  EXPECT_EQ(surface_average({}, places, normals, 2, 1).count[0], 0U);
}

TEST(SurfaceAverage, TheRadiusFollowsTheDensityOfTheReadings) {
  const double coarse = radius_of_readings(sheet(1000)), fine = radius_of_readings(sheet(100000));
  // Both sides count: a cube holds n / 800 * r^2 of them.
  EXPECT_GT(coarse * coarse * 1000 / 800, 3);
  EXPECT_LT(coarse * coarse * 1000 / 800, 12);
  EXPECT_GT(coarse / fine, 6);
  EXPECT_LT(coarse / fine, 16);
  EXPECT_EQ(radius_of_readings({}), 0);
  EXPECT_LE(radius_of_readings(sheet(3)), 4.5);
}

}  // namespace
}  // namespace abbe
