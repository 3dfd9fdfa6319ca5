#include "abbe/controls/control_table.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "abbe/controls/table_format.h"
#include "abbe/controls/table_map.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ControlTablesTest : public testing::Test {
 protected:
  ControlTableRequest request_for(const std::string& format) const {
    const std::string examples = std::string(ABBE_SOURCE_DIR) + "/examples/";
    ControlTableRequest request;
    request.format = format;
    request.machine = read_machine(examples + "machines/three-axis-mill.machine.toml");
    request.errors = read_errors(examples + "compensate/mill.errors.toml", request.machine).errors;
    request.positions = 3;
    return request;
  }
  /// Why a request is refused, after a change.
  std::string refused(const std::string& format, const std::function<void(ControlTableRequest&)>& change) const {
    ControlTableRequest request = request_for(format);
    change(request);
    try {
      make_control_tables(request);
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  }
};

TEST(TableFormats, EachIsARowOfDataWithAWriter) {
  std::set<std::string> names;
  for (const TableFormat& format : table_formats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    for (const std::string* text : {&format.control, &format.what, &format.convention, &format.cannot}) {
      EXPECT_THAT(*text, Not(IsEmpty())) << format.name;
    }
    EXPECT_TRUE(format.write) << format.name;
    EXPECT_EQ(&table_format(format.name), &format);
  }
}

TEST(TableFormats, EverySettingHasAnOptionAndAFormatThatTakesIt) {
  for (const TableSetting setting : table_settings()) {
    EXPECT_THAT(setting_option(setting), testing::StartsWith("--"));
    const std::vector<TableFormat>& formats = table_formats();
    EXPECT_TRUE(std::any_of(formats.begin(), formats.end(), [&](const TableFormat& format) {
      return format.takes.contains(setting);
    })) << setting_option(setting);
  }
}

TEST_F(ControlTablesTest, AreTextWithWhatTheyLeaveOfTheError) {
  const ControlTableRequest request = request_for("siemens-cec");
  const ControlTables made = make_control_tables(request);
  EXPECT_FALSE(made.says_no());
  ASSERT_EQ(made.files.size(), 1U);
  EXPECT_EQ(made.files[0].name, "CEC.INI");
  EXPECT_THAT(made.files[0].text, testing::StartsWith("%_N_NC_CEC_INI\n"));
  EXPECT_EQ(made.format->kind, TableKind::axis_pairs);
  EXPECT_EQ(made.poses.count(), 27U);
  EXPECT_LT(made.after.position_statistics.mean, 0.2 * made.before.position_statistics.mean);
  ASSERT_TRUE(made.volumetric.predicted_before);
  EXPECT_LT(made.left_by_tables.mean, made.volumetric.predicted_before->mean);
  for (const TableFigures& table : made.tables) EXPECT_GT(table.standard_uncertainty.value_or(0), 0) << table.name;
  EXPECT_THAT(made.settings, testing::Contains(HasSubstr("MD32711")));
  EXPECT_EQ(control_table_map(request.machine, made).grid, (std::vector<std::size_t>{3, 3, 3}));
}

TEST_F(ControlTablesTest, ThatMustNotBeUsedHaveNoFilesAndSayWhy) {
  ControlTableRequest request = request_for("siemens-eec");
  request.limit_mm = 0.02;
  ControlTables made = make_control_tables(request);
  EXPECT_TRUE(made.says_no());
  EXPECT_THAT(made.files, IsEmpty());
  EXPECT_THAT(made.refused, testing::Contains(HasSubstr("um is above --limit-um 20: table X")));
  request = request_for("siemens-eec");
  request.most_nodes = 3;
  made = make_control_tables(request);
  EXPECT_TRUE(made.says_no());
  EXPECT_THAT(made.files, IsEmpty());
  EXPECT_THAT(made.too_few_nodes, HasSubstr("the nodes that siemens-eec has room for"));
  EXPECT_TRUE(ControlTables().says_no());
}

TEST_F(ControlTablesTest, ARequestThatTheControlCannotTakeIsRefusedWithTheOptionThatSetsIt) {
  const auto nothing = [](ControlTableRequest&) {};
  EXPECT_THAT(refused("heidenhain-9", nothing), HasSubstr("--for: unknown format 'heidenhain-9'; expected linuxcnc, "));
  EXPECT_EQ(refused("linuxcnc", [](ControlTableRequest& request) { request.negate = true; }),
            "--negate: would change nothing in tables for linuxcnc; expected --for siemens-cec, heidenhain, "
            "heidenhain-kinematics-comp, fanuc-pitch, fanuc-3d, aerotech-1d, aerotech-2d; or to leave it out");
  EXPECT_THAT(refused("siemens-cec", [](ControlTableRequest& request) { request.axes = {"Q"}; }),
              HasSubstr("--axis Q: the machine has no such axis"));
  EXPECT_THAT(refused("fanuc-3d",
                      [](ControlTableRequest& request) {
                        request.axes = {"X", "Y"};
                      }),
              HasSubstr("--axis: 2 axes for the grid; expected three linear axes that move"));
  EXPECT_THAT(refused("linuxcnc",
                      [](ControlTableRequest& request) {
                        request.names = {{"X", "X1"}};
                      }),
              HasSubstr("--name X=X1: 'X1' is not a number; expected AXIS=NAME"));
  EXPECT_THAT(refused("siemens-cec",
                      [](ControlTableRequest& request) {
                        request.names = {{"X", "AX2"}};
                      }),
              HasSubstr("two axes are called AX2"));
  EXPECT_THAT(refused("siemens-cec",
                      [](ControlTableRequest& request) {
                        request.reference = {{0, 1e5}};
                      }),
              HasSubstr("_mm=100000: outside the axis's travel"));
  EXPECT_THAT(refused("siemens-cec",
                      [](ControlTableRequest& request) {
                        request.reference = {{3, 0}};
                      }),
              HasSubstr("--at: the machine has no axis 3"));
  EXPECT_THAT(refused("klipper",
                      [](ControlTableRequest& request) {
                        for (Axis& axis : request.machine.axes) axis.name += "1";
                      }),
              HasSubstr("--for: the machine has no linear axis X"));
  EXPECT_EQ(refused("marlin", [](ControlTableRequest& request) { request.limit_mm = 0; }),
            "--limit-um: 0 is not a limit; expected a number above zero in um, or no limit at all");
  EXPECT_EQ(refused("marlin", [](ControlTableRequest& request) { request.limit_rad = -2e-6; }),
            "--limit-urad: -2 is not a limit; expected a number above zero in urad, or no limit at all");
  EXPECT_EQ(refused("linuxcnc", [](ControlTableRequest& request) { request.leave_out_below = -1; }),
            "--leave-out-below-uncertainty: out of range; expected 0 to 1000 standard uncertainties");
}

}  // namespace
}  // namespace abbe
