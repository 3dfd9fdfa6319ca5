#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/instrument_study_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// One simulated machine, identified; then asked about by every command that states its volumetric error.
class VolumetricFigures : public InstrumentStudies {
 protected:
  nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, done) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  static void expect_equal(const nlohmann::json& one, const nlohmann::json& other, const std::string& where) {
    ASSERT_TRUE(one.is_object()) << where;
    ASSERT_TRUE(other.is_object()) << where;
    EXPECT_EQ(one["poses"], other["poses"]) << where;
    EXPECT_EQ(one["description"], other["description"]) << where;
    for (const auto& [key, statistics] : one.items()) {
      if (!statistics.is_object()) continue;
      ASSERT_TRUE(other.contains(key)) << where << ": " << key;
      for (const auto& [figure, value] : statistics.items()) {
        const double expected = value.get<double>();
        EXPECT_NEAR(other[key][figure].get<double>(), expected, 1e-6 * std::abs(expected)) << where << ": " << key;
      }
    }
  }
};

TEST_F(VolumetricFigures, HaveTheSameNumbersUnderTheSameNamesInEveryCommand) {
  const std::string study = ABBE_SOURCE_DIR "/examples/three_axis/six-component-laser.study.toml";
  const nlohmann::json run = json_of({"run", study, "-o", "results"});
  const std::string machine = "results/machine.toml", errors = "results/errors.toml";
  const nlohmann::json map = json_of({"map", "--machine", machine, "--errors", errors});
  const nlohmann::json table = json_of({"compensate", "table", "--machine", machine, "--errors", errors, "--for",
                                        "siemens-cec", "--limit-um", "1000", "--dry-run"});
  const nlohmann::json verify = json_of({"verify", "results"});
  const nlohmann::json truth =
      json_of({"map", "--machine", machine, "--errors", "results/truth.errors.toml", "--minus", errors});
  const std::string predicted = "predicted_volumetric_error", known = "true_volumetric_error";
  expect_equal(run[predicted], map[predicted], "map");
  expect_equal(run[predicted], table[predicted], "table");
  // Close to the grid, not on it: tables are judged between their nodes.
  EXPECT_LT(table["volumetric_error_left_by_tables_um"]["mean"], table[predicted]["before_um"]["mean"]);
  expect_equal(run[predicted], verify[predicted], "verify");
  expect_equal(run[predicted], truth[predicted], "map of the truth");
  expect_equal(run[known], verify[known], "verify");
  expect_equal(run[known], truth[known], "map of the truth");
  EXPECT_FALSE(map.contains(known)) << "an identification is not the truth";
  // What is stated is right: the machine is known to within what is predicted to be left.
  EXPECT_LT(run[known]["after_um"]["mean"], run[predicted]["after_expanded_um"]["mean"]);
  EXPECT_GT(run[known]["after_um"]["mean"].get<double>(),
            0.1 * run[predicted]["after_expanded_um"]["mean"].get<double>());
  EXPECT_NEAR(run[known]["before_um"]["mean"].get<double>(), run[predicted]["before_um"]["mean"].get<double>(),
              run[predicted]["after_expanded_um"]["mean"].get<double>());
  // The random poses of both commands are the same ones, and so is what they say of them.
  const nlohmann::json &held_out = run["held_out"], &unseen = verify["unseen_poses"];
  EXPECT_THAT(held_out["description"].get<std::string>(), HasSubstr("(seed 79190)"));
  EXPECT_EQ(unseen["seed"], 79190);
  EXPECT_EQ(held_out["quantity"], unseen["quantity"]);
  EXPECT_EQ(held_out["poses"], unseen["poses"]);
  EXPECT_EQ(held_out["position_before_um"], unseen["position_before_um"]);
  EXPECT_NEAR(held_out["position_after_um"]["mean"], unseen["position_after_um"]["mean"],
              1e-3 * unseen["position_after_um"]["mean"].get<double>());
}

TEST_F(VolumetricFigures, AtRandomPosesHoldTheUncertaintyOfReversalValuesInBothCommands) {
  std::ifstream example(ABBE_SOURCE_DIR "/examples/three_axis/six-component-laser.study.toml");
  std::stringstream text;
  text << example.rdbuf();
  std::string study = text.str();
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"../machines", "\"" ABBE_SOURCE_DIR "/examples/machines"},
           {"mean_volumetric_um = 25", "mean_volumetric_um = 25\nreversal_um = 6"},
           {"held_out_fraction = 0.1", "reversals = [\"*\"]"}}) {
    const std::size_t at = study.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    study.replace(at, from.size(), to);
  }
  folder.write("reversal.study.toml", study);
  const nlohmann::json run = json_of({"run", "reversal.study.toml", "-o", "results"});
  const nlohmann::json verify = json_of({"verify", "results"});
  const nlohmann::json &held_out = run["held_out"], &unseen = verify["unseen_poses"];
  ASSERT_EQ(held_out["poses"], unseen["poses"]);
  const std::string predicted = "predicted_expanded_uncertainty_um";
  const double rms = unseen[predicted]["rms"];
  EXPECT_NEAR(held_out[predicted]["rms"].get<double>(), rms, 1e-4 * rms);
  EXPECT_NEAR(held_out["coverage_percent"].get<double>(), unseen["coverage_percent"].get<double>(), 0.5);
}

TEST_F(VolumetricFigures, OfMeasuredReadingsAreThosePredictedAndResidualsAreCalledResiduals) {
  expect_same_from_files("three_axis", "six-component-laser");
  const CommandResult text = abbe({"run", "measured.study.toml", "-o", "read"});
  ASSERT_EQ(text.exit_code, done) << text.err;
  const nlohmann::json summary = nlohmann::json::parse(folder.read("read/summary.json"));
  EXPECT_FALSE(summary.contains("true_volumetric_error"));
  EXPECT_THAT(summary["verdict"].get<std::string>(), StartsWith("Predicted volumetric error "));
  EXPECT_THAT(summary["verdict"].get<std::string>(), HasSubstr("times their stated uncertainties"));
  EXPECT_EQ(summary["held_out"]["quantity"], "residual of held-out readings");
  EXPECT_NEAR(summary["held_out"]["times_stated_uncertainty"].get<double>(), 1, 0.3);
  EXPECT_THAT(text.out, HasSubstr("residual of held-out readings"));
  EXPECT_THAT(text.out, HasSubstr("nominal machine, its set-up fitted again"));
  EXPECT_THAT(folder.read("read/report.html"), Not(HasSubstr("Volumetric error: ")));
}

TEST_F(VolumetricFigures, WithoutAFittedDatumIsCalledADisplacement) {
  const std::string machine = ABBE_SOURCE_DIR "/examples/machines/three-axis-mill.machine.toml";
  const std::string errors = ABBE_SOURCE_DIR "/examples/compensate/mill.errors.toml";
  const nlohmann::json kept = json_of({"map", "--machine", machine, "--errors", errors, "--keep-datum"});
  EXPECT_FALSE(kept.contains("predicted_volumetric_error"));
  const nlohmann::json fitted = json_of({"map", "--machine", machine, "--errors", errors});
  EXPECT_LT(fitted["predicted_volumetric_error"]["before_um"]["rms"].get<double>(),
            kept["displacement_before_um"]["rms"].get<double>());
  EXPECT_EQ(fitted, json_of({"map", "--machine", machine, "--errors", errors, "--fit-datum"}));
}

}  // namespace
}  // namespace abbe
