#include <gmock/gmock.h>

#include <cmath>

#include "cli/instrument_study_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class PolygonStudies : public InstrumentStudies {
 protected:
  /// Runs the example, and once more from its files; what is found must hold at poses that were not measured.
  /// @param share_left  largest part left of what the readings determine, root mean square, as a share of the error
  /// before
  void expect_found(const std::string& example, const std::string& name, double share_left) {
    const nlohmann::json summary = expect_same_from_files(example, name);
    ASSERT_TRUE(summary.contains("status"));
    EXPECT_EQ(summary["status"], "converged");
    EXPECT_NEAR(summary["normalised_residual_rms"].get<double>(), 1, 0.15);
    const nlohmann::json& held_out = summary["held_out"];
    EXPECT_EQ(held_out["reference"], "truth");
    const double before = held_out["position_before_um"]["rms"].get<double>();
    const double after = held_out["position_after_um"]["rms"].get<double>();
    // A prism does not see where the axis average line is in the bed; what that leaves open is told apart.
    ASSERT_TRUE(held_out.contains("not_determined_rms_um"));
    const double open = held_out["not_determined_rms_um"].get<double>();
    EXPECT_LT(open, 0.1 * before);
    EXPECT_LT(std::sqrt(after * after - open * open), share_left * before);
    // One campaign: the coordinates share a few dozen parameters, so its share scatters about 95 % (82 to 100 over
    // seeds).
    EXPECT_GT(held_out["coverage_percent"].get<double>(), 75);
  }
};

TEST_F(PolygonStudies, APrismOnARotaryTable) { expect_found("rotary_table", "polygon", 0.02); }

TEST_F(PolygonStudies, APrismWithOneAutocollimatorAndOneSensorStepByStep) {
  expect_found("rotary_table", "stepwise", 0.06);
}

TEST_F(PolygonStudies, APrismAndAnRTestOnATrunnionMill) { expect_found("trunnion", "polygon-and-r-test", 0.03); }

TEST_F(PolygonStudies, APositionBetweenTheFacesIsSaid) {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/examples/rotary_table/polygon.study.toml"));
  std::stringstream text;
  text << file.rdbuf();
  std::string study = text.str();
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(study.find(from), std::string::npos) << from;
    study.replace(study.find(from), from.size(), to);
  };
  const std::string source = ABBE_SOURCE_DIR;
  replace("../machines/", source + "/examples/machines/");
  replace("table.errors.toml", source + "/examples/rotary_table/table.errors.toml");
  replace("count = 12", "count = 23");
  folder.write("s.study.toml", study);
  const CommandResult result = abbe({"run", "s.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err,
              HasSubstr("first: the nearest face looks 15 deg aside of the sensors, expected a face every 30"));
}

}  // namespace
}  // namespace abbe
