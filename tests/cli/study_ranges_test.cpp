// Over which positions of the axes the errors of a study are stated, and what is said of poses beyond.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kRandomStudy = std::string(R"(name = "random"
machine = "m.toml"
seed = 7
output = "out"
[simulate.generator]
seed = 5
mean_volumetric_um = 300
linear_order = 3
location_errors = false
[[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 5 }
[[setup.station]]
name = "S"
true_pose = { position_mm = [300, -900, 150], angles_deg = [5, -3, 130] }
)") + kThreeReflectors + R"([[setup.plan]]
kind = "random"
points = 400
axis.X = {}
axis.Z = {}
[identify]
[[identify.motion]]
errors = ["E?X", "E?Z"]
basis = "legendre"
order = 3
[map]
poses = "poses.csv"
[report]
page = false
)";

class StudyRanges : public CommandTest {
 protected:
  StudyRanges() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write("poses.csv", "X_mm,Z_mm\n0,0\n700,300\n1400,600\n200,500\n1200,100\n900,450\n");
  }
  void write_study(const std::string& from = "", const std::string& to = "") const {
    std::string text = kRandomStudy;
    if (!from.empty()) {
      ASSERT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    }
    folder.write("s.study.toml", text);
  }
};

TEST_F(StudyRanges, ErrorsAreStatedUpToTheEndOfTheTravelWithinTheMargin) {
  write_study();
  const CommandResult result = abbe({"run", "s.study.toml", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  const nlohmann::json& x = summary["ranges"][0];
  EXPECT_EQ(x["axis"], "X");
  EXPECT_EQ(x["stated_mm"], nlohmann::json::parse("[0.0, 1400.0]"));
  EXPECT_GT(x["measured_mm"][0], 0);
  EXPECT_LT(x["measured_mm"][1], 1400);
  EXPECT_EQ(x["margin_percent"], 2);
  EXPECT_GT(x["expanded_uncertainty_at_end_um"], 0);
  EXPECT_EQ(summary["map"]["poses"], 6);
  // The prediction at the end is as good as it says.
  EXPECT_LT(summary["map"]["position_after_um"]["max"],
            2 * summary["map"]["predicted_expanded_uncertainty_um"]["max"].get<double>());
  const CommandResult text = abbe({"run", "s.study.toml"});
  EXPECT_THAT(text.out, HasSubstr("are stated for 0 to 1400 mm: the gap is within 2 % of the measured range"));
  // What follows from the results works at the ends too.
  folder.write("p.ngc", "G21 G90 G94 F500\nG0 X0 Z0\nG1 X1400 Z300\nM2\n");
  const CommandResult program =
      abbe({"compensate", "gcode", "p.ngc", "--machine", "m.toml", "--errors", "out/errors.toml", "-o", "q.ngc",
            "--allow", "outside-travel", "--allow", "position-left", "--allow", "not-proven"});
  EXPECT_EQ(program.exit_code, ExitCode::done) << program.err;
  EXPECT_THAT(program.err, Not(HasSubstr("outside the range over which"))) << program.err;
}

TEST_F(StudyRanges, WithoutAMarginPosesAtTheEndsAreLeftOutAndTheExitCodeSaysSo) {
  write_study("[identify]\n", "[identify]\ncoverage_margin_percent = 0\n");
  const CommandResult result = abbe({"run", "s.study.toml", "--json"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("2 of 6 poses of the map lie outside the range in which the errors are known"));
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  EXPECT_EQ(summary["ranges"][0]["stated_mm"], summary["ranges"][0]["measured_mm"]);
  EXPECT_EQ(summary["map"]["outside_range"], 2);
  EXPECT_EQ(summary["map"]["ranges"][0]["axis"], "X");
  EXPECT_FALSE(summary["map"]["ranges"][0].contains("positions")) << "a list of poses";
  EXPECT_EQ(abbe({"run", "s.study.toml", "--accept-uncovered"}).exit_code, ExitCode::done);
  const std::vector<std::string> map = {"map",     "--machine", "m.toml", "--errors", "out/errors.toml",
                                        "--poses", "poses.csv"};
  EXPECT_EQ(abbe(map).exit_code, ExitCode::computation_says_no);
  std::vector<std::string> accepted = map;
  accepted.emplace_back("--accept-uncovered");
  EXPECT_EQ(abbe(accepted).exit_code, ExitCode::done);
}

TEST_F(StudyRanges, AWideGapIsNoEndOfARange) {
  write_study("axis.X = {}", "axis.X = { range_mm = [60, 1400] }");
  const nlohmann::json summary = nlohmann::json::parse(abbe({"run", "s.study.toml", "--json"}).out);
  EXPECT_GE(summary["ranges"][0]["stated_mm"][0], 60);
  EXPECT_EQ(summary["ranges"][0]["stated_mm"][1], 1400);
  write_study("[identify]\n", "[identify]\ncoverage_margin_percent = 30\n");
  const CommandResult refused = abbe({"run", "s.study.toml"});
  EXPECT_EQ(refused.exit_code, ExitCode::bad_input);
  EXPECT_THAT(refused.err, HasSubstr("a percentage of the measured range from 0 to 10"));
}

}  // namespace
}  // namespace abbe
