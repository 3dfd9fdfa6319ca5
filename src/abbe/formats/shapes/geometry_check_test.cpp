#include "abbe/formats/shapes/geometry_check.h"

#include <gtest/gtest.h>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(GeometryCheck, CountsWhatIsAtThePlaceOfAnother) {
  MeshFile file;
  file.mesh = block_for_test({0, 0, 0}, {2, 3, 4});
  const CheckedMesh sound = checked_mesh(file);
  EXPECT_TRUE(sound.is_sound());
  EXPECT_FALSE(sound.is_inside_out());
  EXPECT_EQ(sound.repeated, 0U);
  EXPECT_NEAR(sound.check.volume, 24, 1e-12);
  file.mesh.triangles.row(0).swap(file.mesh.triangles.row(1));
  EXPECT_TRUE(checked_mesh(file).is_inside_out());
  EXPECT_FALSE(checked_mesh(file).is_sound());

  PointCloudFile points;
  points.cloud.points.resize(3, 4);
  points.cloud.points << 0, 2, 0, 2, 0, 0, 0, 2, 1, 1, 1, 1;
  const CheckedCloud cloud = checked_cloud(points);
  EXPECT_EQ(cloud.repeated, 1U);
  EXPECT_EQ(cloud.lower, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(cloud.upper, Eigen::Vector3d(2, 2, 1));
  EXPECT_LT((cloud.centroid - Eigen::Vector3d(1, 0.5, 1)).norm(), 1e-15);
}

}  // namespace
}  // namespace abbe
