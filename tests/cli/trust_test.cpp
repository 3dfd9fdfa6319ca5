// A result that must not be trusted does not look like a good one: exit code, standard error, files, and what the
// commands that use errors do with it.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kTrustTruth = R"(chain = "w X' b Z t"
[[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 30, 20]
[[motion]]
name = "EZX"
basis = "legendre"
order = 2
coefficients_um = [0, 0, -25]
[[motion]]
name = "EZZ"
basis = "legendre"
order = 2
coefficients_um = [0, -20, 15]
)";

const std::string kTrustSetup = std::string(R"([[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 5 }
[[setup.station]]
name = "S"
pose = "find"
true_pose = { position_mm = [300, -900, 150], angles_deg = [5, -3, 130] }
)") + kThreeReflectors;

constexpr const char* kTrustPlan = "[[setup.plan]]\nkind = \"grid\"\naxis.X = { count = 12 }\naxis.Z = { count = 6 }\n";

constexpr const char* kTrustIdentify = R"([identify]
held_out_fraction = 0.2
[[identify.motion]]
errors = ["E?X", "E?Z"]
basis = "legendre"
order = 2
)";

class TrustOfResults : public CommandTest {
 protected:
  TrustOfResults() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write("truth.errors.toml", kTrustTruth);
  }

  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  }

  /// Readings of the true machine in simulated/readings/tracker.csv. @param setup  as it really is
  void measure(const std::string& setup = kTrustSetup) const {
    folder.write("simulated.study.toml",
                 "machine = \"m.toml\"\noutput = \"simulated\"\n[simulate]\nerrors = \"truth."
                 "errors.toml\"\n" +
                     replaced(setup, "pose = \"find\"\n", "") + kTrustPlan);
    ASSERT_EQ(abbe({"run", "simulated.study.toml"}).exit_code, done);
  }

  /// The study of those readings. @param setup  as its user states it
  void write_study(const std::string& setup = kTrustSetup, const std::string& identify = kTrustIdentify) const {
    folder.write("s.study.toml", "machine = \"m.toml\"\noutput = \"out\"\n" +
                                     replaced(setup,
                                              "true_pose = { position_mm = [300, -900, 150], angles_deg = [5, -3, "
                                              "130] }\n",
                                              "") +
                                     "[[setup.data]]\nfile = \"simulated/readings/tracker.csv\"\n" + identify);
  }

  nlohmann::json summary() const { return nlohmann::json::parse(folder.read("out/summary.json")); }
};

TEST_F(TrustOfResults, AGoodOneIsTrusted) {
  measure();
  write_study();
  const CommandResult run = abbe({"run", "s.study.toml"});
  EXPECT_EQ(run.exit_code, done) << run.err << run.out;
  EXPECT_THAT(run.err, Not(HasSubstr("trusted")));
  EXPECT_EQ(summary()["trusted"], true);
  EXPECT_FALSE(summary().contains("distrusted"));
  EXPECT_THAT(folder.read("out/errors.toml"), Not(HasSubstr("distrusted")));
  EXPECT_EQ(abbe({"compensate", "freeze", "--machine", "m.toml", "--errors", "out/errors.toml", "--dry-run"})
                .err.find("trusted"),
            std::string::npos);
}

