#include <gmock/gmock.h>

#include <filesystem>

#include "cli/instrument_study_test.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ErrorsNotIdentified : public InstrumentStudies {
 protected:
  static std::string example(const std::string& name) {
    return std::string(ABBE_SOURCE_DIR "/examples/") + name + ".study.toml";
  }
  static std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }
  nlohmann::json summary_in(const std::string& results) const {
    return nlohmann::json::parse(text_of(folder.path() / results / "summary.json"), nullptr, false);
  }
};

TEST_F(ErrorsNotIdentified, AreNamedWhereTheVolumetricErrorStands) {
  const CommandResult run = abbe({"run", example("three_axis/dials"), "-o", "results"});
  ASSERT_EQ(run.exit_code, done) << run.err;
  EXPECT_THAT(run.out, HasSubstr("of the identified errors only"));
  EXPECT_THAT(run.out, HasSubstr("warning: not identified: EXX, EYX, ECX, all six error motions of Y,"));
  EXPECT_THAT(run.out, HasSubstr("a laser interferometer along X"));
  const nlohmann::json summary = summary_in("results");
  ASSERT_TRUE(summary.contains("not_identified"));
  const nlohmann::json& missing = summary["not_identified"];
  EXPECT_THAT(missing["errors"], Contains("EXY"));
  EXPECT_THAT(missing["errors"], Not(Contains("EZX"))) << "it is identified";
  EXPECT_EQ(summary["held_out"]["uncertainty_covers"], "identified errors only");
  EXPECT_EQ(summary["map"]["uncertainty_covers"], "identified errors only");
  // What the readings do not see at all is nearly all of the error after.
  const double after = summary["held_out"]["position_after_um"]["rms"];
  EXPECT_NEAR(missing["true_effect_um"].get<double>(), after, 0.15 * after);
  const std::string page = text_of(folder.path() / "results" / "report.html");
  EXPECT_THAT(page, HasSubstr("Not identified and taken as zero: EXX"));
}

TEST_F(ErrorsNotIdentified, AreNamedForMeasuredReadingsToo) {
  expect_same_from_files("three_axis", "level-and-autocollimator");
  const nlohmann::json summary = summary_in("read");
  ASSERT_TRUE(summary.contains("not_identified"));
  EXPECT_FALSE(summary["not_identified"].contains("true_effect_um"));
  EXPECT_GT(summary["not_identified"]["usual_size_effect_um"].get<double>(), 10);
  EXPECT_EQ(summary["map"]["uncertainty_covers"], "identified errors only");
}

TEST_F(ErrorsNotIdentified, AreNoneWhereEverythingIsIdentified) {
  const CommandResult run = abbe({"run", example("three_axis/six-component-laser"), "-o", "results"});
  ASSERT_EQ(run.exit_code, done) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("identified errors only")));
  EXPECT_FALSE(summary_in("results").contains("not_identified"));
}

TEST_F(ErrorsNotIdentified, ResidualsThatTheStatedNoiseDoesNotExplainAreWarnedOf) {
  const CommandResult first = abbe({"run", example("three_axis/dials"), "-o", "simulated"});
  ASSERT_EQ(first.exit_code, done) << first.err;
  std::string study = measured_study(text_of(example("three_axis/dials")), "simulated/readings");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = study.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    study.replace(at, from.size(), to);
  };
  replace("machine = \"../", "machine = \"" + std::string(ABBE_SOURCE_DIR "/examples/"));
  folder.write("right.study.toml", study);
  EXPECT_THAT(abbe({"run", "right.study.toml", "-o", "right"}).out, Not(HasSubstr("the residuals are")));
  replace("indication_um = 0.3, flatness_um = 0.3", "indication_um = 0.1, flatness_um = 0.1");
  folder.write("wrong.study.toml", study);
  EXPECT_THAT(abbe({"run", "wrong.study.toml", "-o", "wrong"}).out, HasSubstr("the residuals are"));
}

TEST_F(ErrorsNotIdentified, ADialAlongItsFaceIsNamedWithThePose) {
  std::string study = text_of(example("three_axis/dials"));
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = study.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    study.replace(at, from.size(), to);
  };
  const std::string examples = std::string(ABBE_SOURCE_DIR "/examples/");
  replace("machine = \"../", "machine = \"" + examples);
  replace("errors = \"x-axis", "errors = \"" + examples + "three_axis/x-axis");
  replace("direction = [0, 0, 1]", "direction = [1, 0, 0]");
  folder.write("along.study.toml", study);
  const CommandResult run = abbe({"run", "along.study.toml", "-o", "results"});
  EXPECT_EQ(run.exit_code, bad_input);
  EXPECT_THAT(run.err, HasSubstr("dials: z1: reads nothing at X = "));
}

}  // namespace
}  // namespace abbe
