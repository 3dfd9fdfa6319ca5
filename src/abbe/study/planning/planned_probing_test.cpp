#include "abbe/study/planning/planned_probing.h"

#include <gmock/gmock.h>

#include <limits>

#include "abbe/formats/text/input_error.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A ball of 20 mm on the table of a mill with a table C in a cradle A.
ProbingRequest ball_request() {
  ProbingRequest request;
  request.machine = parse_chain("w C' A' Y' b X Z t").machine;
  request.readings_file = "r.csv";
  request.list = parse_reading_list("C_deg,A_deg,Y_mm,X_mm,Z_mm\n0,0,0,0,0\n120,-30,0,0,0\n-70,20,0,0,0\n", "r.csv",
                                    request.machine);
  request.ball_centre = {70, 10, 40};
  request.ball_radius = 10;
  request.ways.clearance = 100;
  return request;
}

TEST(APlannedProbing, TouchesTheBallFromAllSidesAtEveryPosition) {
  const ProbingRequest request = ball_request();
  const PlannedProbing planned = plan_probing(request);
  ASSERT_EQ(planned.refused, "");
  ASSERT_EQ(planned.touches.size(), 15U);
  EXPECT_EQ(planned.positions, 3U);
  for (std::size_t k = 0; k < planned.touches.size(); ++k) {
    const PlannedTouch& touch = planned.touches[k];
    const std::vector<double>& rotary = request.list.readings[k / 5].pose;
    EXPECT_NEAR(touch.pose[0], rotary[0], 1e-14);
    EXPECT_NEAR(touch.pose[1], rotary[1], 1e-14);
    const RigidTransform seen = nominal_workpiece_from_tool(request.machine, touch.pose);
    const Eigen::Vector3d gap = request.ball_centre - seen.translation;
    // Rounded to 6 decimals.
    EXPECT_NEAR(gap.norm(), 13, 2e-6);
    EXPECT_NEAR((seen.rotation * touch.approach).dot(gap), 13, 2e-6);
  }
}

TEST(APlannedProbing, WritesAProgramThatComesFromTheSideAndGoesBack) {
  ProbingRequest request = ball_request();
  request.list.readings.resize(1);
  const PlannedProbing planned = plan_probing(request);
  EXPECT_THAT(planned.program, HasSubstr("(PROBEOPEN touches.txt)\n(reading 1)\n"
                                         "G0 C0.000000 A0.000000 Y10.000000 X70.000000 Z56.000000\n"
                                         "G38.2 Z51.000000 F60\nG0 Z56.000000\n"
                                         "G0 X86.000000\nG0 Z40.000000\nG38.2 X81.000000 F60\nG0 X86.000000\n"
                                         "G0 Z56.000000\n"));
  EXPECT_THAT(planned.program, HasSubstr("(PROBECLOSE)\nM30\n"));
}

TEST(APlannedProbing, SaysWhichReadingCannotBeProbedAndWhy) {
  ProbingRequest request = ball_request();
  request.ball_centre.x() = 245;
  EXPECT_THAT(plan_probing(request).refused, HasSubstr("r.csv: reading 1 (line 2): the ball is out of reach: X"));
  request = ball_request();
  request.obstacles = {{"clamp", box_mesh({60, 18, 0}, {80, 40, 60}), ObstacleCarrier::table, 0}};
  EXPECT_THAT(plan_probing(request).refused, HasSubstr("r.csv: reading 1 (line 2): the tool touches clamp at"));
  request.touches = 3;
  EXPECT_THROW(plan_probing(request), InputError);
  request = ball_request();
  request.ball_centre.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(plan_probing(request), InputError);
  request = ball_request();
  request.ball_radius = std::numeric_limits<double>::infinity();
  EXPECT_THROW(plan_probing(request), InputError);
  request = ball_request();
  request.program.probing_feed = 0.0004 / 60;
  EXPECT_THROW(plan_probing(request), InputError);
  request = ball_request();
  request.program.log = "a b)";
  EXPECT_THROW(plan_probing(request), InputError);
}

}  // namespace
}  // namespace abbe
