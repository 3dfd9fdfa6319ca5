#include "abbe/formats/controls/table_linuxcnc.h"

#include <gmock/gmock.h>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using Type = LinuxCncCompensation;

TEST(LinuxCncTable, BothTypesSayTheSameInTheirOwnColumns) {
  AxisTable table;
  table.positions = {0, 100.5, 200};
  table.forward = {0, -0.0123456, 0.002};
  table.reverse = {0.001, -0.0133456, 0.003};
  EXPECT_EQ(linuxcnc_text(table, false, Type::trim),
            "0.0000000 0.0000000 0.0010000\n"
            "100.5000000 -0.0123456 -0.0133456\n"
            "200.0000000 0.0020000 0.0030000\n");
  // Actual = nominal + error = nominal - correction.
  EXPECT_EQ(linuxcnc_text(table, false, Type::actual),
            "0.0000000 0.0000000 -0.0010000\n"
            "100.5000000 100.5123456 100.5133456\n"
            "200.0000000 199.9980000 199.9970000\n");
}

TEST(LinuxCncTable, WhatIsWrittenIsReadBackToItsDigits) {
  for (const Type type : {Type::actual, Type::trim}) {
    const AxisTable table = test::some_table(0, 0, 256, 7);
    test::expect_near(parse_linuxcnc(linuxcnc_text(table, false, type), "x.comp", false, type), table, 0.5e-7, 1.1e-7);
    AxisTable turn = test::some_table(0, 0, 20, 8);
    for (double& q : turn.positions) q /= 200;
    for (double& c : turn.forward) c /= 100;
    turn.reverse = turn.forward;
    test::expect_near(parse_linuxcnc(linuxcnc_text(turn, true, type), "c.comp", true, type), turn, 1e-9, 2e-9);
  }
}

TEST(LinuxCncTable, WhatLinuxCncWouldPassOverIsRefusedWithItsLine) {
  const auto refused = [](const std::string& text) {
    return test::refusal([&] { parse_linuxcnc(text, "x.comp", false, Type::trim); });
  };
  EXPECT_THAT(refused("# nominal forward reverse\n0 0 0\n"), HasSubstr("x.comp:1"));
  EXPECT_THAT(refused("0 0 0\n\n1 0 0\n"), HasSubstr("x.comp:2: LinuxCNC stops reading at a blank line"));
  EXPECT_THAT(refused("0 0 0\n1 0\n"), HasSubstr("x.comp:2: reverse trim"));
  EXPECT_THAT(refused("0 0 0\n0 0 0\n"), HasSubstr("not above the one before"));
  EXPECT_THAT(refused("0 nan 0\n"), HasSubstr("forward trim"));
  EXPECT_THAT(refused("0 0 1e99\n"), HasSubstr("too large"));
  EXPECT_THAT(refused(""), HasSubstr("no points"));
  std::string many;
  for (int k = 0; k < 257; ++k) many += std::to_string(k) + " 0 0\n";
  EXPECT_THAT(refused(many), HasSubstr("at most 256 points"));
}

}  // namespace
}  // namespace abbe
