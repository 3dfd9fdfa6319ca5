#include "abbe/study/compensation/planned_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"
#include "abbe/study/example_file_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

PathRequest engraved_regions() {
  PathRequest request;
  request.machine = read_machine(test::example_file("machines/yin-engraver-u.machine.toml"));
  request.curve_file = "regions.ngc";
  request.curve = read_curve(test::example_file("laser_engraver/regions.ngc"), request.machine);
  request.retract = 20;
  return request;
}

PathRequest engraved_table() {
  PathRequest request;
  request.machine = read_machine(test::example_file("machines/yin-engraver-u.machine.toml"));
  request.curve_file = "folder/table-a4.csv";
  request.curve = read_curve(test::example_file("laser_engraver/table-a4.csv"), request.machine);
  request.placement_file = "part.placement.toml";
  request.placement = read_placement(test::example_file("laser_engraver/part.placement.toml"));
  return request;
}

TEST(PlannedPathOfACurve, BringsTheToolToTheCurveAndNeedsTheRequestNoLonger) {
  const PlannedPath planned = [] { return plan_path(engraved_table()); }();
  ASSERT_TRUE(planned.has_path());
  EXPECT_EQ(planned.refused, "");
  EXPECT_EQ(planned.commands.size(), planned.path.steps.size());
  const Curve curve = engraved_table().curve;
  std::size_t points = 0;
  for (std::size_t step = 0; step < planned.commands.size(); ++step) {
    const std::size_t point = planned.path.steps[step].point;
    if (point == ToolPathStep::kNoPoint) continue;
    const Eigen::Vector3d tool = nominal_workpiece_from_tool(planned.machine, planned.commands[step]).translation;
    EXPECT_LT((tool - curve.points[point].point).norm(), 1e-9);
    ++points;
  }
  EXPECT_EQ(points, curve.points.size());
  EXPECT_LT(planned.miss.distance, 1e-9);
  EXPECT_EQ(planned_path_json(planned)["moves"], planned.commands.size());
  EXPECT_THAT(planned_path_text(planned), testing::StartsWith("30 moves of "));
  EXPECT_THAT(planned_path_file(planned, "a.ngc"), HasSubstr("tool path of table-a4.csv on " + planned.machine.name));
  EXPECT_THAT(planned_path_file(planned, "a.csv"), testing::StartsWith("step,point,region,beam,"));
  EXPECT_THAT(planned_path_page(planned), HasSubstr("Tool path of table-a4.csv"));
}

TEST(PlannedPathOfACurve, CommandsAreForTheCalibratedMachine) {
  PathRequest request = engraved_regions();
  const PlannedPath nominal = plan_path(request);
  request.errors_file = "linkage.errors.toml";
  request.errors = read_errors(test::example_file("laser_engraver/linkage.errors.toml"), request.machine);
  const PlannedPath calibrated = plan_path(request);
  ASSERT_EQ(nominal.commands.size(), calibrated.commands.size());
  const std::size_t x = request.machine.find_axis("X"), c2 = request.machine.find_axis("C2");
  EXPECT_NEAR(calibrated.commands[3][x] - nominal.commands[3][x], 0.019, 1e-3);
  // An axis that is set beforehand keeps the command of the curve, whatever its zero.
  EXPECT_NEAR(calibrated.commands[20][c2], 12 * kDegree, 1e-12);
}

TEST(PlannedPathOfACurve, WarningsOfThePlacementComeWithIt) {
  PathRequest request = engraved_table();
  request.placement->warnings = {"the part is incomplete"};
  const PlannedPath planned = plan_path(request);
  EXPECT_EQ(planned_path_json(planned)["warnings"][0], "the part is incomplete");
  EXPECT_THAT(planned_path_page(planned), HasSubstr("part.placement.toml; the part is incomplete"));
}

TEST(PlannedPathOfACurve, IsRefusedWithAReason) {
  PathRequest request = engraved_table();
  request.curve.points[4].point.x() += 5000;
  const PlannedPath planned = plan_path(request);
  EXPECT_FALSE(planned.has_path());
  EXPECT_THAT(planned.refused, testing::StartsWith("point 5 of folder/table-a4.csv: "));
  EXPECT_TRUE(planned.commands.empty());
}

TEST(PlannedPathOfACurve, WhatCannotBeAnsweredIsNamedByItsOption) {
  const auto problem = [](const PathRequest& request) { return message_of([&] { plan_path(request); }); };
  PathRequest request = engraved_regions();
  request.retract = 0;
  EXPECT_THAT(problem(request), HasSubstr("--retract-mm: "));
  request = engraved_regions();
  request.held = {{request.machine.find_axis("C2"), 30 * kDegree}};
  EXPECT_THAT(problem(request), HasSubstr("--hold C2_deg=30: the curve gives this axis its commands"));
  request = engraved_regions();
  for (CurvePoint& point : request.curve.points) point.feed = 0;
  EXPECT_THAT(problem(request), HasSubstr("regions.ngc: moves at work without a feed"));
  request.feed = 10;
  EXPECT_EQ(plan_path(request).refused, "");
  request.errors_file = "x.errors.toml";
  request.errors =
      parse_errors("[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [0, 5]\n",
                   "x.errors.toml", request.machine);
  // An error motion is corrected at every pose.
  const PlannedPath along = plan_path(request);
  EXPECT_EQ(along.refused, "");
  EXPECT_EQ(along.errors_along, std::vector<std::string>{"EXX"});
  EXPECT_LT(along.miss.distance, 1e-9);
  const PlannedPath planned = plan_path(engraved_table());
  EXPECT_THAT(message_of([&] { planned_path_file(planned, "a.txt"); }), HasSubstr("a.txt: unknown kind of program"));
}

}  // namespace
}  // namespace abbe
