#include "abbe/report/drawings/coverage_picture.h"

#include <gtest/gtest.h>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

TEST(CoveragePicture, TrianglesSayWhatThePlacesAboutThemSayOnTheirSide) {
  // A sheet of 20 x 20 x 0.2 mm: the upper face covered for x < 10, else hidden, the lower face out of travel.
  const TriangleMesh sheet = block_for_test({0, 0, 0}, {20, 20, 0.2});
  PlacesOfASurface places;
  places.reasons = {"covered", "hidden", "travel"};
  places.points.resize(3, 2 * 80 * 80);
  Eigen::Index next = 0;
  for (int i = 0; i < 80; ++i) {
    for (int k = 0; k < 80; ++k) {
      const double x = 0.125 + 0.25 * i, y = 0.125 + 0.25 * k;
      places.points.col(next++) = Eigen::Vector3d(x, y, 0.2);
      places.reason.push_back(x < 10 ? 0 : 1);
      places.points.col(next++) = Eigen::Vector3d(x, y, 0);
      places.reason.push_back(2);
    }
  }
  const SurfacePicture picture = coverage_picture(sheet, places, 1);
  ASSERT_EQ(picture.coverage.size(), static_cast<std::size_t>(picture.mesh.size()));
  ASSERT_EQ(picture.reasons.size(), 4U);
  std::size_t compared = 0;
  for (Eigen::Index t = 0; t < picture.mesh.size(); ++t) {
    const Eigen::Vector3d middle =
        (picture.mesh.corner(t, 0) + picture.mesh.corner(t, 1) + picture.mesh.corner(t, 2)) / 3;
    const int said = picture.coverage[static_cast<std::size_t>(t)];
    if (middle.z() < 1e-9) {
      EXPECT_EQ(said, 2);
    } else if (middle.z() > 0.2 - 1e-9) {
      if (std::abs(middle.x() - 10) < 1.5) continue;
      EXPECT_EQ(said, middle.x() < 10 ? 0 : 1) << middle.transpose();
    } else {
      EXPECT_EQ(said, 3);  // the rim was not looked at
    }
    ++compared;
  }
  EXPECT_GT(compared, 500U);
}

}  // namespace
}  // namespace abbe
