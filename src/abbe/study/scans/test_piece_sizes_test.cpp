#include "abbe/study/scans/test_piece_sizes.h"

#include <gmock/gmock.h>

#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(SizesOfATestPiece, AreThoseOfThePieceInItsUnits) {
  TestPieceSizes sizes;
  sizes.centre_mm = {1, 2, 3};
  sizes.tool_diameter_mm = 12;
  sizes.height_mm = 25;
  sizes.azimuth_deg = 30;
  sizes.half_apex_deg = 20;
  sizes.twist_deg = -10;
  const ConeFrustum frustum = cone_frustum_of(sizes);
  EXPECT_EQ(frustum.base_centre, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(frustum.tool_radius, 6);
  EXPECT_EQ(frustum.height, 25);
  EXPECT_EQ(frustum.base_diameter, 80);
  EXPECT_DOUBLE_EQ(frustum.half_apex_angle, 20 * kDegree);
  EXPECT_DOUBLE_EQ(frustum.inclination, 10 * kDegree);
  EXPECT_DOUBLE_EQ(frustum.lean_azimuth, 30 * kDegree);
  const SShape shape = s_shape_of(sizes);
  EXPECT_EQ(shape.centre, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(shape.length, 160);
  EXPECT_DOUBLE_EQ(shape.twist, -10 * kDegree);
  EXPECT_DOUBLE_EQ(shape.azimuth, 30 * kDegree);
}

TEST(SizesOfATestPiece, ThatAreNotGivenAreThePiecesOwn) {
  EXPECT_EQ(cone_frustum_of({}).base_centre, ConeFrustum().base_centre);
  EXPECT_EQ(s_shape_of({}).height, SShape().height);
  TestPieceSizes sizes;
  sizes.centre_mm = {1, 2};
  EXPECT_THAT(message_of([&] { static_cast<void>(s_shape_of(sizes)); }), HasSubstr("--centre-mm: not three numbers"));
}

TEST(SizesOfATestPiece, BeginTheFileOfItsPath) {
  const TestPieceSizes sizes;
  const TestPiece cone = test_piece_of(cone_frustum_of(sizes)), s = test_piece_of(s_shape_of(sizes));
  EXPECT_EQ(cone_frustum_csv(sizes, cone),
            "# cone frustum: base 80 mm, half apex angle 15 deg, inclination 10 deg\n# tool of 20 mm diameter\n" +
                curve_csv(cone.curve));
  EXPECT_THAT(s_shape_csv(sizes, s), StartsWith("# S shape: length 160 mm, amplitude 40 mm, lean 5 deg, twist 15 deg\n"
                                                "# tool of 20 mm diameter\n"));
}

}  // namespace
}  // namespace abbe
