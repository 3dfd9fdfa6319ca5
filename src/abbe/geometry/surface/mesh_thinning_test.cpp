#include "abbe/geometry/surface/mesh_thinning.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/geometry/surface/mesh_refinement.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(MeshThinning, AMeshWithFewTrianglesStaysAsItIs) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {1, 2, 3});
  const ThinnedMesh thin = thinned_mesh(block, 100);
  EXPECT_EQ(thin.cell_mm, 0);
  EXPECT_EQ(thin.mesh.vertices, block.vertices);
  EXPECT_EQ(thin.mesh.triangles, block.triangles);
}

TEST(MeshThinning, ASphereKeepsItsShapeWithinACell) {
  const Eigen::Vector3d centre(1e5, -2e5, 3e4);
  const TriangleMesh sphere = sphere_for_test(centre, 10, 150);
  ASSERT_GT(sphere.size(), 80000);
  const ThinnedMesh thin = thinned_mesh(sphere, 5000);
  EXPECT_LE(thin.mesh.size(), 5000);
  EXPECT_GT(thin.mesh.size(), 3500);
  EXPECT_GT(thin.cell_mm, 0);
  const Eigen::VectorXd off = ((thin.mesh.vertices.colwise() - centre).colwise().norm().array() - 10).abs();
  EXPECT_LT(off.maxCoeff(), thin.cell_mm);
  EXPECT_LT(off.mean(), 0.02 * thin.cell_mm);
  const MeshCheck check = check_mesh(thin.mesh);
  ASSERT_TRUE(check.encloses_volume());
  EXPECT_NEAR(check.volume / (4.0 / 3 * std::numbers::pi * 1000), 1, 0.02);
  EXPECT_NEAR(check.area / (4 * std::numbers::pi * 100), 1, 0.03);
}

TEST(MeshThinning, EdgesAndCornersOfABlockStaySharp) {
  const TriangleMesh fine = refined_mesh(block_for_test({0, 0, 0}, {30, 20, 10}), 0.3, 1000000).mesh;
  ASSERT_GT(fine.size(), 40000);
  const ThinnedMesh thin = thinned_mesh(fine, 2000);
  EXPECT_LE(thin.mesh.size(), 2000);
  const ClosestPointFinder exact(block_for_test({0, 0, 0}, {30, 20, 10}), 1);
  EXPECT_LT(exact.signed_distances(thin.mesh.vertices, 1).cwiseAbs().maxCoeff(), 1e-9);
  const ClosestPointFinder drawn(thin.mesh, 1);
  Eigen::Matrix3Xd corners = block_for_test({0, 0, 0}, {30, 20, 10}).vertices;
  EXPECT_LT(drawn.signed_distances(corners, 1).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace abbe
