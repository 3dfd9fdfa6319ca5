#include "abbe/geometry/surface/surface_faces.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
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

TEST(SurfaceFaces, StatedOnesNeedNotBeConnected) {
  const TriangleMesh mesh = parts::stepped_box();
  std::vector<std::uint32_t> face(static_cast<std::size_t>(mesh.size()), 2);
  face[3] = 0;
  face.back() = 0;
  const SurfaceFaces faces = stated_faces(mesh, face, 4);
  ASSERT_EQ(faces.count(), 4u);
  EXPECT_EQ(faces.area[1], 0) << "a face without triangles";
  EXPECT_NEAR(faces.area[0] + faces.area[2], 2 * (20 * 30 + 18 * 17 + 12 * 6) + 24 * 160, 1e-9);
  const auto area = [&](Eigen::Index t) {
    return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm() / 2;
  };
  EXPECT_NEAR(faces.area[0], area(3) + area(mesh.size() - 1), 1e-12);
  const auto middle = [&](Eigen::Index t) {
    return Eigen::Vector3d((mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3);
  };
  const Eigen::Vector3d expected =
      (area(3) * middle(3) + area(mesh.size() - 1) * middle(mesh.size() - 1)) / faces.area[0];
  EXPECT_LT((faces.middle[0] - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace abbe
