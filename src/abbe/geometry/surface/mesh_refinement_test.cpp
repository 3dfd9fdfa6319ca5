#include "abbe/geometry/surface/mesh_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm());
  }
  return longest;
}

TEST(MeshRefinement, NoEdgeIsLongerAndTheSurfaceStaysClosedAndTheSame) {
  for (const TriangleMesh& mesh : {block_for_test({-3, 0, 1}, {27, 4, 8}), sphere_for_test({1, 2, 3}, 5, 6)}) {
    const MeshCheck before = check_mesh(mesh);
    const RefinedMesh fine = refined_mesh(mesh, 0.7, 100000);
    const MeshCheck after = check_mesh(fine.mesh);
    EXPECT_EQ(fine.longest_mm, 0.7);
    EXPECT_LE(longest_edge(fine.mesh), 0.7);
    EXPECT_TRUE(after.encloses_volume());
    EXPECT_EQ(after.degenerate_triangles, 0U);
    EXPECT_EQ(after.unused_vertices, 0U);
    EXPECT_NEAR(after.area, before.area, 1e-9 * before.area);
    EXPECT_NEAR(after.volume, before.volume, 1e-9 * before.volume);
  }
}

TEST(MeshRefinement, TheLengthGrowsUntilTheTrianglesAreFewEnough) {
  const RefinedMesh fine = refined_mesh(block_for_test({0, 0, 0}, {100, 100, 100}), 0.01, 3000);
  EXPECT_LE(fine.mesh.size(), 3000);
  EXPECT_GT(fine.mesh.size(), 700);
  EXPECT_LE(longest_edge(fine.mesh), fine.longest_mm);
  const RefinedMesh whole = refined_mesh(block_for_test({0, 0, 0}, {1, 1, 1}), 0.01, 5);
  EXPECT_EQ(whole.mesh.size(), 12);
  EXPECT_DOUBLE_EQ(whole.longest_mm, std::sqrt(2));
}

TEST(MeshRefinement, FacesGetVerticesAndNormalsOfTheirOwn) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {1, 2, 3});
  const TriangleMesh apart = with_separate_faces(block, surface_faces(block, std::numbers::pi / 6, 1));
  EXPECT_EQ(apart.vertices.cols(), 24);
  const Eigen::Matrix3Xd normals = vertex_normals(apart);
  for (Eigen::Index t = 0; t < apart.size(); ++t) {
    const Eigen::Vector3d normal =
        (apart.corner(t, 1) - apart.corner(t, 0)).cross(apart.corner(t, 2) - apart.corner(t, 0)).normalized();
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(apart.corner(t, k), block.corner(t, k));
      EXPECT_LT((normals.col(apart.triangles(k, t)) - normal).norm(), 1e-14);
    }
  }
  const TriangleMesh ball = sphere_for_test({0, 0, 0}, 1, 20);
  EXPECT_EQ(with_separate_faces(ball, surface_faces(ball, std::numbers::pi / 6, 1)).vertices.cols(),
            ball.vertices.cols());
}

}  // namespace
}  // namespace abbe
