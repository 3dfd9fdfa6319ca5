#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>

#include "abbe/controls/control_table.h"
#include "abbe/controls/described_machines_for_test.h"
#include "abbe/controls/table_format.h"
#include "abbe/controls/writer_request.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string text_of(const ControlTables& made, const std::string& name) {
  for (const ControlFile& file : made.files) {
    if (file.name == name) return file.text;
  }
  return "no " + name;
}

std::string refused(const ControlTableRequest& request) {
  try {
    make_control_tables(request);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

/// A mill w Y' b X Z t with EYX, EBX as straight lines from 0 and the squareness EC0Y.
ControlTableRequest small_request() {
  Machine machine = parse_chain("w Y' b X Z t").machine;
  for (Axis& axis : machine.axes) axis.travel_min = 0, axis.travel_max = 100;
  ErrorSet errors;
  for (const auto& [component, size] : {std::pair(Component::Y, 4e-3), std::pair(Component::B, 1e-5)}) {
    ErrorMotion motion;
    motion.axis = machine.find_axis("X");
    motion.component = component;
    motion.basis = {.kind = BasisKind::table_linear, .from = 0, .to = 100, .nodes = {0, 100}};
    motion.coefficients = {0, size};
    errors.motions.push_back(motion);
  }
  errors.locations.push_back({.axis = machine.find_axis("Y"), .component = Component::C, .value = 20e-6});
  return test::comp_request(machine, errors);
}

TEST(HeidenhainComp, TableAndTransformationsBelongToEachOther) {
  const ControlTables made = make_control_tables(small_request());
  ASSERT_FALSE(made.says_no());
  ASSERT_EQ(made.files.size(), 3U);
  // X carries the tool: from the tool to the table its errors come with the other sign; Y carries the workpiece. The
  // frame of the tool is the gauge point, and the reference point of X is the origin: both are the same here.
  EXPECT_EQ(text_of(made, "X.COM"),
            "BEGIN X.COM MM\n"
            "NR AXISPOS C2 C5\n"
            "0 0.000000 0.000000 0.0000000\n"
            "1 100.000000 -0.004000 -0.0005730\n"
            "[END]\n");
  EXPECT_EQ(text_of(made, "CONFIG.CMA"), "BEGIN CONFIG.CMA MM\nNR ACTIVE 1\n0 * X.COM\n[END]\n");
  EXPECT_EQ(text_of(made, "KINEMATICS.TAB"),
            "BEGIN KINEMATICS.TAB MM\n"
            "NR   DOC             KEY       AXIS  COORD               COMPTAB\n"
            "0                    MachAxis  Z\n"
            "1    EYX             Trans     Y                         A1C2\n"
            "2    EBX             Trans     B                         A1C5\n"
            "3                    MachAxis  X\n"
            "4                    MachBase\n"
            "5    EC0Y            Trans     C                         0.0011459\n"
            "6                    MachAxis  Y\n"
            "7    -EC0Y           Trans     C                         -0.0011459\n"
            "[END]\n");
  EXPECT_THAT(made.settings, testing::Contains(HasSubstr("4 of 97 entries in COMPTAB, 3 of 50 rows with COORD")));
  EXPECT_LT(made.after.position_statistics.maximum, 2e-5);
}

TEST(HeidenhainComp, SignsOfColumnsAndOwnColumnsTurnByThemselves) {
  ControlTableRequest request = small_request();
  const std::size_t x = request.machine.find_axis("X");
  request.errors.motions.push_back(request.errors.motions[0]);
  request.errors.motions.back().component = Component::X;
  ASSERT_EQ(request.errors.motions.back().axis, x);
  const std::string plain = text_of(make_control_tables(request), "X.COM");
  EXPECT_THAT(plain, HasSubstr("NR AXISPOS 1 C2 C5\n"));
  EXPECT_THAT(plain, HasSubstr("1 100.000000 0.004000 -0.004000 -0.0005729\n"));
  request.negate = true;
  const ControlTables turned = make_control_tables(request);
  EXPECT_THAT(text_of(turned, "X.COM"), HasSubstr("1 100.000000 0.004000 0.004000 0.0005729\n"));
  EXPECT_THAT(text_of(turned, "KINEMATICS.TAB"), HasSubstr("Trans     C                         -0.0011459\n6"));
  EXPECT_LT(turned.after.position_statistics.maximum, 2e-5);
  request.negate_own = true;
  EXPECT_THAT(text_of(make_control_tables(request), "X.COM"), HasSubstr("1 100.000000 -0.004000 0.004000 0.0005729\n"));
  request.negate = false;
  EXPECT_THAT(text_of(make_control_tables(request), "X.COM"),
              HasSubstr("1 100.000000 -0.004000 -0.004000 -0.0005729\n"));
}

class HeidenhainCompCarries : public testing::TestWithParam<test::DescribedCase> {};

TEST_P(HeidenhainCompCarries, EveryErrorMotionAndLocationErrorByItself) {
  const Machine machine = GetParam().machine();
  const ErrorSet errors = test::all_errors(machine);
  const ControlTables made = make_control_tables(test::comp_request(machine, errors));
  ASSERT_FALSE(made.says_no());
  EXPECT_EQ(made.errors.size(), errors.motions.size() + errors.locations.size());
  for (const CarriedError& error : made.errors) {
    if (!(error.effect_before > 1e-4)) continue;  // moves no point
    EXPECT_GT(error.carried(), 0.95) << error.name << " " << 1e3 * error.effect_before << " um";
  }
}

// Six error motions of each axis and all location errors: 43 with two rotary axes, and two zero positions of a linear
// axis more than ISO 230-1 counts.
TEST_P(HeidenhainCompCarries, AllErrorsTogetherAndLeavesTheTiltsOfTheTool) {
  const Machine machine = GetParam().machine();
  const ErrorSet errors = test::all_errors(machine);
  EXPECT_GE(errors.motions.size() + errors.locations.size(), 43U);
  const ControlTables made = make_control_tables(test::comp_request(machine, errors));
  ASSERT_FALSE(made.says_no());
  EXPECT_GT(made.before.position_statistics.rms, 0.03);
  EXPECT_LT(made.after.position_statistics.maximum, 1e-3);
  EXPECT_GT(made.after.orientation_statistics.rms, 0.1 * made.before.orientation_statistics.rms);
  EXPECT_LT(made.left_by_tables.maximum, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Machines, HeidenhainCompCarries, testing::ValuesIn(test::described_cases()),
                         [](const auto& each) { return each.param.name; });

TEST(HeidenhainComp, AnAxisThatIsNotWantedStaysAsItIsInTheMachineFile) {
  const Machine machine = test::trunnion_machine();
  ControlTableRequest request = test::comp_request(machine, test::all_errors(machine));
  request.axes = {"X", "C"};
  request.least_reduction = 0;
  const ControlTables made = make_control_tables(request);
  std::vector<std::string> names;
  for (const ControlFile& file : made.files) names.push_back(file.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("X.COM", "C.COM", "CONFIG.CMA", "KINEMATICS.TAB"));
  const std::string rows = text_of(made, "KINEMATICS.TAB");
  EXPECT_THAT(rows, HasSubstr("Y of A          Trans     Y     0.020000\n"));
  EXPECT_THAT(rows, Not(HasSubstr("EC0Y")));
  EXPECT_THAT(rows, HasSubstr("EB0C"));
  // Of the turn about C itself only products of angles are left.
  EXPECT_THAT(rows, Not(HasSubstr("A5C6")));
}

// Every axis fills five rows, two tilts and two inverse ones; no machine has more letters than nine.
TEST(HeidenhainComp, AllErrorsOfNineAxesFitIntoTheDescription) {
  const Machine machine = parse_chain("w C' A' Z' b X Y W B U V t").machine;
  const ErrorSet errors = test::all_errors(machine);
  const TableFormat& format = table_format("heidenhain-kinematics-comp");
  const WrittenTables made = format.write(machine, errors, writer_request(test::comp_request(machine, errors), format));
  EXPECT_TRUE(made.problems.empty());
  EXPECT_EQ(made.files.size(), 11U);
  std::size_t comptab = 0;
  ASSERT_EQ(std::sscanf(made.remarks.front().c_str(), "KINEMATICS.TAB: %zu of 91", &comptab), 1);
  EXPECT_LE(comptab, 91U);
  EXPECT_GT(comptab, 70U);
}

TEST(HeidenhainComp, MachinesThatTheDescriptionDoesNotHaveAreRefused) {
  ControlTableRequest request = small_request();
  request.machine.couplings.push_back({.axis = 0, .of = 1, .ratio = 0.5});
  EXPECT_THAT(refused(request), HasSubstr("coupled"));
  request = small_request();
  request.machine.axes[request.machine.find_axis("X")].direction = Eigen::Vector3d(1, 0.01, 0).normalized();
  EXPECT_THAT(refused(request), HasSubstr("X does not move the tool along +X of the workpiece"));
  request = small_request();
  request.machine.axes[request.machine.find_axis("Y")].primed = false;
  EXPECT_THAT(refused(request), HasSubstr("Y does not move the tool along +Y of the workpiece"));
  request = small_request();
  request.machine.axes[request.machine.find_axis("Z")].name = "R";
  EXPECT_THAT(refused(request), HasSubstr("MachAxis has no letter for R"));
  request = small_request();
  request.machine.axes[request.machine.find_axis("Z")].name = "X2";
  EXPECT_THAT(refused(request), HasSubstr("two axes have the letter X"));
  request = small_request();
  request.errors.composition.first_order = true;
  EXPECT_THAT(refused(request), HasSubstr("first-order errors"));
  request = small_request();
  request.names = {{"X", "X"}};
  EXPECT_THAT(refused(request), HasSubstr("'X' is not a number"));
}

TEST(HeidenhainComp, TooFewPointsAreSaidAndNothingIsWritten) {
  const Machine machine = test::trunnion_machine();
  ControlTableRequest request = test::comp_request(machine, test::all_errors(machine));
  request.most_nodes = 3;
  const ControlTables made = make_control_tables(request);
  EXPECT_TRUE(made.says_no());
  EXPECT_TRUE(made.files.empty());
  EXPECT_THAT(made.too_few_nodes, HasSubstr("heidenhain-kinematics-comp has room for"));
  for (const TableFigures& table : made.tables) EXPECT_LE(table.nodes, 3U);
}

}  // namespace
}  // namespace abbe
