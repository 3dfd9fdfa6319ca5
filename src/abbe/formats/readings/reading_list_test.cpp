#include "abbe/formats/readings/reading_list.h"

#include <gmock/gmock.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ReadingList listed(const std::string& text) {
  return parse_reading_list(text, "r.csv", parse_chain("w C' b X Z t").machine);
}

std::string refusal(const std::string& text) {
  try {
    listed(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(AReadingList, IsWhatAPlanWrites) {
  const ReadingList list =
      listed("# plan\nC_deg,X_mm,Z_mm,setup,station,reflector\n90,1.5,-2,tracker,front,\"r,1\"\n\n0,2,3,bar,-,long\n");
  ASSERT_EQ(list.readings.size(), 2U);
  EXPECT_EQ(list.what, "reflector");
  EXPECT_FALSE(list.has_approach);
  const ListedReading& first = list.readings[0];
  EXPECT_EQ(first.line, 3U);
  EXPECT_DOUBLE_EQ(first.pose[0], 90 * kDegree);
  EXPECT_DOUBLE_EQ(first.pose[1], 1.5);
  EXPECT_DOUBLE_EQ(first.pose[2], -2);
  EXPECT_EQ(first.setup, "tracker");
  EXPECT_EQ(first.station, "front");
  EXPECT_EQ(first.what, "r,1");
  EXPECT_EQ(list.readings[1].line, 5U);
  EXPECT_EQ(list.readings[1].station, "");
}

TEST(AReadingList, PassesOverTheValuesOfAMeasurementFile) {
  const ReadingList list = listed(
      "\xEF\xBB\xBFX_um,measured_x_mm,Z_mm,C_rad,X_approach,azimuth_deg,point,u_um\n"
      "1500,9,2,0.5,1,7,left,0.1\n");
  ASSERT_EQ(list.readings.size(), 1U);
  EXPECT_TRUE(list.has_approach);
  EXPECT_TRUE(list.what.empty());
  EXPECT_DOUBLE_EQ(list.readings[0].pose[0], 0.5);
  EXPECT_DOUBLE_EQ(list.readings[0].pose[1], 1.5);
  EXPECT_EQ(list.readings[0].point, "left");
}

TEST(AReadingList, IsRefusedWithTheLineAndWhatWasExpected) {
  EXPECT_THAT(refusal("C_deg,X_mm\n0,1\n"), HasSubstr("Z: missing column"));
  EXPECT_THAT(refusal("C_deg,X_kg,Z_mm\n0,1,2\n"), HasSubstr("X_kg"));
  EXPECT_THAT(refusal("C_deg,X_mm,Z_mm\n0,1,2\n0,251,2\n"), HasSubstr("r.csv:3: X_mm: 251 mm is outside the travel"));
  EXPECT_THAT(refusal("C_deg,X_mm,Z_mm\n0,one,2\n"), HasSubstr("r.csv:2"));
  EXPECT_THAT(refusal("C_deg,X_mm,Z_mm\n"), HasSubstr("r.csv"));
  EXPECT_THAT(refusal(""), HasSubstr("r.csv"));
  EXPECT_THAT(refusal("C_deg,X_mm,Z_mm,item,target\n0,1,2,a,b\n"), HasSubstr("target: is given together with item"));
  EXPECT_THAT(refusal("C_deg;X_mm;Z_mm\n0;1;2\n"), HasSubstr("not separated by commas"));
}

TEST(AReadingList, IsAlsoMadeOfPosesThatAreInNoFile) {
  const Machine machine = parse_chain("w C' b X Z t").machine;
  const auto refusal_of = [&](const PoseList& poses) {
    try {
      listed_readings(poses, "positions", machine);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  PoseList poses;
  poses.append({90 * kDegree, 1.5, -2});
  poses.append({0, 250, 3});
  const ReadingList list = listed_readings(poses, "positions", machine);
  ASSERT_EQ(list.readings.size(), 2U);
  EXPECT_EQ(list.readings[0].pose, poses.pose(0));
  EXPECT_EQ(list.readings[1].pose, poses.pose(1));
  EXPECT_EQ(list.readings[1].line, 0U);
  EXPECT_TRUE(list.what.empty());
  poses.append({0, 251, 3});
  EXPECT_THAT(refusal_of(poses), HasSubstr("positions: reading 3: 251 mm is outside the travel of axis X"));
  EXPECT_THAT(refusal_of({}), HasSubstr("positions: has no reading"));
}

TEST(AReading, IsNamedWithItsLineIfItHasOne) {
  EXPECT_EQ(reading_words(12, listed("C_deg,X_mm,Z_mm\n0,1,2\n").readings[0]), "reading 12 (line 2)");
  EXPECT_EQ(reading_words(3, {}), "reading 3");
}

}  // namespace
}  // namespace abbe
