#include "abbe/formats/machine/machine_couplings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/machine/dh_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kCoupledMachine = R"(name = "arm on a lift"
chain = "w b Z A1 A2 A3 t"
[axis.Z]
travel_mm = [0, 500]
coupled_mm_per_deg = { A1 = 0.25 }
[axis.A1]
travel_deg = [-170, 170]
[axis.A2]
travel_deg = [-60, 100]
point_mm = [0, 0, 400]
[axis.A3]
travel_deg = [-60, 80]
point_mm = [0, 0, 900]
coupled = { A2 = -1, A1 = 0.015625 }
coupled_deg_per_mm = { Z = 0.1 }
)";

TEST(MachineCouplings, AreReadWithTheirUnits) {
  const Machine machine = parse_machine(kCoupledMachine, "a.machine.toml");
  ASSERT_EQ(machine.couplings.size(), 4U);
  EXPECT_EQ(machine.couplings[0], (AxisCoupling{0, 1, 0.25 / kDegree}));
  EXPECT_EQ(machine.couplings[1], (AxisCoupling{3, 2, -1}));
  EXPECT_EQ(machine.couplings[2], (AxisCoupling{3, 1, 0.015625}));
  EXPECT_EQ(machine.couplings[3], (AxisCoupling{3, 0, 0.1 * kDegree}));
}

TEST(MachineCouplings, WrittenMachinesReadBackTheSame) {
  for (const Machine& machine : {parse_machine(kCoupledMachine, "a.machine.toml"), test::coupled_arm(),
                                 test::coupled_seven_axis_arm(), test::coupled_fork_head()}) {
    const std::string text = machine_text(machine);
    const Machine again = parse_machine(text, "again.machine.toml");
    EXPECT_EQ(machine_text(again), text);
    EXPECT_THAT(again.couplings, testing::UnorderedElementsAreArray(machine.couplings));
  }
  EXPECT_THAT(machine_text(parse_machine(kCoupledMachine, "a.machine.toml")),
              HasSubstr("coupled = { A2 = -1, A1 = 0.015625 }\ncoupled_deg_per_mm = { Z = 0.1 }\n"));
  EXPECT_THAT(machine_text(test::coupled_fork_head()), HasSubstr("coupled_mm_per_deg = { A = 0.05235987755982989 }\n"));
}

TEST(MachineCouplings, MistakesAreNamed) {
  const auto message = [](const std::string& from, const std::string& to) {
    return message_of([&] { parse_machine(test::replaced(kCoupledMachine, from, to), "a.machine.toml"); });
  };
  EXPECT_THAT(message("A2 = -1", "A7 = -1"),
              HasSubstr("a.machine.toml:14:13: axis.A3.coupled.A7: there is no axis A7; expected one of Z, A1, A2"));
  EXPECT_THAT(message("coupled = { A2 = -1", "coupled = { Z = -1"),
              HasSubstr("axis.A3.coupled.Z: Z is a linear axis; expected the key coupled_deg_per_mm for it"));
  EXPECT_THAT(message("{ A1 = 0.25 }", "{ A3 = 0.25 }"), HasSubstr("the couplings go round: each of Z, A3 needs"));
  EXPECT_THAT(message("A2 = -1", "A3 = -1"), HasSubstr("a.machine.toml:11:7: axis.A3: is coupled to itself"));
  EXPECT_THAT(message("A2 = -1", "A2 = 0"), HasSubstr("the ratio to A2 is 0"));
  EXPECT_THAT(message("A2 = -1", "A2 = \"1\""), HasSubstr("axis.A3.coupled.A2"));
  EXPECT_THAT(message("coupled = {", "coupled_deg = {"), HasSubstr("axis.A3.coupled_deg"));
  EXPECT_THAT(message("travel_deg = [-170, 170]", "endless = true"),
              HasSubstr("A1, to which it is coupled, is endless"));
  EXPECT_THAT(message("coupled_mm_per_deg = {", "coupled_mm_per_deg = 3 #"), HasSubstr("axis.Z.coupled_mm_per_deg"));
}

TEST(MachineCouplings, ErrorsOfACoupledAxisAreOverItsPositionsByDefault) {
  const Machine machine = parse_machine(
      test::replaced(kCoupledMachine, ", A1 = 0.015625 }\ncoupled_deg_per_mm = { Z = 0.1 }", " }"), "a.machine.toml");
  const ErrorsFile file =
      parse_errors("[[motion]]\nname = \"EXA3\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = [1]\n",
                   "e.errors.toml", machine);
  EXPECT_NEAR(file.errors.motions[0].basis.from, -160 * kDegree, 1e-14);
  EXPECT_NEAR(file.errors.motions[0].basis.to, 140 * kDegree, 1e-14);
}

TEST(MachineCouplings, AJobThatNeedsIndependentAxesSaysSo) {
  EXPECT_EQ(
      message_of([] { refuse_couplings(test::coupled_arm(), "a table of a control", "arm.machine.toml"); }),
      "arm.machine.toml: axis.A2: A2 is coupled to B3, and a table of a control needs axes that move by their own "
      "commands alone; expected a machine without coupled axes");
  refuse_couplings(test::jointed_arm(), "a table of a control");
}

TEST(MachineCouplings, TablesOfJointsHaveThemToo) {
  const std::string table =
      "name = \"arm\"\nconvention = \"modified\"\n"
      "[[joint]]\ntravel_deg = [-170, 170]\n"
      "[[joint]]\na_mm = 100\nalpha_deg = -90\ntravel_deg = [-60, 100]\n"
      "[[joint]]\na_mm = 700\ntravel_deg = [-60, 80]\ncoupled = { A2 = -1 }\n";
  const DhArm arm = parse_dh_arm(table, "arm.dh.toml");
  ASSERT_EQ(arm.couplings.size(), 1U);
  EXPECT_EQ(arm.couplings[0], (AxisCoupling{2, 1, -1}));
  const Machine machine = parse_machine(dh_machine_text(arm, "arm.dh.toml"), "arm.machine.toml");
  const std::vector<double> commands{0.2, 0.5, -0.3};
  EXPECT_LE((dh_pose(arm, commands).translation - nominal_workpiece_from_tool(machine, commands).translation).norm(),
            1e-11);
  EXPECT_THAT(message_of([&] { parse_dh_arm(test::replaced(table, "A2 = -1", "A4 = -1"), "arm.dh.toml"); }),
              HasSubstr("joint[3].coupled.A4: there is no axis A4"));
  EXPECT_THAT(message_of([&] { parse_dh_arm(test::replaced(table, "coupled =", "coupled_to ="), "arm.dh.toml"); }),
              HasSubstr("joint[3].coupled_to"));
  EXPECT_THAT(message_of([&] { parse_dh_arm(test::replaced(table, "A2 = -1", "A3 = -1"), "arm.dh.toml"); }),
              HasSubstr("is coupled to itself"));
}

}  // namespace
}  // namespace abbe
