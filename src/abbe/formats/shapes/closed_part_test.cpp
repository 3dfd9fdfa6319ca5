#include "abbe/formats/shapes/closed_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

TEST(ClosedPart, SharesItsVerticesAndEnclosesAVolume) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {1, 2, 3});
  // Every triangle with corners of its own, as an STL file has them.
  TriangleMesh apart;
  apart.vertices.resize(3, 3 * block.size());
  apart.triangles.resize(3, block.size());
  for (Eigen::Index t = 0; t < block.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      apart.vertices.col(3 * t + k) = block.corner(t, k);
      apart.triangles(k, t) = static_cast<std::uint32_t>(3 * t + k);
    }
  }
  const TriangleMesh part = closed_part(apart, "part.stl");
  EXPECT_EQ(part.vertices.cols(), 8);
  EXPECT_EQ(part.size(), 12);
  TriangleMesh open = apart;
  open.triangles.conservativeResize(3, apart.size() - 1);
  EXPECT_THAT(message_of([&] { closed_part(open, "part.stl"); }),
              HasSubstr("part.stl: the surface is not closed or not oriented: 3 edges of one triangle"));
  apart.triangles.row(0).swap(apart.triangles.row(1));
  EXPECT_THAT(message_of([&] { closed_part(apart, "part.stl"); }), HasSubstr("the triangles look inwards"));
}

}  // namespace
}  // namespace abbe
