#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// `abbe reproduce wang --grids FOLDER`.
class DialGrids : public CommandTest {
 protected:
  static std::string example(const std::string& name) { return std::string(ABBE_SOURCE_DIR "/examples/wang/") + name; }
};

TEST_F(DialGrids, OneDialExampleGivesTheReferencesErrors) {
  const CommandResult result = abbe({"reproduce", "wang", "--grids", example("one-dial"), "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json axis = nlohmann::json::parse(result.out).at(0);
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/tests/golden/wang/dial_grid_truth.csv"));
  std::string line, field;
  std::getline(file, line);
  std::size_t rows = 0;
  for (; std::getline(file, line); ++rows) {
    std::istringstream fields(line);
    std::vector<double> truth;
    while (std::getline(fields, field, ',')) truth.push_back(std::stod(field));
    EXPECT_NEAR(axis["EZX_um"].at(rows).get<double>(), truth[1], 2e-6);
    EXPECT_NEAR(axis["EYX_um"].at(rows).get<double>(), truth[2], 2e-6);
    EXPECT_NEAR(axis["EAX_urad"].at(rows).get<double>(), truth[3], 3e-5);
    EXPECT_NEAR(axis["u_EAX_urad"].at(rows).get<double>(), 1e3 * 0.6 / std::sqrt(15250.0), 1e-9);
  }
  EXPECT_EQ(rows, 12U);
  EXPECT_FALSE(axis.contains("EBX_urad"));
}

TEST_F(DialGrids, WholeMachineExampleIsWrittenWithItsCovariance) {
  const CommandResult result = abbe({"reproduce", "wang", "--grids", example("grids"), "-o", "found"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("EAA is not seen; it takes a polygon with autocollimator"));
  // The written machine ends where the readings end, so that a map of it is no extrapolation.
  std::vector<std::string> arguments = {
      "map", "--machine", "found/machine.machine.toml", "--errors", "found/decoupled.errors.toml", "--json"};
  for (const char* range :
       {"X_mm=0:400:2", "Y_mm=0:200:2", "Z_mm=0:400:2", "A_deg=60", "B_deg=-45:30:2", "C_deg=300"}) {
    arguments.insert(arguments.end(), {"--grid", range});
  }
  const CommandResult map = abbe(arguments);
  ASSERT_EQ(map.exit_code, ExitCode::done) << map.err;
  const nlohmann::json json = nlohmann::json::parse(map.out);
  EXPECT_EQ(json["outside_range"], 0);
  EXPECT_GT(json["standard_uncertainty_um"]["mean"].get<double>(), 0.3);
  EXPECT_LT(json["standard_uncertainty_um"]["mean"].get<double>(), 10);
  EXPECT_THAT(folder.read("found/decoupled_B.csv"), HasSubstr("B_deg,EXB_um,u_EXB_um"));
  const CommandResult check =
      abbe({"check", "--machine", "found/machine.machine.toml", "--errors", "found/decoupled.errors.toml"});
  EXPECT_EQ(check.exit_code, ExitCode::done) << check.err;
}

TEST_F(DialGrids, DialsOnOneLineEndWithTheComputationSaysNo) {
  folder.write("line/X.csv",
               "X_mm,direction,place_x_mm,place_y_mm,place_z_mm,indication_um\n"
               "0,Z,0,0,0,1\n0,Z,10,20,0,1\n0,Z,30,60,0,1\n10,Z,0,0,0,1\n10,Z,10,20,0,1\n10,Z,30,60,0,1\n"
               "20,Z,0,0,0,1\n20,Z,10,20,0,1\n20,Z,30,60,0,1\n");
  const CommandResult result = abbe({"reproduce", "wang", "--grids", "line", "-o", "found"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("not decoupled: only a combination of EAX, EBX is seen"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "found"));
}

TEST_F(DialGrids, BadInputIsNamed) {
  EXPECT_EQ(abbe({"reproduce", "wang", "--grids", "none"}).err,
            "abbe: none: there is no such folder; expected a folder with files X.csv, A.csv, ...\n");
  folder.write("grids/readme.txt", "none");
  EXPECT_EQ(abbe({"reproduce", "wang", "--grids", "grids"}).err,
            "abbe: grids: no file ends in .csv; expected readings of one axis a file\n");
  const std::string header = "X_mm,direction,place_x_mm,place_y_mm,place_z_mm,indication_um\n";
  folder.write("grids/1.csv", header + "0,Z,0,0,0,1\n10,Z,0,0,0,1\n20,Z,0,0,0,1\n");
  folder.write("grids/2.csv", header + "0,Y,0,0,0,1\n");
  const CommandResult twice = abbe({"reproduce", "wang", "--grids", "grids"});
  EXPECT_EQ(twice.exit_code, ExitCode::bad_input);
  EXPECT_EQ(twice.err, "abbe: grids/2.csv: axis X was read from grids/1.csv; expected one file per axis\n");
  EXPECT_EQ(twice.out, "");
  EXPECT_EQ(abbe({"reproduce", "aguado", "--grids", "grids"}).err,
            "abbe: --grids: does not belong to aguado; expected abbe reproduce wang\n");
}

}  // namespace
}  // namespace abbe
