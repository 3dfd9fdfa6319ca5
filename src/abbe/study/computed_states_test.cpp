// Commands that use errors, on a machine whose ram sags the further it is out: a state that follows from the commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_map.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/compensation/errors_map.h"
#include "abbe/study/scans/scanned_points.h"
#include "abbe/study/verification/verification.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kRam = R"(name = "mill with a ram"
chain = "w b X Y Z t"
[axis.X]
travel_mm = [0, 800]
[axis.Y]
travel_mm = [0, 600]
[axis.Z]
travel_mm = [-400, 100]
[tool]
reference_mm = [0, 0, 300]
offset_mm = [0, 0, -120]
[state.ram]
kind = "axis"
axis = "Z"
reference_mm = 0
[state.side]
kind = "approach"
axis = "Z"
)";

/// The column pitches and the head sags as the ram comes out, more at one end of Y than at the other.
const char* const kSag = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 12, -7]
[[motion]]
name = "EZY"
state = "ram"
basis = "legendre"
order = 1
coefficients_um = [0.06, 0.02]
[[motion]]
name = "EAY"
state = "ram"
basis = "legendre"
order = 2
coefficients_urad = [0.12, -0.05, 0.03]
[[location]]
name = "EC0Y"
state = "ram"
value_urad = 0.05
)";

Machine ram_machine() { return parse_machine(kRam, "ram.machine.toml"); }

ErrorsFile sagging() { return parse_errors(kSag, "sag.errors.toml", ram_machine(), StatesOfErrors::allowed); }

/// The same errors at one position of the ram, without any state: coefficients times the position.
ErrorSet with_ram_at(const ErrorSet& errors, double z) {
  ErrorSet there = errors;
  for (ErrorMotion& motion : there.motions) {
    if (motion.state == kNoState) continue;
    for (double& coefficient : motion.coefficients) coefficient *= z;
    motion.state = kNoState;
  }
  for (LocationError& location : there.locations) {
    if (location.state == kNoState) continue;
    location.value *= z;
    location.state = kNoState;
  }
  return there;
}

Eigen::Vector3d displaced(const Machine& machine, const ErrorSet& errors, const std::vector<double>& pose) {
  return actual_workpiece_from_tool(machine, with_ram_at(errors, pose[2]), pose).translation -
         nominal_workpiece_from_tool(machine, pose).translation;
}

TEST(ComputedStates, AMapIsTheDisplacementAtEveryPositionOfTheRam) {
  ErrorsMapRequest request;
  request.machine = ram_machine();
  request.errors = sagging();
  request.fit_datum = false;
  const ErrorsMap map = map_errors(request);
  ASSERT_EQ(map.before.statistics.count, 729U);
  double largest = 0;
  for (std::size_t k = 0; k < map.stated.poses.count(); ++k) {
    const Eigen::Vector3d expected = displaced(request.machine, request.errors.errors, map.stated.poses.pose(k));
    EXPECT_NEAR(map.before.norm[k], expected.norm(), 1e-12) << k;
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 0.02);
  request.minus = request.errors;
  EXPECT_LT(map_errors(request).after->statistics.maximum, 1e-12);
}

TEST(ComputedStates, AVerificationCorrectsWhatTheRamDoes) {
  VerificationRequest request;
  request.machine = ram_machine();
  request.identified = request.truth = sagging();
  request.poses = 60;
  const Verification same = verify_compensation(request);
  EXPECT_GT(same.poses.before_statistics.mean, 0.005);
  EXPECT_LT(same.poses.after_statistics.maximum, 1e-6);
  // Errors as they are in the middle of the ram's travel leave what changes along it.
  request.identified.errors = with_ram_at(request.truth.errors, -150);
  const Verification middle = verify_compensation(request);
  EXPECT_GT(middle.poses.after_statistics.mean, 0.1 * middle.poses.before_statistics.mean);
}

TEST(ComputedStates, PointsOfAScanAreWhereTheRamHasTheProbe) {
  const std::filesystem::path folder = test::empty_folder("computed_states_scan");
  ScannedPointsRequest request;
  request.machine = ram_machine();
  request.errors = sagging().errors;
  request.readings = (folder / "r.csv").string();
  request.output = (folder / "p.csv").string();
  const std::vector<std::vector<double>> poses = {{100, 500, -350}, {700, 50, 80}, {400, 300, 0}};
  std::ofstream readings(request.readings);
  readings << "X_mm,Y_mm,Z_mm,indication_mm\n";
  for (const std::vector<double>& pose : poses) readings << pose[0] << "," << pose[1] << "," << pose[2] << ",0\n";
  readings.close();
  ASSERT_EQ(write_scanned_points(request).summary.points, 3U);
  const Eigen::Matrix3Xd points = read_point_cloud(request.output).cloud.points;
  Machine at_gauge_point = request.machine;
  at_gauge_point.tool_offset.setZero();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector3d expected = nominal_workpiece_from_tool(at_gauge_point, poses[k]).translation +
                                     displaced(at_gauge_point, request.errors, poses[k]);
    EXPECT_NEAR((points.col(static_cast<Eigen::Index>(k)) - expected).norm(), 0, 1e-6) << k;
  }
}

TEST(ComputedStates, ALatticeTakesTheRamAndATableOverOneAxisIsRefused) {
  ControlTableRequest request;
  request.machine = ram_machine();
  request.errors = sagging().errors;
  request.positions = 5;
  request.format = "lattice-csv";
  const ControlTables made = make_control_tables(request);
  EXPECT_FALSE(made.says_no());
  EXPECT_GT(made.before.position_statistics.mean, 0.005);
  // What is left is the interpolation between nodes and the last digit of the file.
  EXPECT_LT(made.after.position_statistics.maximum, 1e-3);
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    EXPECT_NEAR(made.before.position[k], displaced(request.machine, request.errors, made.poses.pose(k)).norm(), 1e-12);
  }
  bool named = false;
  for (const CarriedError& error : made.errors) {
    if (error.name != "EZY*ram") continue;
    named = true;
    EXPECT_NEAR(error.size, 400 * 0.08e-3, 1e-9);
    EXPECT_LT(error.effect_after, 0.05 * error.effect_before);
  }
  EXPECT_TRUE(named);
  request.format = "siemens-cec";
  EXPECT_THAT(message_of([&] { make_control_tables(request); }),
              HasSubstr("depends on a state, which a table over the position of one axis does not take into account"));
}

TEST(ComputedStates, TheSideOfApproachIsStillRefused) {
  ErrorsMapRequest request;
  request.machine = ram_machine();
  request.errors = parse_errors(
      "[[motion]]\nname = \"EZY\"\nstate = \"side\"\nbasis = \"legendre\"\norder = 0\n"
      "coefficients_um = [2]\n",
      "side.errors.toml", request.machine, StatesOfErrors::allowed);
  EXPECT_EQ(message_of([&] { map_errors(request); }),
            "EZY*side: depends on side (approach), which a map of errors does not take into account; expected errors "
            "whose states follow from the commands (axis, gravity)");
}

}  // namespace
}  // namespace abbe
