#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const kArm = R"(name = "arm"
chain = "w b X C B t"
gravity_m_per_s2 = [0, 9.80665, 0]

[axis.X]
travel_mm = [0, 1000]
[axis.C]
travel_deg = [-180, 180]
[axis.B]
travel_deg = [-90, 90]

[state.ambient]
kind = "measured"
unit = "degC"
[state.column]
kind = "lag"
of = "ambient"
time_constant_s = 120
[state.slide]
kind = "axis"
axis = "X"
reference_mm = 500
[state.elbow]
kind = "axis"
axis = "B"
reference_deg = 30
[state.side]
kind = "approach"
axis = "X"
[state.payload]
kind = "measured"
unit = "kg"
reference_kg = 1.5
[state.torque]
kind = "gravity"
about = "B"
load = [{ carried_by = "B", mass_kg = 5, point_mm = [300, 0, 0] },
        { carried_by = "tool", mass_kg = 0.5, point_mm = [600, 0, 10] }]
[state.loaded]
kind = "product"
of = ["payload", "torque"]
[state.feed]
kind = "measured"
unit = "1"
)";

Machine machine_with_states() { return parse_machine(kArm, "arm.machine.toml"); }

TEST(MachineStates, AreReadWithTheirReferencesAndUnits) {
  const Machine arm = machine_with_states();
  ASSERT_EQ(arm.states.size(), 9U);
  EXPECT_EQ(arm.gravity, Eigen::Vector3d(0, 9.80665, 0));
  EXPECT_EQ(arm.states[0].reference, 20) << "degC count from the reference temperature of ISO 1";
  EXPECT_EQ(arm.states[1].first, 0U);
  EXPECT_EQ(arm.states[1].reference, 20) << "a lag has the reference of its channel";
  EXPECT_EQ(arm.states[1].unit, "degC");
  EXPECT_EQ(arm.states[2].reference, 500);
  EXPECT_DOUBLE_EQ(arm.states[3].reference, 3.14159265358979323846 / 6);
  EXPECT_EQ(arm.states[6].axis, 2U);
  ASSERT_EQ(arm.states[6].loads.size(), 2U);
  EXPECT_EQ(arm.states[6].loads[1].carried_by, 2U);
  EXPECT_EQ(arm.states[7].first, 5U);
  EXPECT_EQ(arm.states[7].second, 6U);
}

TEST(MachineStates, AWrittenMachineReadsBackTheSame) {
  const Machine arm = machine_with_states(), again = parse_machine(machine_text(arm), "again.toml");
  EXPECT_EQ(again.states, arm.states);
  EXPECT_EQ(again.gravity, arm.gravity);
  EXPECT_EQ(machine_text(again), machine_text(arm));
  const Machine plain = parse_machine(std::string(kArm).substr(0, std::string(kArm).find("[state.")), "plain.toml");
  EXPECT_EQ(machine_text(plain).find("[state"), std::string::npos);
}

std::string message_of_state(const std::string& from, const std::string& to) {
  return message_of([&] { parse_machine(test::replaced(kArm, from, to), "m.toml"); });
}

TEST(MachineStates, MistakesAreToldWithTheirPlace) {
  EXPECT_EQ(message_of_state("unit = \"degC\"", "unit = \"F\""),
            "m.toml:14:1: state.ambient.unit: \"F\" is not a unit of states; expected degC, K, Nm, N, kg, rpm, s, 1");
  EXPECT_THAT(message_of_state("of = \"ambient\"", "of = \"air\""),
              HasSubstr("state.column.of: \"air\" is not a state of this machine; expected ambient, column, slide"));
  EXPECT_THAT(message_of_state("of = \"ambient\"", "of = \"slide\""), HasSubstr("slide is not a measured state"));
  EXPECT_THAT(message_of_state("time_constant_s = 120", "time_constant_s = 0"), HasSubstr("is not above zero"));
  EXPECT_THAT(message_of_state("axis = \"X\"\nreference", "axis = \"U\"\nreference"),
              HasSubstr("\"U\" is not an axis of this machine; expected X, C, B"));
  EXPECT_THAT(message_of_state("kind = \"gravity\"", "kind = \"weight\""), HasSubstr("state.torque.kind"));
  EXPECT_THAT(
      message_of_state("about = \"B\"\nload = [{ carried_by = \"B\"", "about = \"B\"\nload = [{ carried_by = \"C\""),
      HasSubstr("is not carried by B or by an axis that B carries"));
  EXPECT_THAT(message_of_state("mass_kg = 5", "mass_kg = -5"), HasSubstr("mass_kg: is not above zero"));
  EXPECT_THAT(message_of_state("[\"payload\", \"torque\"]", "[\"payload\"]"), HasSubstr("does not name two states"));
  EXPECT_THAT(message_of_state("[\"payload\", \"torque\"]", "[\"payload\", \"loaded\"]"),
              HasSubstr("two states that are not products"));
  EXPECT_THAT(message_of_state("reference_kg = 1.5", "reference_g = 1.5"), HasSubstr("reference_g"));
  EXPECT_THAT(message_of_state("[state.feed]", "[state.X]"), HasSubstr("is the name of an axis"));
}

