#include "abbe/formats/machine/machine_file.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

const char* const kMachine = R"(name = "table and column"
chain = "w C' X' b Z t"

[axis.C]
point_mm = [700, 0, -100]
endless = true

[axis.X]
travel_mm = [0, 1400]

[axis.Z]
travel_m = [0, 0.6]
direction = [0, 0, 2]

[workpiece]
origin_mm = [1, 2, 3]
angles_deg = [0, 0, 90]

[tool]
reference_mm = [0, 0, 300]
offset_um = [0, 80000, -250000]
)";

std::string message_of_machine_with(const std::string& from, const std::string& to) {
  return message_of([&] { parse_machine(test::replaced(kMachine, from, to), "m.toml"); });
}

TEST(MachineFile, ReadsEveryField) {
  const Machine machine = parse_machine(kMachine, "m.toml");
  EXPECT_EQ(machine.name, "table and column");
  EXPECT_EQ(machine.chain(), "w C' X' b Z t");
  EXPECT_TRUE(machine.axes[0].endless);
  EXPECT_EQ(machine.axes[0].kind, AxisKind::rotary);
  EXPECT_EQ(machine.axes[0].point, Eigen::Vector3d(700, 0, -100));
  EXPECT_EQ(machine.axes[1].travel_max, 1400);
  EXPECT_EQ(machine.axes[2].travel_max, 600);
  EXPECT_EQ(machine.axes[2].direction, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(machine.tool_offset, Eigen::Vector3d(0, 80, -250));
  EXPECT_EQ(machine.tool_reference, Eigen::Vector3d(0, 0, 300));
  const Eigen::Vector3d turned = machine.bed_from_workpiece * Eigen::Vector3d(10, 0, 0);
  EXPECT_LE((turned - Eigen::Vector3d(1, 12, 3)).norm(), 1e-14);
}

TEST(MachineFile, ReadsBackWhatItWrites) {
  Machine machine = parse_machine(kMachine, "m.toml");
  machine.axes[0].endless = false;
  machine.axes[0].travel_min = -1.2345678901234567;
  machine.axes[0].travel_max = 2 * std::numbers::pi;
  machine.axes[0].direction = Eigen::Vector3d(0.1, -0.2, 3).normalized();
  machine.name = "with \"quotes\", \\ and\ttabs";
  const Machine back = parse_machine(machine_text(machine), "m.toml");
  EXPECT_EQ(back.name, machine.name);
  ASSERT_EQ(back.axes.size(), machine.axes.size());
  for (std::size_t i = 0; i < back.axes.size(); ++i) {
    EXPECT_EQ(back.axes[i].name, machine.axes[i].name);
    EXPECT_EQ(back.axes[i].direction, machine.axes[i].direction);
    EXPECT_EQ(back.axes[i].point, machine.axes[i].point);
    EXPECT_EQ(back.axes[i].travel_min, machine.axes[i].travel_min);
    EXPECT_EQ(back.axes[i].travel_max, machine.axes[i].travel_max);
    EXPECT_EQ(back.axes[i].endless, machine.axes[i].endless);
  }
  EXPECT_EQ(back.tool_offset, machine.tool_offset);
  EXPECT_LE((back.bed_from_workpiece.rotation - machine.bed_from_workpiece.rotation).norm(), 1e-15);
  EXPECT_EQ(machine_text(back), machine_text(machine));
}

TEST(MachineFile, AcceptsByteOrderMarkAndCarriageReturns) {
  std::string text = "\xEF\xBB\xBF";
  for (const char* at = kMachine; *at != 0; ++at) text += *at == '\n' ? std::string("\r\n") : std::string(1, *at);
  EXPECT_EQ(machine_text(parse_machine(text, "m.toml")), machine_text(parse_machine(kMachine, "m.toml")));
}

TEST(MachineFile, CommentedFileOfAnyChainIsAValidMachine) {
  for (const char* chain : {"w C' X' b Z t", "w C b X Z A Y B t", "w b X Y Z t", "wC2'A'bXYZC1t"}) {
    Machine expected = parse_chain(chain).machine;
    expected.name = "unnamed machine";
    EXPECT_EQ(machine_text(parse_machine(commented_machine_file(chain), "new.toml")), machine_text(expected));
  }
  EXPECT_EQ(message_of([] { commented_machine_file("w X q t"); }).substr(0, 24), "chain: \"w X q t\": found ");
}

TEST(MachineFile, RefusesWrongUnitSuffix) {
  EXPECT_EQ(
      message_of_machine_with("travel_mm = [0, 1400]", "travel_deg = [0, 1400]"),
      "m.toml:9:1: axis.X.travel_deg: 'deg' is not a unit of a length; expected travel_mm, travel_um or travel_m");
  EXPECT_EQ(message_of_machine_with("travel_mm = [0, 1400]", "travel = [0, 1400]"),
            "m.toml:9:1: axis.X.travel: the unit is missing from the name; expected travel_mm, travel_um or travel_m");
  EXPECT_EQ(message_of_machine_with("point_mm", "point_inch"),
            "m.toml:5:1: axis.C.point_inch: 'inch' is not a unit of a length; expected point_mm, point_um or point_m");
  EXPECT_EQ(message_of_machine_with("angles_deg", "angles_mm"),
            "m.toml:17:1: workpiece.angles_mm: 'mm' is not a unit of an angle; expected angles_rad, angles_mrad, "
            "angles_urad, angles_deg or angles_arcsec");
}

TEST(MachineFile, RefusesUnknownAndDuplicateAxes) {
  EXPECT_EQ(message_of_machine_with("[axis.X]", "[axis.Y]"),
            "m.toml:8:7: axis.Y: the chain has no axis Y; expected one of C, X, Z");
  const std::string twice = message_of_machine_with("[axis.Z]", "[axis.X]");
  EXPECT_TRUE(twice.starts_with("m.toml:11:")) << twice;
  EXPECT_NE(twice.find("axis.X"), std::string::npos) << twice;
  const std::string chain = message_of_machine_with("w C' X' b Z t", "w C' X' b X t");
  EXPECT_TRUE(chain.starts_with("m.toml:2:1: chain: \"w C' X' b X t\": found ")) << chain;
}

TEST(MachineFile, RefusesMissingFieldsAndLimitsInTheWrongOrder) {
  EXPECT_EQ(message_of_machine_with("travel_mm = [0, 1400]", ""),
            "m.toml:8:1: axis.X.travel_mm: missing; expected an array of 2 numbers (travel_mm, travel_um or travel_m)");
  EXPECT_EQ(
      message_of_machine_with("[0, 1400]", "[1400, 0]"),
      "m.toml:9:1: axis.X.travel_mm: the first limit is not below the second; expected [smallest, largest] command");
  EXPECT_EQ(message_of_machine_with("[0, 0, 2]", "[0, 0, 0]"),
            "m.toml:13:1: axis.Z.direction: has no length; expected a vector (x, y, z) along the positive direction");
  EXPECT_EQ(message_of_machine_with("endless = true", "endless = true\ntravel_deg = [0, 10]"),
            "m.toml:7:1: axis.C.travel_deg: is given together with endless = true");
  EXPECT_EQ(message_of_machine_with("name =", "nane ="), "m.toml:1:1: nane: unknown key; expected name");
  EXPECT_EQ(message_of([] { parse_machine("", "m.toml"); }), "m.toml: the file is empty");
}

TEST(MachineFile, RefusesNumbersThatAreNoNumbers) {
  EXPECT_EQ(message_of_machine_with("[0, 1400]", "[0, nan]"),
            "m.toml:9:17: axis.X.travel_mm[2]: nan is not a finite number; expected a length in mm");
  EXPECT_EQ(message_of_machine_with("[0, 1400]", "[0, 1e308]"),
            "m.toml:9:17: axis.X.travel_mm[2]: 1e308 is too large; expected a length in mm, at most 1e9 mm");
}

TEST(MachineFile, RefusesTravelThatNoMachineHas) {
  EXPECT_EQ(message_of_machine_with("[0, 1400]", "[0, 2e7]"),
            "m.toml:8:7: axis.X: reaches 2e+07 mm; a machine has less than 1e+07 mm");
  EXPECT_EQ(
      message_of_machine_with("endless = true", "travel_deg = [0, 2e9]"),
      "m.toml:4:7: axis.C: reaches 3.49066e+07 rad, more than 20000; mark a rotary axis without limits as endless");
}

}  // namespace
}  // namespace abbe
