#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/formats/evaluations/evaluation_rotation_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

std::string circular(const std::string& text) {
  return message_of([&] { parse_circular(text, "c.csv", 100); });
}
std::string rotation(const std::string& text) {
  return message_of([&] { parse_rotation(text, "r.csv"); });
}
std::string straight(const std::string& text) {
  return message_of([&] { parse_straightness(text, "s.csv"); });
}
std::string square(const std::string& text) {
  return message_of([&] { parse_squareness(text, "q.csv"); });
}

TEST(EvaluationCircularFile, ReadsBallBarDeviationsAndRadiiByDirection) {
  const CircularFile file =
      parse_circular("# ball bar\nangle_deg,direction,deviation_um\n0,ccw,1.5\n90,ccw,-2\n180,cw,0\n", "c.csv", 100);
  const CircularReadings &cw = file.paths[0], &ccw = file.paths[1];
  EXPECT_EQ(file.plane, "");
  EXPECT_EQ(cw.kind, CircularAngle::commanded);
  EXPECT_EQ(cw.radius, (std::vector<double>{100}));
  ASSERT_EQ(ccw.count(), 2U);
  EXPECT_DOUBLE_EQ(ccw.angle[1], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(ccw.radius[0], 100.0015);
  EXPECT_EQ(parse_circular("angle_rad,direction,radius_mm\n1,cw,150.25\n", "c.csv", 100).paths[0].radius[0], 150.25);
}

TEST(EvaluationCircularFile, ReadsPointsOfTheThreePlanesWithAnglesFromFirstToSecondAxis) {
  const CircularFile zx = parse_circular("X_mm,Z_mm,direction\n100,0,cw\n0,100,cw\n", "c.csv", 100);
  EXPECT_EQ(zx.plane, "ZX");
  EXPECT_EQ(zx.paths[0].kind, CircularAngle::measured);
  EXPECT_DOUBLE_EQ(zx.paths[0].angle[0], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(zx.paths[0].angle[1], 0);
  EXPECT_EQ(parse_circular("Z_mm,Y_um,direction\n3,4000,ccw\n", "c.csv", 100).plane, "YZ");
  EXPECT_DOUBLE_EQ(parse_circular("X_mm,Y_um,direction\n3,4000,ccw\n", "c.csv", 100).paths[1].radius[0], 5);
}

TEST(EvaluationCircularFile, RowsInNoOrderArePutInThatOfThePath) {
  const auto angles = [](const std::string& rows) {
    return parse_circular("angle_deg,direction,radius_mm\n" + rows, "c.csv", 100).paths[0].angle;
  };
  const std::vector<double> sorted = angles("300,cw,100\n0,cw,100\n90,cw,100\n10,cw,100\n200,cw,100\n");
  EXPECT_TRUE(std::is_sorted(sorted.begin(), sorted.end()));
  // Driven clockwise from 90 degrees on, past zero: as it is.
  const std::vector<double> driven = angles("90,cw,100\n10,cw,100\n300,cw,100\n200,cw,100\n100,cw,100\n");
  EXPECT_GT(driven[0], driven[1]);
  EXPECT_GT(driven[2], driven[0]);
}

TEST(EvaluationCircularFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(circular("angle_deg,deviation_um\n0,1\n"), "c.csv:1: direction: missing column; expected direction");
  EXPECT_EQ(circular("angle_deg,direction,deviation_um\n0,cw,1\n1,left,1\n"),
            "c.csv:3: direction: 'left' is not a direction; expected cw (clockwise) or ccw (counter-clockwise)");
  EXPECT_EQ(circular("direction,deviation_um\ncw,1\n"),
            "c.csv: angle: missing column; expected angle_rad, angle_mrad, angle_urad, angle_deg or angle_arcsec");
  EXPECT_EQ(circular("angle_deg,direction\n0,cw\n"),
            "c.csv: deviation: missing column; expected deviation_um or radius_mm");
  EXPECT_EQ(circular("angle_deg,direction,deviation_mm\n0,cw,-100\n"),
            "c.csv:2: deviation_mm: the radius is 0 mm; expected a radius near the nominal 100 mm");
  const std::string either = "; expected angle_deg with deviation_um or radius_mm, or two of X_mm, Y_mm, Z_mm";
  EXPECT_EQ(circular("angle_deg,direction,deviation_mm,Y_mm\n0,cw,1,1\n"),
            "c.csv: Y_mm: is given together with columns of a ball bar" + either);
  EXPECT_EQ(circular("angle_deg,direction,deviation_mm,radius_mm\n0,cw,1,1\n"),
            "c.csv: radius_mm: is given together with the deviation" + either);
  EXPECT_EQ(circular("direction,Y_mm\ncw,1\n"), "c.csv: Y_mm: is the only coordinate" + either);
  EXPECT_EQ(circular("direction,X_mm,Y_mm,Z_mm\ncw,1,1,1\n"), "c.csv: X_mm: is one of three" + either);
  EXPECT_EQ(circular("direction,X_mm,Y_mm\ncw,1,1\ncw,0,1e-9\n"),
            "c.csv:3: X_mm: the point is the centre; expected coordinates from the centre of the nominal circle");
}

TEST(EvaluationRotationFile, AnglesThatBeginAnewRunOn) {
  const RotationReadings up =
      parse_rotation("angle_deg,x1_um,axial_mm\n0,1,2\n120,3,4\n240,5,6\n0,7,8\n120,9,10\n", "r");
  ASSERT_EQ(up.angle.size(), 5U);
  EXPECT_DOUBLE_EQ(up.angle[3], 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(up.angle[4], 2 * std::numbers::pi + 2 * std::numbers::pi / 3);
  EXPECT_DOUBLE_EQ(up.x1[1], 0.003);
  EXPECT_EQ(up.axial[4], 10);
  EXPECT_TRUE(up.y1.empty() && up.face.empty());
  const RotationReadings down = parse_rotation("angle_deg,face_um\n100,1\n10,2\n280,3\n190,3\n100,4\n10,4\n", "r");
  EXPECT_DOUBLE_EQ(down.angle[5], down.angle[1] - 2 * std::numbers::pi);
  const RotationReadings on = parse_rotation("angle_deg,x2_um,y2_um\n350,1,0\n370,1,0\n390,1,0\n", "r");
  EXPECT_DOUBLE_EQ(on.angle[2], 390 * std::numbers::pi / 180);
}

TEST(EvaluationRotationFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(rotation("angle_deg\n0\n"),
            "r.csv: x1: there is no column of a probe; expected at least one of x1_um, y1_um, x2_um, y2_um, axial_um, "
            "face_um");
  EXPECT_EQ(rotation("angle_deg,x1_um\n0,1\n10,1\n5,1\n"),
            "r.csv:4: angle_deg: the angle turns back against the row before; expected readings in the order of time, "
            "with an angle that only rises or only falls");
  EXPECT_EQ(rotation("angle_deg,x1_um\n0,1\n0,1\n"),
            "r.csv:3: angle_deg: the angle is that of the row before; expected readings in the order of time, with an "
            "angle that only rises or only falls");
}

TEST(EvaluationLineFile, ReadsOneLineOrTwo) {
  const LineReadings line = parse_straightness("deviation_um,position_mm\n1,200\n2,0\n3,100\n4,0\n", "s");
  EXPECT_EQ(line.positions, (std::vector<double>{200, 0, 100, 0}));
  EXPECT_EQ(line.deviations, (std::vector<double>{0.001, 0.002, 0.003, 0.004}));
  const auto lines = parse_squareness("line,position_mm,deviation_um\nX,0,1\nY,1,2\nX,2,3\nX,3,4\nY,2,5\nY,3,6\n", "q");
  EXPECT_EQ(lines[0].name, "X");
  EXPECT_EQ(lines[1].positions, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(lines[1].deviations, (std::vector<double>{0.002, 0.005, 0.006}));
}

TEST(EvaluationLineFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(straight("position_mm,deviation_um\n0,1\n1,1\n1,2\n"),
            "s.csv: position_mm: 2 different positions; expected at least three: two points are always straight");
  EXPECT_EQ(straight("position_mm,deviation_um\n100,1\n0,1\n1e-317,1\n200,1\n"),
            "s.csv:4: position_mm: this position is nearly the same as that of line 3: 1e-317 mm from it; expected the "
            "same position, or at least 1e-6 mm between positions");
  EXPECT_EQ(straight("position_mm,deviation_um\n100.0000001,1\n0,1\n100,1\n200,1\n").substr(0, 70),
            "s.csv:4: position_mm: this position is nearly the same as that of line");
  EXPECT_EQ(square("line,position_mm,deviation_um\nX,0,1\nX,1,1\n"),
            "q.csv: line: 1 line is named; expected two lines, such as X and Y");
  EXPECT_EQ(square("line,position_mm,deviation_um\nX,0,1\nY,1,1\nZ,1,1\n"),
            "q.csv: line: 3 lines are named; expected two lines, such as X and Y");
  EXPECT_EQ(square("line,position_mm,deviation_um\nX,0,1\nX,1,1\nX,2,1\nY,1,1\n"),
            "q.csv: position_mm: 1 different position on line 'Y'; expected at least three: two points are always "
            "straight");
}

}  // namespace
}  // namespace abbe
