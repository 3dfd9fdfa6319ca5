#include "abbe/formats/machine/axis_option.h"

#include <gmock/gmock.h>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class AnAxisOption : public testing::Test {
 protected:
  AnAxisOption() : machine_(parse_chain("w C' b X Z t").machine) {
    machine_.axes[1].travel_min = -100;
    machine_.axes[1].travel_max = 200;
    machine_.axes[0].endless = true;
  }
  std::vector<std::optional<AxisRange>> ranges(const std::string& text) {
    std::vector<std::optional<AxisRange>> all(machine_.axes.size());
    take_range_option(machine_, text, all);
    return all;
  }
  std::vector<std::optional<AxisRange>> grid(const std::vector<std::string>& texts) {
    std::vector<std::optional<AxisRange>> all(machine_.axes.size());
    for (const std::string& text : texts) take_grid_option(machine_, text, all);
    return all;
  }
  Machine machine_;
};

TEST_F(AnAxisOption, MayBeNamesOfAxesAlone) {
  EXPECT_THAT(axes_named(machine_, "--hold", {"Z", "C"}), ElementsAre(2U, 0U));
  EXPECT_THAT(axes_named(machine_, "--hold", {}), IsEmpty());
  EXPECT_THAT(message_of([&] {
                static_cast<void>(axes_named(machine_, "--hold", {"X", "Q"}));
              }),
              HasSubstr("--hold Q: the machine has no such axis; expected w C' b X Z t"));
}

TEST_F(AnAxisOption, IsARangeInTheUnitOfItsAxisOrAPosition) {
  const auto range = ranges("X_mm=-100:200");
  ASSERT_TRUE(range[1].has_value());
  EXPECT_FALSE(range[0] || range[2]);
  EXPECT_EQ(range[1]->from, -100);
  EXPECT_EQ(range[1]->to, 200);
  EXPECT_DOUBLE_EQ(ranges("C_deg=720")[0]->from, 720 * kDegree) << "an endless axis has no travel";
  EXPECT_DOUBLE_EQ(ranges("C_deg=720")[0]->to, 720 * kDegree);
}

TEST_F(AnAxisOption, IsRefusedAsARangeThatIsTurnedRoundOrLeavesTheTravel) {
  const auto message = [&](const std::string& text) { return message_of([&] { static_cast<void>(ranges(text)); }); };
  EXPECT_THAT(message("X_mm=5:5"), HasSubstr("--range X_mm=5:5: needs a position, or two"));
  EXPECT_THAT(message("X_mm=0:1:2"), HasSubstr("needs a position, or two"));
  EXPECT_THAT(message("X_mm=0:201"), HasSubstr("positions within the travel, -100 to 200 in this unit"));
  EXPECT_THAT(message("X_deg=1"), HasSubstr("unit 'deg' for a linear axis"));
  EXPECT_THAT(message("Y_mm=1"), HasSubstr("the machine has no axis 'Y'"));
  EXPECT_THAT(message("X_mm=nan"), HasSubstr("not a number"));
  EXPECT_THAT(message("X_mm"), HasSubstr("AXIS_unit=from:to or AXIS_unit=position"));
}

TEST_F(AnAxisOption, IsAGridOfPositions) {
  const auto taken = grid({"X_mm=0:100:5", "C_deg=90"});
  EXPECT_EQ(taken[1]->count, 5U);
  EXPECT_EQ(taken[1]->to, 100);
  EXPECT_DOUBLE_EQ(taken[0]->from, 90 * kDegree);
  EXPECT_FALSE(taken[2].has_value());
}

TEST_F(AnAxisOption, IsRefusedAsAGridGivenTwiceOrWithoutACount) {
  const auto message = [&](const std::vector<std::string>& texts) {
    return message_of([&] { static_cast<void>(grid(texts)); });
  };
  EXPECT_THAT(message({"X_mm=1", "X_mm=0:1:2"}), HasSubstr("axis X was given before"));
  for (const char* const text : {"X_mm=0:1", "X_mm=0:1:1", "X_mm=0:1:2.5", "X_mm=0:1:2e6", "X_mm=0:1:2:3"}) {
    EXPECT_THAT(message({text}), HasSubstr("a whole number from 2 to 1,000,000")) << text;
  }
}

}  // namespace
}  // namespace abbe
