#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/controls/described_machines_for_test.h"
#include "abbe/controls/kinematic_values.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using testing::HasSubstr;

KinematicValuesRequest values_request(const Machine& machine) {
  KinematicValuesRequest request;
  request.format = "heidenhain";
  request.machine = machine;
  request.positions = 3;
  request.least_reduction = 0;
  return request;
}

std::string refused(const KinematicValuesRequest& request) {
  try {
    make_kinematic_values(request);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

// Rows and values of the manual, page 670.
TEST(HeidenhainValues, OfTheMachineOfTheManualAreItsTable) {
  const KinematicValues made = make_kinematic_values(values_request(test::machine_of_the_manual()));
  EXPECT_EQ(made.file.name, "KINEMATICS.TAB");
  EXPECT_EQ(made.file.text,
            "BEGIN KINEMATICS.TAB MM\n"
            "NR   DOC             KEY       AXIS  COORD               COMPTAB\n"
            "0    X of B          Trans     X     0.016000\n"
            "1    Z of B          Trans     Z     250.051000\n"
            "2                    MachAxis  B\n"
            "3                    MachAxis  Y\n"
            "4                    MachAxis  X\n"
            "5                    MachBase\n"
            "6                    MachAxis  Z\n"
            "7    X of C          Trans     X     -298.923000\n"
            "8    Y of C          Trans     Y     200.172000\n"
            "9                    MachAxis  C\n"
            "[END]\n");
}

class HeidenhainValuesCarry : public testing::TestWithParam<test::DescribedCase> {};

TEST_P(HeidenhainValuesCarry, PositionsAndDirectionsOfRotaryAxes) {
  const Machine machine = GetParam().machine();
  KinematicValuesRequest request = values_request(machine);
  request.errors = test::all_errors(machine);
  request.errors.motions.clear();
  std::erase_if(request.errors.locations, [&](const LocationError& location) {
    const Axis& axis = machine.axes[location.axis];
    // Turns of an oblique axis are also a part of its zero position, which the rows do not have.
    return axis.kind == AxisKind::linear || location_effect(axis, location.component).zero_position != 0;
  });
  const KinematicValues made = make_kinematic_values(request);
  ASSERT_FALSE(made.says_no());
  EXPECT_GT(made.before.position_statistics.rms, 0.03);
  EXPECT_LT(made.after.position_statistics.maximum, 5e-6) << "numbers are written with 1e-6 mm and 1e-7 degrees";
  for (const CarriedError& error : made.errors) {
    if (!(error.effect_before > 1e-4)) continue;  // moves no point
    EXPECT_GT(error.carried(), 0.99) << error.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, HeidenhainValuesCarry, testing::ValuesIn(test::described_cases()),
                         [](const auto& each) { return each.param.name; });

// A table C that is off by 10 um and tilted by 50 urad: by hand.
TEST(HeidenhainValues, OfATiltedTableAreThoseOfAHandCalculation) {
  const Machine machine = test::machine_of_the_manual();
  KinematicValuesRequest request = values_request(machine);
  const std::size_t c = machine.find_axis("C");
  // The squareness of Y is in no row.
  request.errors.locations = {{.axis = c, .component = Component::Y, .value = 0.01},
                              {.axis = c, .component = Component::A, .value = 50e-6},
                              {.axis = machine.find_axis("Y"), .component = Component::C, .value = 30e-6}};
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_THAT(made.file.text, HasSubstr("Trans     Y     200.182000\n"
                                        "9    tilt of C       Trans     A     0.0028648\n"
                                        "10                   MachAxis  C\n"
                                        "11   -tilt of C      Trans     A     -0.0028648\n[END]\n"));
}

TEST(HeidenhainValues, OfMachinesThatTheDescriptionDoesNotHaveAreRefused) {
  KinematicValuesRequest request = values_request(parse_chain("w X' Y' b Z t").machine);
  EXPECT_THAT(refused(request), HasSubstr("the machine has no rotary axis"));
  request = values_request(test::machine_of_the_manual());
  request.machine.axes[request.machine.find_axis("X")].direction = -Eigen::Vector3d::UnitX();
  EXPECT_THAT(refused(request), HasSubstr("X does not move the tool along +X of the workpiece"));
}

}  // namespace
}  // namespace abbe
