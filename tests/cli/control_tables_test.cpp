// Tables made from C++ are the files that `abbe compensate table` writes for the same request.
#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

struct SameRequest {
  const char* format;
  std::vector<std::string> options;
  std::function<void(ControlTableRequest&)> fields;
};

class ControlTablesOfTheCommand : public CommandTest {};

TEST_F(ControlTablesOfTheCommand, AreThoseOfTheLibrary) {
  const std::filesystem::path examples = std::filesystem::path(ABBE_SOURCE_DIR) / "examples";
  const std::string machine = (examples / "machines/three-axis-mill.machine.toml").string();
  const std::string errors = (examples / "compensate/mill.errors.toml").string();
  // One of each kind: a table per axis, pairs of axes, a lattice, errors, angles.
  const std::vector<SameRequest> all = {
      {"linuxcnc",
       {"--interpolation-um", "0.5", "--name", "X=3", "--at", "X_mm=100"},
       [](ControlTableRequest& request) {
         request.tolerance_mm = 0.5e-3;
         request.names = {{"X", "3"}};
         request.reference = {{request.machine.find_axis("X"), 100}};
       }},
      {"siemens-cec",
       {"--negate", "--first-table", "7", "--axis", "X", "--axis", "Y"},
       [](ControlTableRequest& request) {
         request.negate = true;
         request.first_table = 7;
         request.axes = {"X", "Y"};
       }},
      {"fanuc-3d",
       {"--detection-unit-um", "0.5", "--reference-position", "Y_mm=50"},
       [](ControlTableRequest& request) {
         request.detection_unit_mm = 0.5e-3;
         request.reference_position = {{request.machine.find_axis("Y"), 50}};
       }},
      {"aerotech-2d",
       {"--interpolation-um", "1", "--name", "X=4", "--negate"},
       [](ControlTableRequest& request) {
         request.tolerance_mm = 1e-3;
         request.names = {{"X", "4"}};
         request.negate = true;
       }},
      {"etalon",
       {"--leave-out-below-uncertainty", "5"},
       [](ControlTableRequest& request) { request.leave_out_below = 5; }},
      {"marlin", {}, [](ControlTableRequest&) {}},
  };
  for (const SameRequest& one : all) {
    std::vector<std::string> arguments = {"compensate", "table",       "--machine", machine,  "--errors",
                                          errors,       "--for",       one.format,  "--json", "-o",
                                          one.format,   "--positions", "3"};
    arguments.insert(arguments.end(), one.options.begin(), one.options.end());
    const CommandResult result = abbe(arguments);
    ASSERT_EQ(result.exit_code, ExitCode::done) << one.format << ": " << result.err;

    ControlTableRequest request;
    request.format = one.format;
    request.machine = read_machine(machine);
    const ErrorsFile file = read_errors(errors, request.machine);
    request.errors = file.errors;
    request.covariance = file.covariance;
    request.positions = 3;
    one.fields(request);
    const ControlTables made = make_control_tables(request);
    EXPECT_FALSE(made.says_no()) << one.format;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    ASSERT_EQ(json["files"].size(), made.files.size()) << one.format;
    for (const ControlFile& written : made.files) {
      EXPECT_EQ(folder.read(std::string(one.format) + "/" + written.name), written.text) << one.format;
    }
    EXPECT_EQ(json["left_out"].get<std::vector<std::string>>(), made.left_out) << one.format;
    EXPECT_EQ(json["settings"].get<std::vector<std::string>>(), made.settings) << one.format;
    EXPECT_EQ(json["after"]["max_um"].get<double>(), 1e3 * made.after.position_statistics.maximum) << one.format;
  }
}

}  // namespace
}  // namespace abbe
