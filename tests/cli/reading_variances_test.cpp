// Studies that estimate the variances of their readings.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "abbe/errors/random_stream.h"
#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kSetup = R"([[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 5 }
)";
const char* const kIdentify = R"([[identify.motion]]
errors = "E?X"
basis = "legendre"
order = 2
[[identify.motion]]
errors = "E?Z"
basis = "legendre"
order = 2
)";

class ReadingVariances : public CommandTest {
 protected:
  ReadingVariances() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write(
        "simulated.study.toml",
        fmt::format("machine = \"m.toml\"\noutput = \"simulated\"\n[simulate.generator]\n"
                    "seed = 3\nlinear_order = 2\nmean_volumetric_um = 300\n"
                    "{}[[setup.station]]\nname = \"S\"\n"
                    "true_pose = {{ position_mm = [300, -900, 150], angles_deg = [5, -3, 130] }}\n"
                    "{}[[setup.plan]]\nkind = \"grid\"\naxis.X = {{ count = 16 }}\naxis.Z = {{ count = 12 }}\n",
                    kSetup, kThreeReflectors));
  }

  /// Simulated readings, with a displacement of every pose added; of all three reflectors, or of one, another at each
  /// pose.
  void measure(double pose_noise_mm, int reflectors) const {
    const CommandResult simulated = abbe({"run", "simulated.study.toml"});
    ASSERT_EQ(simulated.exit_code, ExitCode::done) << simulated.err;
    std::istringstream lines(folder.read("simulated/readings/tracker.csv"));
    std::string header, line, text;
    std::getline(lines, header);
    while (header.starts_with("#")) std::getline(lines, header);
    std::size_t first = 0;
    for (const char c : header.substr(0, header.find("measured_x_mm"))) first += c == ',' ? 1U : 0U;
    RandomStream random(11);
    std::string pose;
    int poses = 0;
    double displaced[3] = {0, 0, 0};
    text = header + "\n";
    while (std::getline(lines, line)) {
      std::vector<std::string> fields;
      std::istringstream parts(line);
      for (std::string field; std::getline(parts, field, ',');) fields.push_back(field);
      if (fields[0] + "," + fields[1] != pose) {
        pose = fields[0] + "," + fields[1];
        ++poses;
        for (double& value : displaced) value = pose_noise_mm * random.normal();
      }
      for (std::size_t i = 0; i < 3; ++i)
        fields[first + i] = fmt::format("{:.6f}", std::stod(fields[first + i]) + displaced[i]);
      if (reflectors == 1 && line.find("R" + std::to_string(1 + poses % 3)) == std::string::npos) continue;
      for (std::size_t i = 0; i < fields.size(); ++i) text += (i > 0 ? "," : "") + fields[i];
      text += "\n";
    }
    folder.write("measured.csv", text);
  }

  void write_study(const std::string& options) const {
    folder.write(
        "s.study.toml",
        fmt::format("machine = \"m.toml\"\noutput = \"out\"\n{}[[setup.station]]\nname = \"S\"\npose = "
                    "\"find\"\n{}[[setup.data]]\nfile = \"measured.csv\"\n[identify]\nheld_out_fraction = 0.3\n"
                    "{}\n{}",
                    kSetup, kThreeReflectors, options, kIdentify));
  }
};

TEST_F(ReadingVariances, PoseNoiseIsFoundAndHeldOutReadingsAreCovered) {
  measure(0.02, 3);
  write_study("variance_factor = \"estimated\"\npose_noise = \"estimated\"");
  const CommandResult result = abbe({"run", "s.study.toml"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err << result.out;
  const nlohmann::json summary = nlohmann::json::parse(folder.read("out/summary.json"));
  const nlohmann::json& variances = summary["reading_variances"];
  EXPECT_NEAR(variances["pose_noise_um"], 20, 3 * variances["pose_noise_standard_uncertainty_um"].get<double>());
  EXPECT_NEAR(variances["variance_factor"], 1, 3 * variances["variance_factor_standard_uncertainty"].get<double>());
  EXPECT_LT(variances["stated_chi_square_probability"], 1e-6);
  EXPECT_EQ(variances["chi_square_is_a_test"], false);
  const nlohmann::json& coverage = summary["held_out"]["reading_coverage"];
  EXPECT_GT(coverage["readings"], 100);
  EXPECT_NEAR(coverage["components_within_percent"], 95, 4);
  EXPECT_NEAR(coverage["readings_within_percent"], 95, 6);
  EXPECT_THAT(result.out, HasSubstr("pose noise "));
  EXPECT_THAT(result.out, HasSubstr("is not a test"));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Pose noise (a displacement common"));
}

TEST_F(ReadingVariances, AreAsStatedUnlessTheStudyAsksForMore) {
  measure(0, 3);
  write_study("");
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  const std::string plain = folder.read("out/summary.json");
  EXPECT_THAT(plain, Not(HasSubstr("reading_variances")));
  write_study("variance_factor = \"stated\"\npose_noise = \"none\"");
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  EXPECT_EQ(folder.read("out/summary.json"), plain);
}

TEST_F(ReadingVariances, OneReflectorAtEachPoseIsNotEnoughForBoth) {
  measure(0.02, 1);
  write_study("variance_factor = \"estimated\"\npose_noise = \"estimated\"");
  const CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("do not tell the variance factor from the pose noise"));
}

TEST_F(ReadingVariances, RobustLossesAndStrategiesInTwoStepsAreRefused) {
  folder.write("measured.csv", "");
  write_study("pose_noise = \"estimated\"\nloss = \"huber\"");
  CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("identify.pose_noise: is estimated from sums of squares"));
  write_study("variance_factor = \"estimated\"\nstrategy = \"combined\"");
  result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("identify.variance_factor: is estimated together with all parameters"));
  write_study("pose_noise = \"10\"");
  result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("expected \"none\" or \"estimated\""));
}

}  // namespace
}  // namespace abbe
