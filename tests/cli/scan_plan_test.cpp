#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "cli/command_test.h"

namespace abbe {
namespace {

class ScanPlanCommand : public CommandTest {
 protected:
  const std::string examples = std::string(ABBE_SOURCE_DIR) + "/examples/";
  const std::string machine = examples + "machines/liu-scanner.machine.toml";
  const std::string pyramid = examples + "cradle_scanner/pyramid.stl";
};

TEST_F(ScanPlanCommand, CoversThePyramidAndWritesPathProgramAndCoverage) {
  const CommandResult result =
      abbe({"scan", "plan", pyramid, "--machine", machine, "--along-mm", "1", "--between-mm", "1", "-o", "path.csv",
            "--program", "path.ngc", "--coverage", "coverage.ply", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json["faces"].size(), 10U);
  for (const nlohmann::json& face : json["faces"]) EXPECT_EQ(face["path"], "raster");
  EXPECT_GT(json["covered_percent"].get<double>(), 99.0);
  EXPECT_EQ(json["missed"], 0);
  std::istringstream path(folder.read("path.csv"));
  std::string line;
  std::getline(path, line);
  EXPECT_EQ(line, "time_s,C_deg,A_deg,X_mm,Y_mm,Z_mm,measures,face,line,x_mm,y_mm,z_mm,i,j,k");
  const std::string program = folder.read("path.ngc");
  EXPECT_NE(program.find("\nG93\n"), std::string::npos);
  EXPECT_NE(program.find("(face 10 line 1, raster)"), std::string::npos);
  EXPECT_TRUE(program.ends_with("G94\nM2\n"));
  EXPECT_EQ(folder.read("coverage.ply").substr(0, 4), "ply\n");
}

TEST_F(ScanPlanCommand, SaysWhatItDoesNotReach) {
  // The probe is as thick as the part is long, and the part stands on a plate.
  folder.write("plate.obj", "v -60 -20.1 -60\nv 60 -20.1 -60\nv 60 -20.1 60\nv -60 -20.1 60\nf 1 4 3\nf 1 3 2\n");
  const CommandResult result = abbe({"scan", "plan", pyramid, "--machine", machine, "--stage", "plate.obj",
                                     "--along-mm", "2", "--between-mm", "2", "--probe-radius-mm", "15", "--json"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_GT(json["missed"].get<int>(), 10);
  EXPECT_LT(json["covered_percent"].get<double>(), 95.0);
}

TEST_F(ScanPlanCommand, RefusesAnOpenMesh) {
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandResult result = abbe({"scan", "plan", "open.obj", "--machine", machine});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_NE(result.err.find("open.obj"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("not closed"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace abbe