const char* const kErrors = R"(chain = "w b X C B t"
[[motion]]
name = "EXX"
basis = "legendre"
order = 1
coefficients_um = [1, 2]
[[motion]]
name = "EXX"
state = "ambient"
basis = "legendre"
order = 1
coefficients_um = [0, 3]
standard_uncertainty_um = [0.1, 0.2]
[[motion]]
name = "EBB"
state = "torque"
basis = "legendre"
order = 0
coefficients_urad = [-4]
[[location]]
name = "EB0C"
value_urad = 10
[[location]]
name = "EB0C"
state = "column"
value_urad = 5
standard_uncertainty_urad = 1
)";

TEST(MachineStates, ErrorsWithStatesReadBackTheSame) {
  const Machine arm = machine_with_states();
  const ErrorsFile file = parse_errors(kErrors, "e.toml", arm, StatesOfErrors::allowed);
  ASSERT_EQ(file.errors.motions.size(), 3U);
  EXPECT_EQ(file.errors.motions[0].state, kNoState);
  EXPECT_EQ(file.errors.motions[1].state, 0U);
  EXPECT_EQ(file.errors.motions[2].state, 6U);
  EXPECT_EQ(file.errors.locations[0].state, kNoState);
  EXPECT_EQ(file.errors.locations[1].state, 1U);
  const std::string text = errors_text(arm, file);
  EXPECT_THAT(text, HasSubstr("state = \"torque\"  # coefficients and values are per N m\n"));
  const ErrorsFile again = parse_errors(text, "again.toml", arm, StatesOfErrors::allowed);
  EXPECT_EQ(again.errors.motions, file.errors.motions);
  EXPECT_EQ(again.errors.locations, file.errors.locations);
  ErrorsFile with_covariance = file;
  with_covariance.covariance = Eigen::MatrixXd::Identity(10, 10) * 1e-12;
  EXPECT_THAT(covariance_text(arm, with_covariance), HasSubstr("EXX*ambient[P1],um,"));
}

TEST(MachineStates, ErrorsWithStatesAreRefusedWhereNobodyAsksForThem) {
  const Machine arm = machine_with_states();
  EXPECT_EQ(
      message_of([&] { parse_errors(kErrors, "e.toml", arm); }),
      "e.toml:9:1: motion[2].state: this error depends on ambient, which is not taken into account here; expected "
      "errors without states");
  EXPECT_THAT(message_of([&] {
                parse_errors(test::replaced(kErrors, "\"torque\"", "\"twist\""), "e.toml", arm,
                             StatesOfErrors::allowed);
              }),
              HasSubstr("\"twist\" is not a state of this machine; expected ambient, column, slide"));
  EXPECT_THAT(message_of([&] {
                parse_errors(test::replaced(kErrors, "state = \"column\"\n", ""), "e.toml", arm,
                             StatesOfErrors::allowed);
              }),
              HasSubstr("is given twice"));
  const ErrorsFile file = parse_errors(kErrors, "e.toml", arm, StatesOfErrors::allowed);
  EXPECT_THAT(message_of([&] { refuse_states(arm, file.errors, "a table"); }),
              HasSubstr("EXX*ambient: depends on a state, which a table does not take into account"));
}

TEST(MachineStates, ReadingsHaveAColumnForEachState) {
  const Machine arm = machine_with_states();
  const std::string header = "X_mm,C_deg,B_deg,measured_x_mm,measured_y_mm,measured_z_mm";
  const MeasurementTable table =
      parse_measurements(header +
                             ",time_s,ambient_degC,payload_kg,feed\n1,2,3,4,5,6,0,20.3,1.5,0.5\n"
                             "1,2,3,4,5,6,60,22.3,2.5,0.25\n",
                         "r.csv", arm);
  const std::vector<std::vector<double>>& state = table.readings.poses.state;
  ASSERT_EQ(state.size(), 9U);
  EXPECT_THAT(state[0], ElementsAre(20.3, 22.3));
  // The lag has no column: computed from the ambient temperature, a ramp of 2 K in 60 s, time constant 120 s.
  EXPECT_THAT(state[1], ElementsAre(20.3, DoubleNear(22.3 - 4 * (1 - std::exp(-0.5)), 1e-12)));
  EXPECT_TRUE(state[2].empty());
  EXPECT_THAT(state[5], ElementsAre(1.5, 2.5));
  EXPECT_THAT(state[8], ElementsAre(0.5, 0.25));
  const std::string text = measurements_text(arm, table);
  EXPECT_THAT(text, HasSubstr("ambient_degC,column_degC,payload_kg,feed\n"));
  EXPECT_EQ(parse_measurements(text, "again.csv", arm).readings.poses.state, state);

  EXPECT_TRUE(parse_measurements(header + "\n1,2,3,4,5,6\n", "r.csv", arm).readings.poses.state.empty());
  EXPECT_THAT(message_of([&] { parse_measurements(header + ",ambient_K\n1,2,3,4,5,6,290\n", "r.csv", arm); }),
              HasSubstr("ambient_K"));
  EXPECT_THAT(message_of([&] {
                parse_measurements(header + ",time_s,ambient_degC\n1,2,3,4,5,6,5,20\n1,2,3,4,5,6,4,20\n", "r.csv", arm);
              }),
              HasSubstr("r.csv:3: time: is before the time of the reading before it"));
  const PoseList poses = parse_poses("X_mm,C_deg,B_deg,ambient_degC\n1,2,3,21\n", "p.csv", arm);
  EXPECT_THAT(poses.state[0], ElementsAre(21));
}

}  // namespace
}  // namespace abbe