TEST_F(TrustOfResults, AReflectorOneMillimetreOffIsRefusedEverywhere) {
  measure(replaced(kTrustSetup, "offset_mm = [60, 0, -150]", "offset_mm = [61, 0, -150]"));
  write_study();
  const CommandResult run = abbe({"run", "s.study.toml"});
  EXPECT_EQ(run.exit_code, computation_says_no) << run.out;
  EXPECT_THAT(run.err, AllOf(HasSubstr("abbe: not to be trusted: the residuals are"), HasSubstr("--accept-misfit")));
  EXPECT_THAT(run.out, HasSubstr("\nNot to be trusted (misfit"));
  // The readings say what is wrong, in their columns of offsets.
  EXPECT_THAT(run.out, HasSubstr("tracker: the offset of reflector R1 is (61, 0, -150) mm in "));
  EXPECT_EQ(summary()["trusted"], false);
  EXPECT_EQ(summary()["misfit_accepted"], false);
  EXPECT_EQ(summary()["distrusted"][0]["kind"], "misfit");
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Not to be trusted: the residuals are"));
  EXPECT_THAT(folder.read("out/errors.toml"), HasSubstr("distrusted = [\n  \"the residuals are"));
  EXPECT_EQ(abbe({"identify", "s.study.toml", "-o", "i.errors.toml"}).exit_code, computation_says_no);
  EXPECT_THAT(folder.read("i.errors.toml"), HasSubstr("distrusted = [\n"));

  folder.write("p.csv", "X_mm,Z_mm\n100,100\n");
  folder.write("p.ngc", "G21 G90 G0 X0 Z0\nG1 F100 X100 Z100\nM2\n");
  const std::vector<std::vector<std::string>> uses = {
      {"compensate", "freeze", "--machine", "m.toml", "--errors", "out/errors.toml", "-o", "m.abbec"},
      {"compensate", "poses", "p.csv", "--machine", "m.toml", "--errors", "out/errors.toml", "-o", "c.csv"},
      {"compensate", "table", "--machine", "m.toml", "--errors", "out/errors.toml", "--for", "linuxcnc", "-o", "comp"},
      {"compensate", "gcode", "p.ngc", "--machine", "m.toml", "--errors", "out/errors.toml", "-o", "c.ngc"}};
  for (std::vector<std::string> use : uses) {
    const CommandResult refused = abbe(use);
    EXPECT_EQ(refused.exit_code, bad_input) << use[1] << refused.out;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("out/errors.toml: distrusted: the identification marked these errors"),
                                   HasSubstr("--accept-misfit")))
        << use[1];
    use.emplace_back("--accept-misfit");
    const CommandResult accepted = abbe(use);
    EXPECT_NE(accepted.exit_code, bad_input) << use[1] << accepted.err;
    EXPECT_THAT(accepted.err, HasSubstr("used although marked as not to be trusted")) << use[1];
  }
  const CommandResult map = abbe({"map", "--machine", "m.toml", "--errors", "out/errors.toml"});
  EXPECT_EQ(map.exit_code, done);
  EXPECT_THAT(map.err, HasSubstr("marked as not to be trusted"));
}

TEST_F(TrustOfResults, AcceptedItIsUsedButStaysMarked) {
  measure(replaced(kTrustSetup, "offset_mm = [60, 0, -150]", "offset_mm = [61, 0, -150]"));
  write_study();
  const CommandResult run = abbe({"run", "s.study.toml", "--accept-misfit"});
  EXPECT_EQ(run.exit_code, done) << run.err;
  EXPECT_THAT(run.err, HasSubstr("accepted by --accept-misfit"));
  EXPECT_THAT(run.out, HasSubstr("Accepted despite doubts (misfit"));
  EXPECT_EQ(summary()["trusted"], false);
  EXPECT_EQ(summary()["misfit_accepted"], true);
  EXPECT_THAT(folder.read("out/errors.toml"), HasSubstr("misfit_accepted = true\n"));
  const CommandResult freeze =
      abbe({"compensate", "freeze", "--machine", "m.toml", "--errors", "out/errors.toml", "--dry-run"});
  EXPECT_NE(freeze.exit_code, bad_input) << freeze.err;
  EXPECT_THAT(freeze.err, HasSubstr("used although marked"));
}

TEST_F(TrustOfResults, ErrorsThatMakeHeldOutPosesWorseAreRefused) {
  // The stated noise hides the misfit; the readings held out are of a machine with the opposite errors.
  measure();
  std::filesystem::rename(folder.path() / "simulated", folder.path() / "measured");
  std::string mirrored = kTrustTruth;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"[0, 30, 20]", "[0, -30, -20]"}, {"[0, 0, -25]", "[0, 0, 25]"}, {"[0, -20, 15]", "[0, 20, -15]"}}) {
    mirrored = replaced(mirrored, from, to);
  }
  folder.write("truth.errors.toml", mirrored);
  measure();
  write_study(
      replaced(kTrustSetup, "xyz_um = 5", "xyz_um = 1000"),
      replaced(kTrustIdentify, "held_out_fraction = 0.2", "held_out_file = \"simulated/readings/tracker.csv\""));
  folder.write("s.study.toml", replaced(folder.read("s.study.toml"), "[[setup.data]]\nfile = \"simulated",
                                        "[[setup.data]]\nfile = \"measured"));
  const CommandResult run = abbe({"run", "s.study.toml", "--json"});
  const nlohmann::json figures = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(figures.is_object()) << run.err;
  const double before = figures["held_out"]["position_before_um"]["rms"];
  const double after = figures["held_out"]["position_after_um"]["rms"];
  ASSERT_GT(after, before);
  EXPECT_EQ(run.exit_code, computation_says_no) << run.err;
  EXPECT_EQ(figures["distrusted"][0]["kind"], "worse held out");
  EXPECT_NEAR(figures["distrusted"][0]["rms_before_um"].get<double>(), before, 1e-6 * before);
  EXPECT_NEAR(figures["distrusted"][0]["rms_after_um"].get<double>(), after, 1e-6 * after);
}

