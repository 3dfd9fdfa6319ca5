#include "abbe/study/verification/verified_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// The campaign of March and the errors that were identified from it.
ReadingsToVerify march() {
  ReadingsToVerify request;
  request.study = read_study(test::example_file("compare/campaign.study.toml"));
  request.errors_file = test::example_file("compare/march.errors.toml");
  request.identified = read_errors(request.errors_file, request.study.machine);
  return request;
}

TEST(VerifiedReadings, OfAnUnchangedMachineAreExplained) {
  double chi_square = 0, degrees = 0;
  std::size_t components = 0, within = 0;
  for (std::uint64_t seed = 101; seed < 121; ++seed) {
    ReadingsToVerify request = march();
    request.study.seed = seed;
    const VerifiedReadings result = verify_readings(request);
    EXPECT_FALSE(result.says_no()) << evaluation_text(result.report);
    EXPECT_GT(result.reduction(), 2);
    EXPECT_EQ(result.left_out().count(), 0U);
    chi_square += result.judged.chi_square;
    degrees += result.judged.degrees_of_freedom;
    components += result.judged.components;
    within += result.judged.components_within;
  }
  // The uncertainty of the errors of March is in common to all.
  EXPECT_NEAR(chi_square / degrees, 1, 0.05);
  EXPECT_NEAR(static_cast<double>(within) / static_cast<double>(components), 0.954, 0.01);
}

TEST(VerifiedReadings, OfAMachineThatHasChangedAreNotExplained) {
  ReadingsToVerify request = march();
  request.study.seed = 5;
  request.study.simulation->errors_file.reset();
  ErrorSet changed = read_errors(test::example_file("compare/march.truth.errors.toml"), request.study.machine).errors;
  for (ErrorMotion& motion : changed.motions) {
    if (motion.axis == 0 && motion.component == Component::X) motion.coefficients[1] += 4e-3;
  }
  request.study.simulation->errors = changed;
  const VerifiedReadings result = verify_readings(request);
  EXPECT_TRUE(result.says_no());
  EXPECT_LT(result.judged.p_value, 1e-6);
  EXPECT_THAT(evaluation_text(result.report), HasSubstr("do NOT explain what is left"));
}

TEST(VerifiedReadings, OfWrongErrorsGetNoSmaller) {
  ReadingsToVerify request = march();
  for (ErrorMotion& motion : request.identified.errors.motions) {
    for (double& coefficient : motion.coefficients) coefficient = -coefficient;
  }
  const VerifiedReadings result = verify_readings(request);
  EXPECT_TRUE(result.says_no());
  EXPECT_LT(result.reduction(), 1);
}

TEST(VerifiedReadings, MeetConditionsOrNot) {
  ReadingsToVerify request = march();
  request.least_reduction = 2;
  request.largest_ratio = 1.5;
  EXPECT_FALSE(verify_readings(request).says_no());
  request.least_reduction = 1000;
  EXPECT_TRUE(verify_readings(request).says_no());
  request.least_reduction.reset();
  request.largest_ratio = 0.5;
  EXPECT_TRUE(verify_readings(request).says_no());
  request.largest_ratio = -1;
  EXPECT_THAT(message_of([&] { verify_readings(request); }), HasSubstr("--largest-ratio: -1 is not a condition"));
}

TEST(VerifiedReadings, WhereErrorsAreNotKnownAreLeftOut) {
  ReadingsToVerify request = march();
  for (ErrorMotion& motion : request.identified.errors.motions) {
    if (motion.axis == 0) motion.basis.from = 100, motion.basis.to = 700;
  }
  const VerifiedReadings result = verify_readings(request);
  EXPECT_GT(result.left_out().count(), 0U);
  EXPECT_LT(result.left_out().count(), result.readings);
  std::vector<double> of_setups;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < result.setups.size(); ++i) {
    EXPECT_EQ(result.setups[i].name, request.study.setups[i].name);
    ASSERT_EQ(result.setups[i].after.size(), result.judged.norm[i].size());
    for (std::size_t k = 0; k < result.setups[i].after.size(); ++k) {
      left_out += result.judged.norm[i][k] < 0 ? 1U : 0U;
      if (result.setups[i].after[k] >= 0) of_setups.push_back(result.setups[i].after[k]);
    }
  }
  EXPECT_EQ(left_out, result.not_covered);
  EXPECT_EQ(of_setups, result.after);
  for (ErrorMotion& motion : request.identified.errors.motions) {
    if (motion.axis == 0) motion.basis.from = 1000, motion.basis.to = 1001;
  }
  EXPECT_THAT(message_of([&] { verify_readings(request); }), HasSubstr("no reading is where all errors are known"));
}

