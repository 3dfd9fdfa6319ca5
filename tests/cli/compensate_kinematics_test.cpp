#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "abbe/controls/kinematic_values.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class CompensateKinematics : public CommandTest {
 protected:
  const std::filesystem::path source = ABBE_SOURCE_DIR;
  const std::string mill = (source / "examples/machines/trunnion-mill.machine.toml").string();
  const std::string errors = (source / "examples/compensate/trunnion.errors.toml").string();

  CommandResult kinematics(const std::string& format, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"compensate", "kinematics", "--machine", mill,          "--errors",
                                          errors,       "--for",      format,      "--positions", "3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
};

TEST_F(CompensateKinematics, WritesWhatTheLibraryMakesAndSaysWhatIsLeft) {
  for (const std::string format : {"values", "linuxcnc", "siemens", "fanuc", "heidenhain"}) {
    const CommandResult result = kinematics(format, {"-o", "file-" + format, "--json"});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    KinematicValuesRequest request;
    request.format = format;
    request.machine = read_machine(mill);
    request.errors = read_errors(errors, request.machine).errors;
    request.positions = 3;
    const KinematicValues made = make_kinematic_values(request);
    EXPECT_EQ(folder.read("file-" + format), made.file.text);
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["values"].size(), made.values.size());
    EXPECT_LT(json["after"]["rms_um"].get<double>(), 0.85 * json["before"]["rms_um"].get<double>()) << format;
    EXPECT_LT(json["ideal"]["max_um"].get<double>(), 1e-6);
    const bool directions = format == "values" || format == "siemens" || format == "heidenhain";
    const std::map<std::string, std::string> expected = {
        {"EX0C", "carried"}, {"EXX", "not carried"}, {"EB0C", directions ? "carried" : "not carried"}};
    std::size_t found = 0;
    for (const nlohmann::json& error : json["errors"]) {
      const auto one = expected.find(error["name"].get<std::string>());
      if (one == expected.end()) continue;
      EXPECT_EQ(error["carried"], one->second) << format << " " << one->first;
      ++found;
    }
    EXPECT_EQ(found, expected.size());
  }
}

TEST_F(CompensateKinematics, ReportsInWordsAndReplacesAFileOnlyWhenItIsTold) {
  CommandResult result = kinematics("linuxcnc", {"--dry-run"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("xyzac-trt-kins.x-rot-point"));
  EXPECT_THAT(result.out, HasSubstr("+14.00 um (standard uncertainty 0.80)"));
  EXPECT_THAT(result.out, HasSubstr("what these values leave of it"));
  EXPECT_THAT(result.out, HasSubstr("dry run: nothing is written"));
  ASSERT_EQ(kinematics("linuxcnc", {"-o", "kins.hal"}).exit_code, ExitCode::done);
  EXPECT_EQ(kinematics("linuxcnc", {"-o", "kins.hal"}).exit_code, ExitCode::bad_input);
  EXPECT_EQ(kinematics("linuxcnc", {"-o", "kins.hal", "--force"}).exit_code, ExitCode::done);
}

TEST_F(CompensateKinematics, SaysNoWithExitCodeOneAndRefusesBadInputWithTwo) {
  CommandResult result = kinematics("siemens", {"-o", "TRAFO5.INI", "--limit-um", "10"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("is above --limit-um 10: $MC_TRAFO5_"));
  EXPECT_THAT(result.err, HasSubstr("nothing is written"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "TRAFO5.INI"));
  result = kinematics("linuxcnc", {"-o", "kins.hal", "--tool-carrier", "3"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("--tool-carrier: would change nothing"));
  EXPECT_EQ(kinematics("siemens", {}).exit_code, ExitCode::bad_input);
  EXPECT_EQ(kinematics("tnc", {"--dry-run"}).exit_code, ExitCode::bad_input);
  const std::string three = (source / "examples/machines/three-axis-mill.machine.toml").string();
  const std::string its_errors = (source / "examples/compensate/mill.errors.toml").string();
  result =
      abbe({"compensate", "kinematics", "--machine", three, "--errors", its_errors, "--for", "values", "--dry-run"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("the machine has no rotary axis"));
}

}  // namespace
}  // namespace abbe
