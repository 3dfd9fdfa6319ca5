#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/text/message_of.h"
#include "abbe/machine/chain.h"
#include "abbe/study/compensation/planned_path.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kReference = 40;  // mm, of the ram

/// A machine whose tool moves along X, Y and Z, so that displacements are error motions, by hand.
Machine machine_of_moving_tool() {
  Machine machine = parse_chain("w b X Y Z t").machine;
  machine.name = "moving tool";
  machine.states.push_back({.name = "ram", .kind = StateKind::axis, .reference = kReference, .axis = 2});
  machine.states.push_back({.name = "side", .kind = StateKind::approach, .axis = 0});
  machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  return machine;
}

/// EXX 8 um at +-250 mm; EYY 0.1 um per mm of the ram; 3 um in X to the side from which X came.
ErrorsFile errors_along_a_path() {
  const Basis constant{.kind = BasisKind::legendre, .order = 0, .from = -250, .to = 250};
  Basis line = constant;
  line.order = 1;
  ErrorsFile file;
  file.errors.motions.push_back({0, Component::X, line, {0, 8e-3}, {}});
  file.errors.motions.push_back({1, Component::Y, constant, {1e-4}, {}, 0});
  file.errors.motions.push_back({0, Component::X, constant, {3e-3}, {}, 1});
  return file;
}

PathRequest zigzag() {
  PathRequest request;
  request.machine = machine_of_moving_tool();
  request.curve_file = "zigzag.csv";
  request.errors_file = "x.errors.toml";
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(100, 20, 10), Eigen::Vector3d(40, 60, 90),
        Eigen::Vector3d(40, 80, 120), Eigen::Vector3d(200, -30, -50)}) {
    request.curve.points.push_back({.point = point, .feed = 10});
  }
  request.errors = errors_along_a_path();
  return request;
}

TEST(ErrorsAlongAPath, CommandsAreThoseOfTheEquationsByHand) {
  const PathRequest request = zigzag();
  const PlannedPath planned = plan_path(request);
  ASSERT_EQ(planned.refused, "");
  EXPECT_THAT(planned.errors_along, ElementsAre("EXX", "EYY*ram", "EXX*side"));
  const double sides[] = {0, 1, -1, -1, 1};  // X stands still on the way to the fourth point
  ASSERT_EQ(planned.commands.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    const std::vector<double>& command = planned.commands[k];
    const Eigen::Vector3d& point = request.curve.points[k].point;
    EXPECT_NEAR(command[0] + 8e-3 * command[0] / 250 + 3e-3 * sides[k], point.x(), 1e-8) << k;
    EXPECT_NEAR(command[1] + 1e-4 * (command[2] - kReference), point.y(), 1e-8) << k;
    EXPECT_NEAR(command[2], point.z(), 1e-8) << k;
  }
  EXPECT_LT(planned.miss.distance, 1e-8);
  EXPECT_THAT(planned_path_text(planned), HasSubstr("corrected at every pose: EXX, EYY*ram, EXX*side\n"));
  EXPECT_EQ(planned_path_json(planned)["errors_along"][1], "EYY*ram");
}

TEST(ErrorsAlongAPath, BetweenThePosesTheToolLeavesTheLineByWhatIsSaid) {
  PathRequest request = zigzag();
  // A wave of 10 um across, four times between points that are 100 mm apart; zero at both.
  const Basis wave{.kind = BasisKind::fourier, .order = 1, .from = -250, .to = 250, .period = 400};
  request.errors->errors.motions = {{0, Component::Y, wave, {0, 0, 10e-3}, {}}};
  request.curve.points.resize(2);
  request.curve.points[1].point = {200, 0, 0};
  const PlannedPath planned = plan_path(request);
  EXPECT_EQ(planned.refused, "");
  EXPECT_NEAR(planned.path.largest_deviation, 10e-3, 1e-6);  // half way, at the top of the wave
  request.tolerance = 5e-3;
  const PlannedPath refused = plan_path(request);
  EXPECT_THAT(refused.refused, HasSubstr("by 10.000 um, which is more than --tolerance-um 5"));
}

TEST(ErrorsAlongAPath, WhereTheErrorsAreNotKnownThereIsNoPath) {
  PathRequest request = zigzag();
  request.errors->errors.motions[0].basis.from = -50;
  request.errors->errors.motions[0].basis.to = 150;
  const PlannedPath planned = plan_path(request);
  EXPECT_FALSE(planned.has_path());
  EXPECT_TRUE(planned.commands.empty());
  EXPECT_THAT(planned.refused, HasSubstr("pose 5 of 5 (200.000, -30.000, -50.000 mm): the errors are not known there"));
}

TEST(ErrorsAlongAPath, StatesThatHaveToBeGivenAreRefused) {
  PathRequest request = zigzag();
  request.errors->errors.motions[1].state = 2;
  EXPECT_THAT(message_of([&] { plan_path(request); }),
              HasSubstr("EYY*ambient: depends on ambient (measured), which a path does not take into account"));
}

TEST(ErrorsAlongAPath, ALocationErrorThatDoesNotChangeIsInTheGeometryAsBefore) {
  PathRequest request = zigzag();
  request.errors->errors = {};
  request.errors->errors.locations.push_back({.axis = 1, .component = Component::C, .value = 5e-5});
  const PlannedPath constant = plan_path(request);
  EXPECT_TRUE(constant.errors_along.empty());
  // The same error, times a state that is 1 where Z is 0.
  request.errors->errors.locations[0].value = 0;
  request.errors->errors.locations.push_back({.axis = 1, .component = Component::C, .value = 5e-5, .state = 0});
  request.machine.states[0].reference = -1;
  for (CurvePoint& point : request.curve.points) point.point.z() = 0;
  const PlannedPath along = plan_path(request);
  ASSERT_EQ(along.refused, "");
  for (std::size_t k = 0; k < along.commands.size(); ++k) {
    EXPECT_NEAR(along.commands[k][0], constant.commands[k][0], 1e-8);
    EXPECT_NEAR(along.commands[k][1], constant.commands[k][1], 1e-8);
  }
}

}  // namespace
}  // namespace abbe