TEST(VerifiedReadings, WithoutUncertaintiesOfTheErrorsSaySo) {
  ReadingsToVerify request = march();
  request.identified.covariance.resize(0, 0);
  for (ErrorMotion& motion : request.identified.errors.motions) motion.standard_uncertainty.clear();
  for (LocationError& location : request.identified.errors.locations) location.standard_uncertainty = 0;
  const VerifiedReadings result = verify_readings(request);
  EXPECT_FALSE(result.uncertainties_known);
  EXPECT_THAT(evaluation_text(result.report), HasSubstr("states no uncertainties: only those of the readings count"));
}

/// Trackers on the trunnion mill: one station and two reflectors of the identification, and one of each that it never
/// saw. The offset of the new reflector is open and stated 40 mm off.
Study with_new_stations(const Machine& machine, const ErrorSet& truth, std::uint64_t seed) {
  Study study = parse_study(R"(
name = "new stations"
machine = "trunnion-mill.machine.toml"
[simulate]
errors = "of-the-request.errors.toml"
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "workpiece"
measure = "range-angles"
noise = { range_um = 2, range_um_per_m = 0.5, angle_arcsec = 2 }
[[setup.station]]
name = "table"
pose = { position_mm = [150, -150, 60], angles_deg = [0, 0, 30] }
[[setup.station]]
name = "corner"
pose = { position_mm = [-180, 160, 90], angles_deg = [10, -5, 200] }
[[setup.reflector]]
name = "S1"
offset_mm = [60, 0, -120]
[[setup.reflector]]
name = "S2"
offset_mm = [-30, 55, -60]
[[setup.reflector]]
name = "stylus"
offset_mm = [25, 0, -150]
true_offset_mm = [0, 5, -180]
estimate_offset = true
[[setup.plan]]
kind = "random"
points = 40
station = "table"
axis.X = { range_mm = [-200, 200] }
axis.Y = { range_mm = [-200, 200] }
axis.Z = { range_mm = [-400, -100] }
axis.A = { range_deg = [-60, 30] }
axis.C = {}
[[setup.plan]]
kind = "random"
points = 40
station = "corner"
axis.X = { range_mm = [-200, 200] }
axis.Y = { range_mm = [-200, 200] }
axis.Z = { range_mm = [-400, -100] }
axis.A = { range_deg = [-60, 30] }
axis.C = {}
)",
                            "new.study.toml", machine);
  study.seed = seed;
  study.simulation->errors_file.reset();
  study.simulation->errors = truth;
  return study;
}

TEST(VerifiedReadings, OfReflectorsAndStationsThatTheIdentificationNeverSawAreExplained) {
  const Study identification = read_study(test::example_file("trunnion/trunnion.study.toml"));
  const StudyResult found = run_study(identification, {.map = false});
  ASSERT_TRUE(found.usable());
  ReadingsToVerify request;
  request.errors_file = "errors.toml";
  request.identified = identified_errors_file(identification, found);
  double chi_square = 0, degrees = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    request.study = with_new_stations(identification.machine, *found.campaign.truth, seed);
    const VerifiedReadings result = verify_readings(request);
    EXPECT_FALSE(result.says_no()) << seed << ": " << evaluation_text(result.report);
    EXPECT_GT(result.reduction(), 3) << seed;
    EXPECT_EQ(result.readings, 240U);  // 40 poses, three reflectors, two stations
    // Six numbers of each station and three of the reflector are fitted.
    const double used = static_cast<double>(result.readings - result.left_out().count());
    EXPECT_NEAR(result.judged.degrees_of_freedom, 3 * used - 15, 1e-9);
    chi_square += result.judged.chi_square;
    degrees += result.judged.degrees_of_freedom;
  }
  EXPECT_NEAR(chi_square / degrees, 1, 0.05);
  // After a change of the machine the same stations and reflectors contradict its errors.
  ErrorSet changed = *found.campaign.truth;
  ASSERT_FALSE(changed.motions.empty());
  for (ErrorMotion& motion : changed.motions) {
    if (motion.axis == identification.machine.find_axis("X") && motion.component == Component::X) {
      motion.coefficients[1] += 20e-3;
    }
  }
  request.study = with_new_stations(identification.machine, changed, 1);
  EXPECT_TRUE(verify_readings(request).says_no());
}

}  // namespace
}  // namespace abbe
