#include "abbe/study/verified_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/example_file_for_test.h"

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

}  // namespace
}  // namespace abbe
