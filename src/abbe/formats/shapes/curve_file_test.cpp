#include "abbe/formats/shapes/curve_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Machine engraver() { return parse_chain("w C2' X Y b Z C1 A t").machine; }

TEST(CurveFile, CsvHasPointsDirectionsFeedPierceAndIndexedAxes) {
  const Curve curve = parse_curve(
      "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min,pierce_s,beam,C2_deg\n1,2,3,0,0,2,600,0.2,0,30\n4,5,6,0,3,4,300,0,1,30\n",
      "curve.csv", engraver());
  ASSERT_EQ(curve.points.size(), 2U);
  ASSERT_EQ(curve.indexed, std::vector<std::size_t>{0});
  EXPECT_EQ(curve.points[0].point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(curve.points[0].direction, Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(curve.points[1].direction.y(), 0.6, 1e-15);
  EXPECT_EQ(curve.points[0].feed, 10);
  EXPECT_EQ(curve.points[0].dwell, 0.2);
  EXPECT_FALSE(curve.points[0].working);
  EXPECT_TRUE(curve.points[1].working);
  EXPECT_NEAR(curve.points[0].indexed[0], 30 * kDegree, 1e-15);
}

TEST(CurveFile, CsvThatIsWrongIsRefusedWithItsPlace) {
  const auto message = [](const char* text) { return message_of([&] { parse_curve(text, "curve.csv", engraver()); }); };
  EXPECT_THAT(message("x_mm,y_mm,z_mm,i,j,k\n1,2,3,0,0,1\n1,2,3,0,0,0\n"), HasSubstr("curve.csv:3: i, j, k"));
  EXPECT_THAT(message("x_mm,y_mm,z_mm,i,j\n1,2,3,0,0\n"), HasSubstr("k"));
  EXPECT_THAT(message("x_mm,y_mm,z_mm,i,j,k,beam\n1,2,3,0,0,1,2\n"), HasSubstr("0 or 1"));
  EXPECT_THAT(message("x_mm,y_mm,z_mm,i,j,k\n"), HasSubstr("no rows"));
}

TEST(CurveFile, ProgramOfStraightMovesIsRead) {
  const Curve curve = parse_curve_program(
      "%\n(a part) N10 G21 G90\nC2=30 f600\nG0 X1 Y2 Z3 I0 J0 K1\nM3 ; beam\nG4 P0.5\nN50 G1 X4\nY5 I.6 K.8\nM5\nG0 "
      "Z50\n"
      "M30\nnothing of this counts",
      "part.ngc", engraver());
  ASSERT_EQ(curve.points.size(), 4U);
  EXPECT_EQ(curve.points[0].dwell, 0.5);
  EXPECT_FALSE(curve.points[0].working);
  EXPECT_TRUE(curve.points[1].working);
  EXPECT_EQ(curve.points[1].point, Eigen::Vector3d(4, 2, 3));
  EXPECT_EQ(curve.points[2].point, Eigen::Vector3d(4, 5, 3));
  EXPECT_NEAR(curve.points[2].direction.x(), 0.6, 1e-15);
  EXPECT_FALSE(curve.points[3].working);
  EXPECT_EQ(curve.points[2].feed, 10);
  EXPECT_NEAR(curve.points[3].indexed[0], 30 * kDegree, 1e-15);
  const Curve inch = parse_curve_program("G20 G1 X1 Y0 Z0 I0 J0 K1 F60", "part.ngc", engraver());
  EXPECT_EQ(inch.points[0].point.x(), 25.4);
  EXPECT_NEAR(inch.points[0].feed, 25.4, 1e-12);
}

TEST(CurveFile, ProgramsThatWouldBeMisreadAreRefused) {
  const auto message = [](const char* text) {
    return message_of([&] { parse_curve_program(text, "part.ngc", engraver()); });
  };
  EXPECT_THAT(message("G21\nG2 X1 Y2 I3 J4\n"), HasSubstr("part.ngc:2: G2"));
  EXPECT_THAT(message("G91\n"), HasSubstr("G91"));
  EXPECT_THAT(message("G1 X1 Y2 Z3\n"), HasSubstr("I: not known"));
  EXPECT_THAT(message("X1 Y2 Z3 I0 J0 K1\n"), HasSubstr("without G0 or G1"));
  EXPECT_THAT(message("G1 X1 Y2 Z3 I0 J0 K0\n"), HasSubstr("length zero"));
  EXPECT_THAT(message("G1 X1 Y2 Z3 I0 J0 K1\nC2=5\n"), HasSubstr("part.ngc:2: C2=5"));
  EXPECT_THAT(message("G1 X1 Y2 Z3 I0 J0 K1\nC7=5\n"), HasSubstr("no axis C7"));
  EXPECT_THAT(message("G1 X#1\n"), HasSubstr("no number"));
  EXPECT_THAT(message("G1 X1000000001\n"), HasSubstr("too large"));
  EXPECT_THAT(message(("G1 X1 Y2 Z3 J0 K1 I" + std::string(200, '9')).c_str()), HasSubstr("too large"));
  EXPECT_THAT(message("T1 M6\n"), HasSubstr("T1"));
  EXPECT_THAT(message("M8\n"), HasSubstr("M8"));
  EXPECT_THAT(message("G4 P1\n"), HasSubstr("before the first move"));
  EXPECT_THAT(message("(open\n"), HasSubstr("does not end"));
  EXPECT_THAT(message("F0\n"), HasSubstr("not above zero"));
  EXPECT_THAT(message(";nothing\n"), HasSubstr("no moves"));
}

TEST(CurveFile, PlacementsMapBothWaysAndComeBack) {
  const std::string text = "translation_mm = [1, 2, 3]\nangles_deg = [10, 20, 30]\n";
  const Placement to_table = parse_placement("maps = \"workpiece-to-table\"\n" + text, "p").placement;
  const Placement to_workpiece = parse_placement("maps = \"table-to-workpiece\"\n" + text, "p").placement;
  EXPECT_EQ(to_table.table_from_workpiece.translation, Eigen::Vector3d(1, 2, 3));
  const RigidTransform both = to_table.table_from_workpiece * to_workpiece.table_from_workpiece;
  EXPECT_LT(both.translation.norm() + (both.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  for (const bool reading : {true, false}) {
    const PlacementFile file = parse_placement(placement_text({to_table, {"a \"word\"", "more"}}, reading), "p");
    EXPECT_THAT(file.warnings, testing::ElementsAre("a \"word\"", "more"));
    const Placement& back = file.placement;
    EXPECT_LT((back.table_from_workpiece.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-14);
    EXPECT_LT((back.table_from_workpiece.rotation - to_table.table_from_workpiece.rotation).norm(), 1e-14);
  }
  EXPECT_THAT(message_of([&] { parse_placement(text, "p"); }), HasSubstr("maps"));
}

TEST(PathProgram, WritesBeamDwellFeedAndOnlyWordsThatChange) {
  const Machine machine = parse_chain("w C2' X Y b Z C1 A t").machine;
  ToolPath path;
  path.regions = 1;
  path.steps.resize(3);
  path.steps[0].dwell = 0.5;
  path.steps[1].working = path.steps[2].working = true;
  path.steps[1].feed = path.steps[2].feed = 10;
  path.steps[1].length = 5;
  path.steps[2].length = 0;
  const std::vector<std::vector<double>> commands = {
      {0, 1, 2, 3, -1e-12, 0}, {0, 6, 2, 3, 0, 0}, {0, 6, 2, 3, 0, std::numbers::pi / 2}};
  PathProgramOptions options;
  options.decimals = 3;
  options.words = {{"C1", "C"}};
  options.comments = {"made of (parts)"};
  EXPECT_EQ(
      path_program(machine, path, commands, options),
      "(made of  parts )\nG21 G90 G94\nG0 C2=0.000 X1.000 Y2.000 Z3.000 C0.000 A0.000\nM3\nG4 P0.500\nG93\nG1 X6.000 "
      "F120.0000\nG1 A90.000 F3.8197\nM5\nG94\nM30\n");
  options.inverse_time = false;
  EXPECT_THAT(path_program(machine, path, commands, options), HasSubstr("G1 X6.000 F600.0000\n"));
}

}  // namespace
}  // namespace abbe
