#include "abbe/geometry/surface_faces.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/geometry/parts_for_test.h"

namespace abbe {
namespace {

constexpr double kThirtyDegrees = std::numbers::pi / 6;

TEST(SurfaceFaces, AFlatStepIsOneFaceWithItsAreaAndMiddle) {
  const SurfaceFaces faces = surface_faces(parts::stepped_box(2), kThirtyDegrees);
  ASSERT_EQ(faces.count(), 10u);
  double all = 0;
  int found = 0;
  for (std::size_t i = 0; i < faces.count(); ++i) {
    all += faces.area[i];
    // The step at y = 17: 18 x 24 mm.
    if ((faces.middle[i] - Eigen::Vector3d(29, 17, 12)).norm() < 1e-9) {
      EXPECT_NEAR(faces.area[i], 432, 1e-9);
      ++found;
    }
  }
  EXPECT_EQ(found, 1);
  EXPECT_NEAR(all, 2 * (20 * 30 + 18 * 17 + 12 * 6) + 24 * 160, 1e-9);
}

TEST(SurfaceFaces, AWallOfManyStripsIsOneFaceUnlessTheAngleIsSmaller) {
  const TriangleMesh cylinder = parts::cylinder_with_flats(8, 40, 36, 3, {});
  EXPECT_EQ(surface_faces(cylinder, kThirtyDegrees).count(), 3u);
  EXPECT_EQ(surface_faces(cylinder, kThirtyDegrees / 6).count(), 38u);
}

TEST(SurfaceFaces, TrianglesThatDoNotTouchAreDifferentFaces) {
  const TriangleMesh two =
      parts::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
  EXPECT_EQ(surface_faces(two, kThirtyDegrees).count(), 2u);
}

}  // namespace
}  // namespace abbe
