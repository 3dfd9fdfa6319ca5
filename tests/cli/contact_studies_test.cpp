#include "cli/instrument_study_test.h"

namespace abbe {
namespace {

class ContactStudies : public InstrumentStudies {
 protected:
  /// Runs the example, and once more from its files; residuals have to be noise.
  void expect_noise_only(const std::string& example, const std::string& name) {
    const nlohmann::json summary = expect_same_from_files(example, name);
    ASSERT_TRUE(summary.contains("status"));
    EXPECT_EQ(summary["status"], "converged");
    EXPECT_NEAR(summary["normalised_residual_rms"].get<double>(), 1, 0.15) << name;
  }
};

TEST_F(ContactStudies, AnRTestOnATrunnionMill) { expect_noise_only("trunnion", "r-test"); }
TEST_F(ContactStudies, ATouchProbeOnATrunnionMill) { expect_noise_only("trunnion", "touch-probe"); }
TEST_F(ContactStudies, DialsOnAThreeAxisMill) { expect_noise_only("three_axis", "dials"); }
TEST_F(ContactStudies, LevelAndAutocollimatorOnAThreeAxisMill) {
  expect_noise_only("three_axis", "level-and-autocollimator");
}
TEST_F(ContactStudies, AStandardCylinderOnBothStagesOfACradle) { expect_noise_only("cradle_scanner", "calibration"); }
TEST_F(ContactStudies, MarksOfALaserEngraver) { expect_noise_only("laser_engraver", "marks"); }

}  // namespace
}  // namespace abbe
