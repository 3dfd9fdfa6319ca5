#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/linkage_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/identify/linkage/linkage_errors.h"
#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

constexpr double kLinkageExitToAxis = 120, kLinkageBoard = 4;  // mm

/// `abbe evaluate linkage`.
class EvaluateLinkage : public EvaluateTest {
 protected:
  static std::string machine_file(LinkageConvention convention) {
    const bool table = convention == LinkageConvention::table_moves;
    return std::string(ABBE_SOURCE_DIR "/examples/machines/yin-engraver-") + (table ? "u" : "p") + ".machine.toml";
  }
  /// The errors that the readings come from.
  static ErrorSet truth(const Machine& machine) {
    return linkage_errors(machine, linkage_convention_of(machine),
                          SwingHeadLinkage{240.79, 209.45, -0.25, -0.16, {-197.214, 25.291, -529.02}},
                          Eigen::MatrixXd::Zero(7, 7))
        .errors;
  }
  /// Readings of the five steps on that machine, with the noise of Table 1 times a factor.
  std::string readings(LinkageConvention convention, double noise, std::uint64_t seed) const {
    const Machine machine = read_machine(machine_file(convention));
    const SwingHeadLinkage actual = linkage_of(calibrated_machine(machine, truth(machine)).machine, convention);
    const LinkageReadings commands =
        linkage_commands(linkage_of(machine, convention), convention, kLinkageExitToAxis, kLinkageBoard);
    RandomStream random(seed);
    std::vector<double> deviations;
    for (const LinkageDisturbance& cause : linkage_disturbances(commands, LinkageAccuracy::published())) {
      deviations.push_back(noise * cause.standard_uncertainty * random.normal());
    }
    return folder.write("steps.csv", linkage_text(simulate_linkage(actual, commands, 0.03, 0.05, deviations))).string();
  }
  static std::vector<std::string> arguments(const std::string& file, LinkageConvention convention) {
    return {"linkage", file, "--machine", machine_file(convention), "--exit-to-axis-mm", "120", "--board-mm", "4"};
  }
  static std::vector<std::string> with_accuracy(std::vector<std::string> arguments) {
    for (const char* text :
         {"--u-x-um",      "2.77", "--u-y-um",      "1.55", "--u-z-um",          "3.55", "--u-a-arcsec",       "1.7",
          "--u-c1-arcsec", "2.4",  "--u-c2-arcsec", "8.3",  "--u-zero-a-arcsec", "1.7",  "--u-zero-c1-arcsec", "2.4",
          "--u-mark-um",   "2",    "--u-width-um",  "2"}) {
      arguments.emplace_back(text);
    }
    return arguments;
  }
};

TEST_F(EvaluateLinkage, ReadingsWithoutNoiseGiveTheErrorsBackInBothConventions) {
  for (const LinkageConvention convention : {LinkageConvention::table_moves, LinkageConvention::head_moves}) {
    const nlohmann::json found = json(arguments(readings(convention, 0, 1), convention))["figures"];
    EXPECT_NEAR(found["R_A"]["value_mm"].get<double>(), 240.79, 1e-8);
    EXPECT_NEAR(found["z0"]["value_mm"].get<double>(), -529.02, 1e-8);
    const Machine machine = read_machine(machine_file(convention));
    const ErrorSet errors = truth(machine);
    const std::vector<std::string> names = parameter_names(machine, errors);
    for (std::size_t i = 0; i < names.size(); ++i) {
      EXPECT_NEAR(found[names[i]]["value_um"].get<double>(), 1e3 * errors.parameters()[i], 1e-5) << names[i];
      EXPECT_EQ(found[names[i]].count("expanded_uncertainty_um"), 0U);  // none was stated
    }
  }
}

TEST_F(EvaluateLinkage, NoisyReadingsGiveTheErrorsWithinTheirUncertaintyAndAnErrorsFileThatOthersRead) {
  const LinkageConvention convention = LinkageConvention::table_moves;
  const Machine machine = read_machine(machine_file(convention));
  const ErrorSet errors = truth(machine);
  const std::vector<std::string> names = parameter_names(machine, errors);
  double squares = 0;
  constexpr int kCampaigns = 6;
  for (int campaign = 1; campaign <= kCampaigns; ++campaign) {
    std::vector<std::string> all =
        with_accuracy(arguments(readings(convention, 1, static_cast<std::uint64_t>(campaign)), convention));
    all.insert(all.end(), {"-o", "found"});
    const nlohmann::json found = json(all)["figures"];
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double off = found[names[i]]["value_um"].get<double>() - 1e3 * errors.parameters()[i];
      squares += std::pow(2 * off / found[names[i]]["expanded_uncertainty_um"].get<double>(), 2);
    }
  }
  EXPECT_NEAR(squares / (kCampaigns * 7.0), 1, 0.8);  // correlated: fewer than 42 degrees of freedom
  const ErrorsFile file = read_errors((folder.path() / "found/errors.toml").string(), machine);
  EXPECT_EQ(parameter_names(machine, file.errors), names);
  EXPECT_EQ(file.covariance.rows(), 7);
  EXPECT_EQ(
      abbe({"map", "--machine", machine_file(convention), "--errors", "found/errors.toml", "--grid", "X_mm=0:10:2",
            "--grid", "Y_mm=0", "--grid", "Z_mm=0", "--grid", "A_deg=0", "--grid", "C1_deg=0", "--grid", "C2_deg=0"})
          .exit_code,
      ExitCode::done);
  EXPECT_THAT(folder.read("found/report.html"), HasSubstr("EX0C1"));
  EXPECT_THAT(folder.read("found/plot.svg"), HasSubstr("<svg"));
}

TEST_F(EvaluateLinkage, WhatCannotBeIsRefusedWithFileAndField) {
  const std::string file = readings(LinkageConvention::table_moves, 0, 1);
  // The table turned the other way round than the angles say.
  LinkageReadings reversed = read_linkage(file);
  for (double& angle : reversed.table_angle) angle = -angle;
  const std::string other = folder.write("reversed.csv", linkage_text(reversed)).string();
  expect_refused(arguments(other, LinkageConvention::table_moves),
                 other +
                     ": turn: the marks of the circle run opposite to the stated angles: their sign is wrong; expected "
                     "turn_deg: the angle by which the focus has turned about the axis of the table, seen from the "
                     "board, counter-clockwise from above, at two angles or more");
  std::vector<std::string> wrong = arguments(file, LinkageConvention::table_moves);
  wrong.insert(wrong.end(), {"--convention", "head-moves"});
  expect_refused(wrong,
                 "--convention head-moves: is not what the machine's chain says; expected table-moves, or without it");
  std::vector<std::string> lathe = arguments(file, LinkageConvention::table_moves);
  lathe[3] = std::string(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  expect_refused(lathe, lathe[3] +
                            ": the machine has no axis C1; expected axes X, Y, Z and a swing head C1, A, as in "
                            "examples/machines/yin-engraver-u.machine.toml");
  const CommandResult exact = abbe({"evaluate", "linkage", file, "--exit-to-axis-mm", "120", "--board-mm", "4"});
  EXPECT_EQ(exact.exit_code, ExitCode::done) << exact.err;
  EXPECT_THAT(exact.out, HasSubstr("Not stated, taken as exact: --u-x-um"));
}

}  // namespace
}  // namespace abbe
