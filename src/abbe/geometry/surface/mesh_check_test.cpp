#include "abbe/geometry/surface/mesh_check.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(MeshCheck, SaysTheFiguresOfABlock) {
  const MeshCheck check = check_mesh(block_for_test({-1, 2, 3}, {1, 5, 7}));
  EXPECT_EQ(check.triangles, 12U);
  EXPECT_EQ(check.vertices, 8U);
  EXPECT_EQ(check.edges, 18U);
  EXPECT_EQ(check.parts, 1U);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_DOUBLE_EQ(check.area, 2 * (2 * 3 + 2 * 4 + 3 * 4));
  EXPECT_DOUBLE_EQ(check.volume, 24);
  EXPECT_EQ(check.lower, Eigen::Vector3d(-1, 2, 3));
  EXPECT_EQ(check.upper, Eigen::Vector3d(1, 5, 7));
  EXPECT_EQ(check.degenerate_triangles + check.duplicate_triangles + check.unused_vertices, 0U);
}

TEST(MeshCheck, VolumeOfASphereFarAwayIsThatOfItsFacets) {
  const Eigen::Vector3d far(1e6, -2e6, 3e5);
  const MeshCheck here = check_mesh(sphere_for_test(Eigen::Vector3d::Zero(), 12.703, 60));
  const MeshCheck there = check_mesh(sphere_for_test(far, 12.703, 60));
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(12.703, 3);
  EXPECT_LT(here.volume, ball);
  EXPECT_NEAR(here.volume, ball, 0.003 * ball);
  EXPECT_NEAR(there.volume, here.volume, 1e-5);  // the vertices themselves are rounded to 2e-10 mm there
  EXPECT_TRUE(there.encloses_volume());
  EXPECT_EQ(here.edges, 3 * here.triangles / 2);
}

TEST(MeshCheck, AMissingTriangleOpensTheMesh) {
  TriangleMesh mesh = block_for_test({0, 0, 0}, {1, 1, 1});
  mesh.triangles.conservativeResize(3, 11);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_FALSE(check.is_closed());
  EXPECT_EQ(check.border_edges, 3U);
  EXPECT_EQ(check.rims, 1U);
  EXPECT_TRUE(check.is_oriented());
  EXPECT_EQ(check.volume, 0);
}

TEST(MeshCheck, HolesThatDoNotTouchAreCountedOneByOne) {
  TriangleMesh mesh = sphere_for_test(Eigen::Vector3d::Zero(), 1, 20);
  EXPECT_EQ(check_mesh(mesh).rims, 0U);
  // One triangle near the top, one below the middle.
  const Eigen::Index last = mesh.size() - 1;
  mesh.triangles.col(0) = mesh.triangles.col(last);
  mesh.triangles.col(last / 2) = mesh.triangles.col(last - 1);
  mesh.triangles.conservativeResize(3, last - 1);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.border_edges, 6U);
  EXPECT_EQ(check.rims, 2U);
}

TEST(MeshCheck, ATurnedTriangleIsSeenAtItsThreeEdges) {
  TriangleMesh mesh = block_for_test({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles(0, 4), mesh.triangles(1, 4));
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_closed());
  EXPECT_FALSE(check.is_oriented());
  EXPECT_EQ(check.turned_edges, 3U);
}

TEST(MeshCheck, AnInsideOutMeshHasANegativeVolume) {
  TriangleMesh mesh = block_for_test({0, 0, 0}, {1, 2, 3});
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  EXPECT_DOUBLE_EQ(check_mesh(mesh).volume, -6);
}

TEST(MeshCheck, CountsDegenerateAndRepeatedTrianglesBranchesAndParts) {
  TriangleMesh mesh = block_for_test({0, 0, 0}, {1, 1, 1});
  mesh.vertices.conservativeResize(3, 14);
  mesh.vertices.rightCols(6) << 5, 6, 7, 5, 9, 1e-20,  //
      5, 5, 5, 6, 9, 0,                                //
      5, 5, 5, 5, 9, 0;
  mesh.triangles.conservativeResize(3, 18);
  mesh.triangles.rightCols(6) << 8, 8, 9, 0, 3, 0,  //
      9, 9, 9, 2, 2, 13,                            //
      11, 10, 8, 3, 0, 1;
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.degenerate_triangles, 3U);  // three in a line, one vertex twice, a height of 1e-20 mm
  EXPECT_EQ(check.duplicate_triangles, 2U);   // the same sense and another start, turned over
  EXPECT_EQ(check.unused_vertices, 1U);
  EXPECT_EQ(check.parts, 2U);
  EXPECT_EQ(check.branching_edges, 4U);  // three of the repeated triangle, one of the needle
  EXPECT_EQ(check.upper, Eigen::Vector3d(7, 6, 5));
}

TEST(MeshCheck, AnEmptyMeshIsNotClosed) {
  const MeshCheck check = check_mesh(TriangleMesh());
  EXPECT_FALSE(check.is_closed());
  EXPECT_EQ(check.parts, 0U);
}

}  // namespace
}  // namespace abbe