TEST_F(TrustOfResults, ACorrectionThatImprovesNothingIsRefused) {
  folder.write("truth.errors.toml", "chain = \"w X' b Z t\"\n");
  measure();
  write_study();
  const CommandResult run = abbe({"run", "s.study.toml", "--json"});
  EXPECT_EQ(run.exit_code, computation_says_no) << run.err;
  EXPECT_THAT(run.err, HasSubstr("so the correction shows no improvement"));
  const nlohmann::json figures = nlohmann::json::parse(run.out);
  ASSERT_GT(figures["held_out"]["position_after_um"]["rms"], figures["held_out"]["position_before_um"]["rms"]);
  EXPECT_EQ(figures["trusted"], false);
  EXPECT_EQ(figures["distrusted"][0]["kind"], "no improvement");
  EXPECT_EQ(abbe({"run", "s.study.toml", "--accept-misfit"}).exit_code, done);
}

TEST_F(TrustOfResults, WarningsStandInEveryFile) {
  measure();
  write_study(replaced(kTrustSetup, "xyz_um = 5", "xyz_um = 50"));
  const CommandResult run = abbe({"run", "s.study.toml"});
  EXPECT_EQ(run.exit_code, done) << run.err;
  EXPECT_THAT(run.out, HasSubstr("warning: the residuals are only 0.09"));
  EXPECT_THAT(summary()["warnings"], Contains(HasSubstr("the residuals are only 0.09")));
  EXPECT_THAT(folder.read("out/errors.toml"), HasSubstr("warnings = [\n  \"the residuals are only 0.09"));
}

TEST_F(TrustOfResults, ARegionThatARobustLossThrowsOutIsRefused) {
  measure();
  // Every reading beyond X = 1100 mm is a tenth of a millimetre off.
  std::string shifted;
  std::istringstream lines(folder.read("simulated/readings/tracker.csv"));
  std::vector<std::string> header;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream of_line(line);
    for (std::string cell; std::getline(of_line, cell, ',');) cells.push_back(cell);
    if (header.empty() && line.find("X_mm") != std::string::npos) {
      header = cells;
    } else if (!header.empty()) {
      const auto column = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
      };
      const std::size_t x = column("X_mm"), measured = column("measured_x_mm");
      ASSERT_LT(std::max(x, measured), cells.size()) << line;
      if (std::stod(cells[x]) > 1100) cells[measured] = std::to_string(std::stod(cells[measured]) + 0.1);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) shifted += (i > 0 ? "," : "") + cells[i];
    shifted += "\n";
  }
  folder.write("simulated/readings/tracker.csv", shifted);
  write_study(kTrustSetup, replaced(kTrustIdentify, "[identify]", "[identify]\nloss = \"tukey\""));
  const CommandResult run = abbe({"run", "s.study.toml"});
  EXPECT_EQ(run.exit_code, computation_says_no) << run.out;
  EXPECT_THAT(summary()["distrusted"].dump(), HasSubstr("\"kind\":\"region left out\""));
  EXPECT_THAT(run.err,
              testing::ContainsRegex("of the [0-9]+ readings with X from 1[0-9.]+ to 1[0-9.]+ mm are outliers"));
}

TEST_F(TrustOfResults, RowsThatStandTwiceAreToldOf) {
  measure();
  write_study();
  const std::string study = folder.read("s.study.toml");
  const std::string data = "[[setup.data]]\nfile = \"simulated/readings/tracker.csv\"\n";
  folder.write("s.study.toml", replaced(study, data, data + data));
  const CommandResult run = abbe({"run", "s.study.toml"});
  EXPECT_EQ(run.exit_code, done) << run.err;
  EXPECT_THAT(run.out, HasSubstr("216 of 216 pairs of readings at the same pose agree to the last digit"));
  EXPECT_THAT(summary()["warnings"], Contains(HasSubstr("duplicate rows")));
}

}  // namespace
}  // namespace abbe
