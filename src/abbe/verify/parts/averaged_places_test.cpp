#include "abbe/verify/parts/averaged_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Numbers in a cube, and unit vectors.
Matrix3Xd drawn(Index n, double edge, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> along(-edge, edge);
  Matrix3Xd points(3, n);
  for (double& value : points.reshaped()) value = along(engine);
  return points;
}

struct Scene {
  Matrix3Xd places, normals;
  SurfaceReadings readings;
};

Scene scene(Index places, Index readings, double edge) {
  std::mt19937_64 engine(3);
  Scene scene{drawn(places, edge, engine), drawn(places, 1, engine), {}};
  scene.normals.colwise().normalize();
  for (Index i = 0; i < places; i += 5) scene.normals.col(i).setZero();
  scene.readings.foot = drawn(readings, edge, engine);
  scene.readings.normal = drawn(readings, 1, engine);
  scene.readings.normal.colwise().normalize();
  std::normal_distribution<double> deviation(0.01, 0.05);
  for (Index i = 0; i < readings; ++i) scene.readings.deviation_mm.push_back(deviation(engine));
  return scene;
}

void expect_means_of_definition(const Scene& scene, double radius) {
  const SurfaceAverage found =
      sums_of_readings(AveragedPlaces(scene.places, scene.normals, radius), scene.readings, 2).average();
  std::size_t with_readings = 0;
  for (Index place = 0; place < scene.places.cols(); ++place) {
    double sum = 0;
    std::uint32_t count = 0;
    for (Index i = 0; i < scene.readings.foot.cols(); ++i) {
      const Vector3d normal = scene.normals.col(place);
      const bool side = normal.isZero() || scene.readings.normal.col(i).dot(normal) >= 0.5;
      if (!side || (scene.readings.foot.col(i) - scene.places.col(place)).squaredNorm() > radius * radius) continue;
      sum += scene.readings.deviation_mm[static_cast<std::size_t>(i)];
      ++count;
    }
    const auto k = static_cast<std::size_t>(place);
    ASSERT_EQ(found.count[k], count) << place << " within " << radius;
    EXPECT_NEAR(found.mean_mm[k], count == 0 ? 0 : sum / count, 1e-15) << place << " within " << radius;
    with_readings += count > 0 ? 1U : 0U;
  }
  EXPECT_GT(with_readings, 5U) << radius;
}

TEST(AveragedPlaces, HaveTheReadingsOfTheirDefinitionForSmallAndLargeRadii) {
  for (const double radius : {0.4, 1.0, 3.0, 40.0}) expect_means_of_definition(scene(300, 3000, 5), radius);
}

TEST(AveragedPlaces, OneFarAwayDoesNotTakeReadingsFromTheOthers) {
  Scene with_far = scene(200, 2000, 5);
  with_far.places.col(7) = Vector3d(1e7, -1e7, 3);
  expect_means_of_definition(with_far, 1.5);
}

TEST(AveragedPlaces, WithoutPlacesOrARadiusThereAreNoReadings) {
  const Scene some = scene(10, 100, 1);
  EXPECT_EQ(sums_of_readings(AveragedPlaces(), some.readings).average().count.size(), 0U);
  const SurfaceAverage none = sums_of_readings(AveragedPlaces(some.places, some.normals, 0), some.readings).average();
  EXPECT_EQ(none.count, std::vector<std::uint32_t>(10, 0));
  EXPECT_EQ(none.mean_mm, std::vector<double>(10, 0));
}

TEST(PlaceSums, DoNotDependOnTheOrderOrOnTheMessagesTheyCameIn) {
  const std::vector<double> values = {0.1, -0.3, 1e6, 1e-12, -1e6, 0.7, -123.456, 1e9, 0.25, -1e9};
  PlaceSums forward(2), backward(2), by_messages(2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    forward.add(i % 2, values[i]);
    const std::size_t last = values.size() - 1 - i;
    backward.add(last % 2, values[last]);
    PlaceSums one(2);
    one.add(last % 2, values[last]);
    by_messages.add(one.entries());
  }
  EXPECT_EQ(forward.entries(), backward.entries());
  EXPECT_EQ(forward.entries(), by_messages.entries());
  EXPECT_NEAR(forward.average().mean_mm[0] * forward.average().count[0], 0.35 - 123.456, 1e-12);
  EXPECT_NEAR(forward.average().mean_mm[1] * forward.average().count[1], 0.4 + 1e-12, 1e-15);
}

TEST(PlaceSums, HaveRoomForScansThatAreNowhereNear) {
  PlaceSums sums(1);
  for (int i = 0; i < 1000; ++i) sums.add(0, i % 4 == 0 ? -1e300 : 1e300);
  EXPECT_EQ(sums.average().mean_mm[0], 0x1p29);
}

TEST(PlaceSums, RefuseThoseOfOtherPlaces) {
  PlaceSums two(2), three(3);
  three.add(2, 1.0);
  EXPECT_THROW(two.add(three), std::invalid_argument);
  EXPECT_THROW(two.add(three.entries()), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
