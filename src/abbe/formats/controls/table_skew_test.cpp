#include "abbe/formats/controls/table_skew.h"

#include <gmock/gmock.h>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

TEST(SkewTable, FactorsAreReadBackToTheirDigits) {
  const SkewFactors factors = {3.5e-5, -2.2e-5, 0.0123};
  EXPECT_EQ(marlin_skew_text(factors), "M852 I0.000035000 J-0.000022000 K0.012300000\nM500\n");
  EXPECT_EQ(parse_marlin_skew(marlin_skew_text(factors), "m.gcode"), factors);
  const SkewFactors klipper = parse_klipper_skew(klipper_skew_text(factors), "k.gcode");
  EXPECT_NEAR(klipper.xy, factors.xy, 2e-8);
  EXPECT_NEAR(klipper.xz, factors.xz, 2e-8);
  EXPECT_NEAR(klipper.yz, factors.yz, 2e-8);
}

TEST(SkewTable, KlippersOwnExampleGivesTheFactorsOfItsFormula) {
  // SET_SKEW XY=140.4,142.8,99.8 of the documentation; the value by the documented formula in another program.
  const SkewFactors factors = parse_klipper_skew("SET_SKEW XY=140.4,142.8,99.8\n", "k");
  EXPECT_NEAR(factors.xy, -0.0169507368, 1e-9);
  EXPECT_EQ(factors.xz, 0);
}

TEST(SkewTable, WhatIsWrongIsRefused) {
  const auto klipper = [](const std::string& text) { return test::refusal([&] { parse_klipper_skew(text, "k"); }); };
  EXPECT_THAT(klipper("SET_SKEW XY=1,2\n"), HasSubstr("three lengths"));
  EXPECT_THAT(klipper("SET_SKEW XY=1,1,100\n"), HasSubstr("no such parallelogram"));
  EXPECT_THAT(klipper("SET_SKEW XY=0,1,1\n"), HasSubstr("is not above zero"));
  EXPECT_THAT(klipper("SET_SKEW XY=199,20,100\n"), HasSubstr("beyond 45 degrees"));
  EXPECT_THAT(klipper("SET_SKEW ZX=1,1,1\n"), HasSubstr("not understood"));
  EXPECT_THAT(klipper("# nothing\n"), HasSubstr("no factors"));
  const auto marlin = [](const std::string& text) { return test::refusal([&] { parse_marlin_skew(text, "m"); }); };
  EXPECT_THAT(marlin("M852 I2\n"), HasSubstr("out of range"));
  EXPECT_THAT(marlin("M852 I0 I0\n"), HasSubstr("each once"));
  EXPECT_THAT(marlin("M852 Q1\n"), HasSubstr("not understood"));
  EXPECT_THAT(marlin("G1 X2\n"), HasSubstr("m:1"));
  EXPECT_THAT(marlin("M852 Ix\n"), HasSubstr("is not a number"));
}

}  // namespace
}  // namespace abbe
