#include "abbe/formats/nc/nc_position.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

constexpr std::uint32_t kSixWords = 0b111111;

/// Turned about Z by a quarter, its origin at X 10.
const NcTiltedPlane kTurnedPlane({10, 0, 0}, {std::acos(0.0), 0, 0});

NcPosition position_at(const NcAxisValues& values) {
  NcPosition position(kSixWords);
  for_axes(kSixWords, [&](std::size_t k) { position.begin_at(k, values[k]); });
  return position;
}

TEST(NcPosition, WhatIsNotKnownIsNamed) {
  NcPosition position(kSixWords);
  position.begin_at(0, 1);
  EXPECT_EQ(position.unknown(), 0b111110U);
  const std::string line = "X1 Y2";
  const std::string file = "p.ngc";
  NcBlock block;
  block.cursor = {line.data(), line.data(), line.data() + line.size(), 4, &file};
  position.require(1, block, "this test takes it");
  EXPECT_EQ(message_of([&] { position.require(0b100011, block, "this test takes it"); }),
            "p.ngc:4:1: X1: where Y, C stand is not known here, and this test takes it; expected a G0 before it "
            "that names these axes, or where they stand when the program begins (--start X_mm=0)");
}

TEST(NcPosition, ATiltedPlaneCountsFromItsOrigin) {
  NcPosition position = position_at({10, 5, 7, 0, 0, 30});
  position.set_plane(kTurnedPlane);
  position.count_from({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(position.zero(), (NcAxisValues{0, 0, 0, 4, 5, 6}));
  position.enter_plane([&](const Eigen::Vector3d& in_plane) { return kTurnedPlane.place(in_plane); });
  EXPECT_NEAR(position.values()[0], 5, 1e-12);
  EXPECT_NEAR(position.values()[1], 0, 1e-12);
  EXPECT_NEAR(position.values()[2], 7, 1e-12);
  EXPECT_EQ(position.values()[5], 30);
  EXPECT_EQ(position.axes(), (NcAxisValues{10, 5, 7, 0, 0, 30}));

  const NcAxisValues in_plane = {1, 2, 3, 0, 0, 40};
  const NcAxisValues axes = position.axes_at(in_plane);
  EXPECT_NEAR(axes[0], 8, 1e-12);
  EXPECT_NEAR(axes[1], 1, 1e-12);
  position.go({in_plane, kSixWords}, axes);
  position.leave_plane();
  EXPECT_EQ(position.values(), axes);
  EXPECT_EQ(position.axes_at(in_plane), in_plane);

  position.set_plane(std::nullopt);
  position.count_from({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(position.zero(), (NcAxisValues{1, 2, 3, 4, 5, 6}));
}

TEST(NcPosition, InAPlaneAllOfXyzAreKnownOrNone) {
  NcPosition position = position_at({1, 2, 3});
  position.forget(0b010);
  position.set_plane(kTurnedPlane);
  position.enter_plane([&](const Eigen::Vector3d& in_plane) { return kTurnedPlane.place(in_plane); });
  EXPECT_EQ(position.unknown(), kXyzWords);
}

}  // namespace
}  // namespace abbe
