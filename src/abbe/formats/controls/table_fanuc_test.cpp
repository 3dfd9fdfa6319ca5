#include "abbe/formats/controls/table_fanuc.h"

#include <gmock/gmock.h>

#include "abbe/formats/controls/table_for_test.h"
#include "abbe/formats/controls/table_heidenhain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::vector<TableAxisName> kNumbers = {{0, "1", false}, {1, "2", false}, {2, "4", true}};

AxisTable pitch_table() {
  AxisTable table;
  table.positions = {-100, -50, 0, 50, 100};
  table.forward = table.reverse = {0.004, 0.0031, 0.001, 0.0014, -0.003};
  return table;
}

TEST(FanucTable, PitchDataAreStepsFromPointToPointWithZeroAtTheReference) {
  const FanucPitch pitch = fanuc_pitch(pitch_table(), 0.001, 40, 0);
  EXPECT_EQ(pitch.reference_point, 42U);
  EXPECT_EQ(pitch.magnification, 1);
  // Minus the value at the reference, in um: 3, 2.1, 0, 0.4, -4.
  EXPECT_EQ(pitch.steps, (std::vector<int>{0, -1, -2, 0, -4}));
  EXPECT_EQ(fanuc_pitch_text({pitch}, kNumbers),
            "%\nN03620A1P42\nN03621A1P40\nN03622A1P44\nN03623A1P1\nN03624A1P50.0\n"
            "N10040P0\nN10041P-1\nN10042P-2\nN10043P0\nN10044P-4\n%\n");
  const AxisTable table = fanuc_table(pitch, 0.001, 0);
  for (const double q : {-100.0, -50.0, 0.0, 50.0, 100.0}) {
    EXPECT_NEAR(table.at(q), pitch_table().at(q) - 0.001, 0.00051) << q;
  }
}

TEST(FanucTable, LargeStepsRaiseTheMagnificationAndWhatIsWrittenIsReadBack) {
  AxisTable steep = test::some_table(1, 1, 31, 6);
  const FanucPitch a = fanuc_pitch(pitch_table(), 0.001, 0, -50), b = fanuc_pitch(steep, 0.001, 5, steep.positions[7]);
  EXPECT_GT(b.magnification, 1);
  for (const int step : b.steps) EXPECT_LE(std::abs(step), kFanucLargestStep);
  const std::vector<FanucPitch> read = parse_fanuc_pitch(fanuc_pitch_text({a, b}, kNumbers), "p", kNumbers);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].steps, a.steps);
  EXPECT_EQ(read[1].steps, b.steps);
  EXPECT_EQ(read[1].reference_point, b.reference_point);
  EXPECT_NEAR(read[1].interval, b.interval, 1e-6);
  EXPECT_EQ(b.reference_point, 12U);
  for (const double q : {-100.0, 100.0, 500.0}) {
    EXPECT_NEAR(fanuc_table(read[1], 0.001, 3).at(q), fanuc_table(b, 0.001, 3).at(q), 1e-6);
  }
}

TEST(FanucTable, WhatIsWrongIsRefused) {
  const std::string good = fanuc_pitch_text({fanuc_pitch(pitch_table(), 0.001, 0, -50)}, kNumbers);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return test::refusal([&] { parse_fanuc_pitch(text, "p", kNumbers); });
  };
  EXPECT_THAT(changed("N10002P", "N10009P"), HasSubstr("no data for point 2"));
  EXPECT_THAT(changed("N03623A1P1", "N03623A1P1.5"), HasSubstr("3623 is out of range"));
  EXPECT_THAT(changed("N03620A1P", "N03620A7P"), HasSubstr("axes 1, 2 or 4"));
  EXPECT_THAT(changed("N03624A1P50.0", "N03624A1P0"), HasSubstr("3624 is too small"));
  EXPECT_THAT(changed("N03624", "N01240"), HasSubstr("unknown parameter"));
  EXPECT_THAT(changed("N10001P", "N10000P"), HasSubstr("is given twice"));
  EXPECT_THAT(changed("N10001P-1", "N10001P-900"), HasSubstr("out of range"));
  EXPECT_THAT(test::refusal([&] { parse_fanuc_pitch("%\n%\n", "p", kNumbers); }), HasSubstr("no axis"));
}

TEST(HeidenhainTable, ColumnsOfOneAxisAreWrittenAndReadBack) {
  AxisTable own = test::some_table(0, 0, 50, 1), cross = test::some_table(0, 1, 50, 2);
  const std::string text = heidenhain_com_text({own, cross}, test::kXYC, -1);
  EXPECT_THAT(text, testing::StartsWith("BEGIN X.COM MM\nNR AXISPOS X Y\n0 -100.000000 "));
  const std::vector<AxisTable> read = parse_heidenhain_com(text, "X.COM", 0, test::kXYC, -1);
  ASSERT_EQ(read.size(), 2U);
  test::expect_near(read[0], own, 0.51e-6, 0.51e-6);
  test::expect_near(read[1], cross, 0.51e-6, 0.51e-6);
}

TEST(HeidenhainTable, WhatIsWrongIsRefused) {
  const auto refused = [](const std::string& text) {
    return test::refusal([&] { parse_heidenhain_com(text, "X.COM", 0, test::kXYC, 1); });
  };
  const std::string head = "BEGIN X.COM MM\nNR AXISPOS X\n";
  EXPECT_THAT(refused("G0\n"), HasSubstr("no table of a control"));
  EXPECT_THAT(refused("BEGIN X.COM MM\nNR AXISPOS BACKLASH X\n"), HasSubstr("unknown column 'BACKLASH'"));
  EXPECT_THAT(refused(head + "0 0 0\n"), HasSubstr("no [END]"));
  EXPECT_THAT(refused(head + "1 0 0\n[END]\n"), HasSubstr("is not the next number"));
  EXPECT_THAT(refused(head + "0 0 0\n1 0 0\n[END]\n"), HasSubstr("not above the one before"));
  EXPECT_THAT(refused(head + "0 0\n[END]\n"), HasSubstr("2 fields"));
  EXPECT_THAT(refused(head + "0 0 x\n[END]\n"), HasSubstr("X.COM:3"));
  EXPECT_THAT(refused(head + "[END]\nmore\n"), HasSubstr("behind [END]"));
}

}  // namespace
}  // namespace abbe
