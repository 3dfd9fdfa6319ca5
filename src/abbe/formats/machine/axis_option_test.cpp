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

const Machine& turning_machine() {
  static const Machine machine = parse_chain("w C' b X Z t").machine;
  return machine;
}

TEST(AnAxisOption, NamesAnAxisAndItsPositionWithTheUnit) {
  const HeldAxis held = axis_option(turning_machine(), "--hold", "C_deg=30");
  EXPECT_EQ(held.axis, 0U);
  EXPECT_DOUBLE_EQ(held.position, 30 * kDegree);
  EXPECT_EQ(axis_options(turning_machine(), "--hold", {"X_mm=1", "Z_mm=-2"})[1].position, -2);
  EXPECT_THAT(message_of([] { static_cast<void>(axis_option(turning_machine(), "--hold", "C_mm=30")); }),
              HasSubstr("--hold C_mm=30"));
}

TEST(AnAxisOption, MayBeNamesOfAxesAlone) {
  EXPECT_THAT(axes_named(turning_machine(), "--hold", {"Z", "C"}), ElementsAre(2U, 0U));
  EXPECT_THAT(axes_named(turning_machine(), "--hold", {}), IsEmpty());
  EXPECT_THAT(message_of([] {
                static_cast<void>(axes_named(turning_machine(), "--hold", {"X", "Q"}));
              }),
              HasSubstr("--hold Q: the machine has no such axis; expected w C' b X Z t"));
}

}  // namespace
}  // namespace abbe
