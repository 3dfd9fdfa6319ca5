#include "abbe/formats/evaluations/evaluation_thermal_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using testing::StartsWith;

std::string refused_thermal(const std::string& text, const ColumnMapping& mapping = {}) {
  return message_of([&] { parse_thermal(text, "t.csv", mapping); });
}

std::string refused_axis(const std::string& text) {
  return message_of([&] { parse_axis_distortion(text, "t.csv"); });
}

TEST(ThermalFile, UnitsSayWhatASensorReads) {
  const ThermalReadings readings = parse_thermal(
      "# logger\n\nair_degC,time_h,X1_um,nose Z_mm,A_arcsec\n20,0,1.5,0.002,3\n20.5,0.5,2.5,0.001,4\n", "t.csv");
  ASSERT_EQ(readings.displacements.size(), 2U);
  EXPECT_EQ(readings.displacements[0].name, "X1");
  EXPECT_EQ(readings.displacements[0].time, (std::vector<double>{0, 1800}));
  EXPECT_EQ(readings.displacements[0].values, (std::vector<double>{0.0015, 0.0025}));
  EXPECT_EQ(readings.displacements[1].name, "nose Z");
  EXPECT_EQ(readings.displacements[1].values[0], 0.002);
  ASSERT_EQ(readings.angles.size(), 1U);
  EXPECT_DOUBLE_EQ(readings.angles[0].values[1], 4 * kArcsec);
  ASSERT_EQ(readings.temperatures.size(), 1U);
  EXPECT_EQ(readings.temperatures[0].values, (std::vector<double>{20, 20.5}));
  const ThermalReadings minutes = parse_thermal("time_min,X_um\n-5,0\n0.1,1\n", "t.csv");
  EXPECT_EQ(minutes.displacements[0].time, (std::vector<double>{-300, 6}));
}

TEST(ThermalFile, EmptyFieldsAreGaps) {
  const ThermalReadings readings = parse_thermal("time_s,X_um,air_degC\n0,1,20\n1,,\n2,3,\n3,4,21\n", "t.csv");
  EXPECT_EQ(readings.displacements[0].time, (std::vector<double>{0, 2, 3}));
  EXPECT_EQ(readings.temperatures[0].time, (std::vector<double>{0, 3}));
  const ThermalReadings columns = parse_thermal(
      NamedColumns{{"time_s", std::vector<double>{0, 1, 2}}, {"X_um", std::vector<double>{1, std::nan(""), 3}}});
  EXPECT_EQ(columns.displacements[0].time, (std::vector<double>{0, 2}));
}

TEST(ThermalFile, ColumnsMayHaveOtherNamesAndBeIgnored) {
  const ThermalReadings readings =
      parse_thermal("t,probe,comment\n0,1,a\n1,2,b\n", "t.csv", {{{"time_min", "t"}, {"Z_um", "probe"}}, {"comment"}});
  ASSERT_EQ(readings.displacements.size(), 1U);
  EXPECT_EQ(readings.displacements[0].name, "Z");
  EXPECT_EQ(readings.displacements[0].time[1], 60);
}

TEST(ThermalFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(refused_thermal("time_s,X_um\n0,1\n5,1\n5,2\n"),
            "t.csv:4: time_s: 5 s follows 5 s; expected rows in chronological order; times must not restart at "
            "midnight");
  EXPECT_THAT(refused_thermal("time_h,X_um\n23.9,1\n0.1,2\n"), StartsWith("t.csv:3: time_h: 360 s follows 86040 s"));
  EXPECT_EQ(refused_thermal("time_s,X\n0,1\n"),
            "t.csv:1: X: the name of this column does not end in a unit of a length, an angle or a temperature; "
            "expected a name such as X1_um, A_urad or air_degC");
  EXPECT_EQ(refused_thermal("X_um\n0\n1\n"),
            "t.csv:1: time: missing column; expected time_s, time_ms, time_min or time_h");
  EXPECT_EQ(refused_thermal("time_s,air_degC\n0,20\n1,20\n"),
            "t.csv: X_um: there is no column of a displacement or an angle; expected columns such as X_um, Z_um or "
            "A_urad");
  EXPECT_EQ(refused_thermal("time_s,X_um,X_urad\n0,1,1\n1,1,1\n"),
            "t.csv:1: X_urad: 'X' is a displacement and an angle; expected sensors of other names");
  EXPECT_THAT(refused_thermal("time_s,X_um,X_mm\n0,1,1\n1,1,1\n"), StartsWith("t.csv:1:13: X_mm: says the same as"));
  EXPECT_EQ(refused_thermal("time_s,X_um\n0,1\n"), "t.csv: X_um: 1 reading; expected two at least: a change over time");
  EXPECT_EQ(refused_thermal("time_s,X_um\n0,\n1,\n"),
            "t.csv: X_um: 0 readings; expected two at least: a change over time");
  EXPECT_THAT(refused_thermal("time_s,X_um,air_degC\n0,1,-280\n1,1,20\n"),
              StartsWith("t.csv:2: air_degC: -280 \xC2\xB0\x43 is below absolute zero"));
  EXPECT_THAT(refused_thermal("time_s;X_um\n0;1\n"), testing::HasSubstr("not separated by commas"));
  EXPECT_THAT(refused_thermal(""), StartsWith("t.csv: the file is empty"));
  EXPECT_THAT(refused_thermal("time_s,X_um\n0,x\n"), StartsWith("t.csv:2:3: X_um: 'x' is not a number"));
  EXPECT_THAT(refused_thermal("time_s,X_um\n,1\n1,1\n"), StartsWith("t.csv:2:1: time_s:"));
  EXPECT_THAT(refused_thermal("time_us,X_um\n0,1\n"), testing::HasSubstr("'us' is not a unit of a time"));
}

