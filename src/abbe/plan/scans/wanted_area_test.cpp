#include "abbe/plan/scans/wanted_area.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(WantedArea, IsThatOfWhatThePlanesLeaveOfABlock) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {4, 6, 8});
  EXPECT_NEAR(wanted_area(block, {}), 2 * (24 + 32 + 48), 1e-12);
  EXPECT_NEAR(wanted_area(block, {{Eigen::Vector3d::UnitZ(), 5}}), 24 + 3 * 2 * (4 + 6), 1e-12);
  // The upper half of the upper face and of two sides, and one side whole.
  EXPECT_NEAR(wanted_area(block, {{Eigen::Vector3d::UnitZ(), 5}, {Eigen::Vector3d::UnitX(), 2}}),
              2 * 6 + 2 * (2 * 3) + 6 * 3, 1e-12);
  // The corner at (4, 6, 8): three right-angled triangles with sides of 1.
  EXPECT_NEAR(wanted_area(block, {{Eigen::Vector3d::Ones().normalized(), 17 / std::sqrt(3.0)}}), 1.5, 1e-12);
  EXPECT_EQ(wanted_area(block, {{Eigen::Vector3d::UnitZ(), 8.001}}), 0);
}

}  // namespace
}  // namespace abbe
