// What `run` says of the values it has found: location errors, set-ups with their poses, points of the input by name.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kTrueErrors = R"(chain = "w X' b Z t"
[[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [20, 30, 10]  # zero at X = 0, as by convention
[[location]]
name = "EB0Z"
value_urad = 120
)";

const char* const kHead = R"(machine = "m.toml"
seed = 11
output = "out"
)";
const char* const kSimulate = "[simulate]\nerrors = \"truth.errors.toml\"\n";
const std::string kSetup = std::string(R"([[setup]]
name = "laser"
instrument = "tracker"
noise = { xyz_um = 5 }
)") + kThreeReflectors + R"([[setup.station]]
name = "S"
)";
const char* const kPlan = R"(true_pose = { position_mm = [300, -900, 150], angles_deg = [5, -3, 130] }
[[setup.plan]]
kind = "grid"
axis.X = { count = 6 }
axis.Z = { count = 4 }
)";
const char* const kIdentify = R"([identify]
locations = ["EB0Z"]
loss = "huber"
held_out_fraction = 0
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 2
[report]
page = false
)";

class StudyFoundValues : public CommandTest {
 protected:
  StudyFoundValues() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write("truth.errors.toml", kTrueErrors);
    folder.write("s.study.toml", std::string(kHead) + kSimulate + kSetup + kPlan + kIdentify);
  }
};

TEST_F(StudyFoundValues, LocationErrorsAndTheWholePoseOfAStationAreGivenWithTheirUncertainty) {
  const CommandResult program = abbe({"run", "s.study.toml", "--json"});
  ASSERT_EQ(program.exit_code, ExitCode::done) << program.err;
  const nlohmann::json found = nlohmann::json::parse(program.out)["identified"];
  EXPECT_EQ(found["coverage_factor"], 2);
  const nlohmann::json& square = found["location_errors"][0];
  EXPECT_EQ(square["name"], "EB0Z");
  EXPECT_NEAR(square["value_urad"], 120, 2 * square["expanded_uncertainty_urad"].get<double>());
  EXPECT_LT(square["expanded_uncertainty_urad"], 30);
  const nlohmann::json& station = found["setups"][0]["places"][0];
  EXPECT_EQ(station["name"], "S");
  EXPECT_EQ(station["frame"], "workpiece");
  const double position[] = {300, -900, 150}, angles[] = {5, -3, 130};
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = station["position_expanded_uncertainty_um"][k],
                 turn = station["turn_expanded_uncertainty_urad"][k];
    EXPECT_GT(u, 0.5);
    EXPECT_GT(turn, 0.5);
    EXPECT_NEAR(station["position_mm"][k], position[k], 2e-3 * u + 1e-6) << k;
    EXPECT_NEAR(station["angles_deg"][k], angles[k], 2 * 57.3e-6 * turn) << k;
  }
  const CommandResult text = abbe({"run", "s.study.toml"});
  EXPECT_THAT(text.out, HasSubstr("EB0Z"));
  EXPECT_THAT(text.out, HasSubstr("S in the frame of the workpiece"));
  EXPECT_THAT(text.out, HasSubstr("angles a, b, c"));
}

TEST_F(StudyFoundValues, PointsKeepTheirNamesInResidualsAndAmongTheOutliers) {
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "data"}).exit_code, ExitCode::done);
  std::istringstream lines(folder.read("data/laser.csv"));
  std::string csv, line, bad;
  for (int row = -1; std::getline(lines, line); ++row) {
    if (row == 40) {
      // A gross error of the first measured coordinate: the first column that follows the names.
      const std::size_t end = line.find_last_of(',', line.find_last_of(',') - 1);
      const std::size_t begin = line.find_last_of(',', end - 1);
      line.replace(begin + 1, end - begin - 1, std::to_string(std::stod(line.substr(begin + 1)) + 7));
    }
    csv += line + (row < 0 ? ",name\n" : row == 3 ? ",\n" : ",\"P, " + std::to_string(row) + "\"\n");
  }
  folder.write("readings.csv", csv);
  folder.write("s.study.toml", std::string(kHead) + kSetup +
                                   "[[setup.data]]\nfile = \"readings.csv\"\ncolumns = { point = \"name\" }\n" +
                                   kIdentify);
  const CommandResult result = abbe({"run", "s.study.toml", "--json"});
  const nlohmann::json summary = nlohmann::json::parse(result.out, nullptr, false);
  ASSERT_FALSE(summary["outlier_list"].empty()) << result.err << result.out;
  EXPECT_EQ(summary["outlier_list"][0]["point"], "P, 40");
  EXPECT_EQ(summary["outlier_list"][0]["reading"], 40);
  const std::string residuals = folder.read("out/residuals.csv");
  EXPECT_THAT(residuals, testing::StartsWith("setup,reading,point,X_mm"));
  EXPECT_THAT(residuals, HasSubstr("\nlaser,40,\"P, 40\","));
  EXPECT_THAT(residuals, HasSubstr("\nlaser,3,,"));
  EXPECT_THAT(abbe({"run", "s.study.toml"}).out, HasSubstr("laser reading 40, point P, 40:"));
}

TEST_F(StudyFoundValues, FiguresOfAPartOfTheErrorsSaySo) {
  const CommandResult result = abbe({"run", "s.study.toml", "--json"});
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  EXPECT_EQ(summary["errors_known"], 2);
  EXPECT_EQ(summary["errors_of_machine"], 10);
  EXPECT_THAT(summary["verdict"].get<std::string>(), HasSubstr("2 of the "));
  const CommandResult map = abbe({"map", "--machine", "m.toml", "--errors", "out/errors.toml"});
  EXPECT_THAT(map.out, HasSubstr("; known are 2 of the "));
  EXPECT_THAT(map.out, HasSubstr("caution: 2 of the "));
  const nlohmann::json json =
      nlohmann::json::parse(abbe({"map", "--machine", "m.toml", "--errors", "out/errors.toml", "--json"}).out);
  EXPECT_EQ(json["errors_known"], 2);
  EXPECT_TRUE(json.contains("caution"));
  // What a simulation does not state is zero.
  EXPECT_THAT(abbe({"map", "--machine", "m.toml", "--errors", "out/truth.errors.toml"}).out,
              testing::Not(HasSubstr("caution")));
}

}  // namespace
}  // namespace abbe
