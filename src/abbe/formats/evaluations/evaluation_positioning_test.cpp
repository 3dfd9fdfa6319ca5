#include "abbe/formats/evaluations/evaluation_positioning.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

std::string refused(const std::string& text) {
  return message_of([&] { parse_positioning(text, "p.csv"); });
}

TEST(PositioningFile, DeviationsAndActualPositionsGiveTheSameReadings) {
  const PositioningFile deviations =
      parse_positioning("run,direction,target_mm,deviation_um\n1,+,100,2.5\n1,-,100,-1\n", "p.csv");
  const PositioningFile actual =
      parse_positioning("target_m,actual_mm,direction\n0.1,100.0025,positive\n0.1,99.999,negative\n", "p.csv");
  ASSERT_EQ(deviations.readings.size(), 2U);
  EXPECT_FALSE(deviations.rotary);
  EXPECT_EQ(deviations.readings[0].deviation, 0.0025);
  EXPECT_EQ(deviations.readings[1].direction, ApproachDirection::negative);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_EQ(actual.readings[i].target, 100);
    EXPECT_NEAR(actual.readings[i].deviation, deviations.readings[i].deviation, 1e-13);
    EXPECT_EQ(actual.readings[i].direction, deviations.readings[i].direction);
  }
}

TEST(PositioningFile, OfARotaryAxisIsInRadians) {
  const PositioningFile file = parse_positioning("direction,target_deg,deviation_arcsec\n+,90,-3\n", "p.csv");
  EXPECT_TRUE(file.rotary);
  EXPECT_DOUBLE_EQ(file.readings[0].target, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(file.readings[0].deviation, -3 * kArcsec);
}

TEST(PositioningFile, SaysWhatIsWrongAndWhere) {
  const std::string header = "run,direction,target_mm,deviation_um\n";
  EXPECT_EQ(refused(header + "1,+,0,0\n# remark\n2,up,0,0\n"),
            "p.csv:4: direction: 'up' is not a direction of approach; expected + or -");
  EXPECT_EQ(
      refused(header + "1,+,0,0\n1,-,0,0\n1,+,0,1\n"),
      "p.csv:4: run: run 1 approaches this target twice from the same side, first in line 2; expected one reading "
      "per run, direction and target");
  EXPECT_EQ(refused(header + "1,+,0,x\n"), "p.csv:2:7: deviation_um: 'x' is not a number; expected a length in um");
  EXPECT_EQ(refused("direction,deviation_um\n+,0\n"),
            "p.csv: target: missing column; expected target_mm for a linear axis, target_deg for a rotary one");
  EXPECT_EQ(refused("direction,target_mm\n+,0\n"),
            "p.csv: deviation: missing column; expected deviation_um or actual_mm, one of them");
  EXPECT_EQ(refused("direction,target_deg,deviation_um\n+,0,0\n"),
            "p.csv: deviation_um: is a length, but the targets are angles; expected deviation_arcsec or _deg");
  EXPECT_EQ(refused("direction,target_mm,actual_deg\n+,0,0\n"),
            "p.csv: actual_deg: is an angle, but the targets are lengths; expected actual_um or _mm");
  EXPECT_EQ(refused("direction,target_mm,target_deg,deviation_um\n+,0,0,0\n"),
            "p.csv: target_deg: is given together with target_mm; expected only one of them");
  EXPECT_EQ(
      refused("direction,target_mm,deviation_um,actual_mm\n+,0,0,0\n"),
      "p.csv: deviation: is given together with the actual positions; expected deviation_um or actual_mm, one of them");
  EXPECT_EQ(refused("target_mm,deviation_um\n0,0\n"), "p.csv:1: direction: missing column; expected direction");
  EXPECT_EQ(refused("direction,target_deg,actual_deg\n+,0,359.999\n"),
            "p.csv:2: actual_deg: is more than half a turn from the target; expected angles counted on through full "
            "turns, like the targets");
  EXPECT_EQ(refused("diagonal,direction,target_mm,actual_mm\nPPP,+,0,0\n"),
            "p.csv: diagonal: the file holds diagonals; expected abbe evaluate diagonals, or no such column");
}

TEST(PositioningFile, AColumnWithoutAUnitIsToldThoseOfLengthsAndAngles) {
  EXPECT_EQ(refused("direction,target,deviation_um\n+,0,0\n"),
            "p.csv:1:11: target: the unit is missing from the name of this column; expected target_mm, target_um or "
            "target_m, or target_rad, target_mrad, target_urad, target_deg or target_arcsec");
  EXPECT_EQ(refused("direction,target_mm,deviation_kg\n+,0,0\n").substr(0, 76),
            "p.csv:1:21: deviation_kg: 'kg' is not a unit of a length or an angle; expect");
}

TEST(PositioningFile, MayHaveTemperaturesAndTimes) {
  const PositioningFile file = parse_positioning(
      "time_min,direction,target_mm,deviation_um,machine_degC,instrument_degC\n1,+,0,0,22.5,21\n2,-,0,1,23,21.5\n",
      "p.csv");
  EXPECT_EQ(file.machine_temperature, (std::vector<double>{22.5, 23}));
  EXPECT_EQ(file.instrument_temperature, (std::vector<double>{21, 21.5}));
  EXPECT_EQ(file.time, (std::vector<double>{60, 120}));
  EXPECT_TRUE(parse_positioning("direction,target_mm,deviation_um\n+,0,0\n", "p.csv").machine_temperature.empty());
  EXPECT_EQ(refused("direction,target_deg,deviation_arcsec,machine_degC\n+,0,0,20\n"),
            "p.csv: machine_degC: is the temperature of a length, but the targets are angles; expected no such column "
            "of a rotary axis");
}

TEST(DiagonalsFile, SortsReadingsByTheNameOfTheDiagonal) {
  const auto diagonals = parse_diagonals(
      "diagonal,run,direction,target_mm,deviation_um\n+X+Y+Z,1,+,0,1\n-X+Y+Z,1,+,0,2\n+X+Y+Z,1,+,50,3\n", "d.csv");
  ASSERT_EQ(diagonals.size(), 2U);
  EXPECT_EQ(diagonals[0].name, "+X+Y+Z");
  ASSERT_EQ(diagonals[0].readings.size(), 2U);
  EXPECT_EQ(diagonals[0].readings[1].target, 50);
  EXPECT_EQ(diagonals[1].readings[0].deviation, 0.002);
}

TEST(DiagonalsFile, HasNamesAndNoAngles) {
  EXPECT_EQ(message_of([] { parse_diagonals("direction,target_mm,deviation_um\n+,0,0\n", "d.csv"); }),
            "d.csv:1: diagonal: missing column; expected diagonal");
  EXPECT_EQ(message_of([] { parse_diagonals("diagonal,direction,target_deg,actual_deg\na,+,0,0\n", "d.csv"); }),
            "d.csv: target_deg: a diagonal has no angles; expected target_mm: the distance along the diagonal");
}

}  // namespace
}  // namespace abbe