TEST(AxisDistortionFile, TargetsAndApproachesAreToldApart) {
  const AxisDistortionReadings readings = parse_axis_distortion(
      "time_min,target_mm,direction,actual_mm,B_urad,air_degC\n0,400,+,400.001,1,20\n0,0,+,0.002,2,20\n1,0,-,0.001,3,"
      "21\n"
      "1,400,-,400,4,21\n2,400,+,400.002,5,22\n2,0,+,0.002,6,22\n3,0,-,0.001,7,23\n3,400,-,400.001,8,23\n",
      "t.csv");
  ASSERT_EQ(readings.targets.size(), 4U);
  EXPECT_EQ(readings.targets[0].target, 0);
  EXPECT_EQ(readings.targets[0].approach, "+");
  EXPECT_EQ(readings.targets[3].approach, "-");
  EXPECT_EQ(readings.targets[2].deviation.time, (std::vector<double>{0, 120}));
  EXPECT_NEAR(readings.targets[2].deviation.values[1], 0.002, 1e-12);
  EXPECT_EQ(readings.targets[2].angles[0].values, (std::vector<double>{1e-6, 5e-6}));
  ASSERT_EQ(readings.temperatures.size(), 1U);
  EXPECT_EQ(readings.temperatures[0].values, (std::vector<double>{20, 21, 22, 23}));
}

TEST(AxisDistortionFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(refused_axis("time_s,target_mm,deviation_um\n0,5,1\n1,5,1\n"),
            "t.csv: target_mm: there is one target position; expected two at least: the change of their distance");
  EXPECT_EQ(refused_axis("time_s,target_mm,deviation_um\n0,5,1\n1,9,1\n2,5,1\n"),
            "t.csv: deviation_um: 1 reading at the target 9 mm; expected two at least: a change over time");
  EXPECT_EQ(refused_axis("time_s,target_mm,direction,deviation_um\n0,5,+,1\n1,9,up,1\n"),
            "t.csv:3: direction: 'up' is not a direction of approach; expected + or -");
  EXPECT_EQ(refused_axis("time_s,target_mm\n0,5\n1,9\n"),
            "t.csv: deviation: missing column; expected deviation_um or actual_mm, one of them");
  EXPECT_EQ(refused_axis("time_s,target_mm,deviation_um,actual_mm\n0,5,1,5\n1,9,1,9\n"),
            "t.csv: deviation: is given together with the actual positions; expected deviation_um or actual_mm, one of "
            "them");
  EXPECT_THAT(refused_axis("time_s,target_mm,deviation_um\n0,5,1\n0,9,1\n0,5,1\n"),
              StartsWith("t.csv:4: time_s: 0 s follows 0 s"));
}

TEST(ThermalFile, OfAnotherProgramIsReadWithItsUnits) {
  const std::filesystem::path path = test::empty_folder("thermal_file") / "log.csv";
  std::ofstream(path) << "time [min];Z1 [mm];A [mrad];air_degC\n0;0,0015;0,25;20,5\n10;0,0025;0,5;\n20;-0,001;;21\n";
  const ThermalReadings readings = read_thermal(path);
  ASSERT_EQ(readings.displacements.size(), 1U);
  EXPECT_EQ(readings.displacements[0].name, "Z1");
  EXPECT_EQ(readings.displacements[0].time, (std::vector<double>{0, 600, 1200}));
  EXPECT_EQ(readings.displacements[0].values, (std::vector<double>{0.0015, 0.0025, -0.001}));
  ASSERT_EQ(readings.angles.size(), 1U);
  EXPECT_EQ(readings.angles[0].time.size(), 2U);
  EXPECT_DOUBLE_EQ(readings.angles[0].values[1], 0.5e-3);
  EXPECT_EQ(readings.temperatures[0].values, (std::vector<double>{20.5, 21}));
  std::ofstream(path) << "time_min;speed\n0;1,5\n1;2,5\n";
  EXPECT_EQ(
      message_of([&] { read_thermal(path); }).substr(path.string().size()),
      ":1: speed: the name of this column does not end in a unit of a length, an angle or a temperature; expected "
      "a name such as X1_um, A_urad or air_degC");
}

}  // namespace
}  // namespace abbe
