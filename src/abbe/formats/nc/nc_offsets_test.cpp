#include "abbe/formats/nc/nc_offsets.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

constexpr std::uint32_t kX = 1, kXandC = 0b100001;

NcOffsets offsets_of_a_job() {
  NcOffsets offsets;
  offsets.use_system(2);
  offsets.set_system(2, kXandC, {10, 99, 0, 0, 0, 30});
  offsets.set_axis_offset(kX, {0.5});
  offsets.set_tool({1, 2, 50});
  return offsets;
}

TEST(NcOffsets, TheSumHasWorkOffsetAxisOffsetAndTool) {
  NcOffsets offsets = offsets_of_a_job();
  EXPECT_EQ(offsets.sum(), (NcAxisValues{11.5, 2, 50, 0, 0, 30}));  // Y was not among the words that were set
  offsets.set_tool_centre(true);
  EXPECT_EQ(offsets.sum(), (NcAxisValues{10.5, 0, 0, 0, 0, 30}));
  offsets.use_system(0);
  EXPECT_EQ(offsets.sum(), (NcAxisValues{0.5}));
}

TEST(NcOffsets, AWorkOffsetIsSaidEvenByNoWords) {
  NcOffsets offsets;
  EXPECT_FALSE(offsets.is_system_said());
  offsets.set_system(1, 0, {5});
  EXPECT_FALSE(offsets.is_system_said());
  offsets.use_system(1);
  EXPECT_TRUE(offsets.is_system_said());
  EXPECT_EQ(offsets.sum(), NcAxisValues{});
}

TEST(NcOffsets, AWorkOffsetByThePositionGivesItTheValues) {
  const NcAxisValues position = {7, 8, 9, 1, 2, 3}, wanted = {-2, 0, 0, 0, 0, 90};
  for (const bool tool_centre : {false, true}) {
    NcOffsets offsets = offsets_of_a_job();
    offsets.set_tool_centre(tool_centre);
    offsets.set_system(2, kXandC, offsets.system_at(kXandC, position, wanted));
    EXPECT_DOUBLE_EQ(position[0] - offsets.sum()[0], -2);
    EXPECT_DOUBLE_EQ(position[5] - offsets.sum()[5], 90);
    EXPECT_DOUBLE_EQ(offsets.sum()[1], tool_centre ? 0 : 2);
  }
}

TEST(NcOffsets, AnAxisOffsetGivesThePositionOtherValues) {
  NcOffsets offsets = offsets_of_a_job();
  const double position = 40, shown = position - offsets.sum()[0];
  const NcOffsets before = offsets;
  offsets.shift_axis_offset(kX, {shown}, {3});
  EXPECT_DOUBLE_EQ(position - offsets.sum()[0], 3);
  // A control that stands elsewhere gets the same offset by another word.
  NcOffsets control = before;
  const double stands = 41.25;
  control.shift_axis_offset(kX, {stands - control.sum()[0]}, {offsets.value_for_axis_offset(0, stands)});
  EXPECT_DOUBLE_EQ(control.sum()[0], offsets.sum()[0]);
}

TEST(NcOffsets, AnAxisOffsetThatIsSuspendedComesBackAndOneThatIsClearedDoesNot) {
  NcOffsets offsets = offsets_of_a_job();
  offsets.suspend_axis_offset();
  EXPECT_DOUBLE_EQ(offsets.sum()[0], 11);
  EXPECT_DOUBLE_EQ(offsets.stored_axis_offset()[0], 0.5);
  offsets.restore_axis_offset();
  EXPECT_DOUBLE_EQ(offsets.sum()[0], 11.5);
  offsets.clear_axis_offset();
  offsets.restore_axis_offset();
  EXPECT_DOUBLE_EQ(offsets.sum()[0], 11);
}

}  // namespace
}  // namespace abbe
