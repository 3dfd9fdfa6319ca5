#include "liu/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "liu/figure_study.h"

namespace abbe {
namespace {

LiuClampingErrors table_3_clamping() {
  const RigidTransform clamped = liu_clamping(LiuUnit::micrometre);
  return liu_clamping_errors({clamped.translation, clamped.rotation * Eigen::Vector3d::UnitY()});
}

TEST(LiuClampingCalibration, FindsTheAxisOfTheReferenceReadings) {
  const LiuReferenceClamping reference = liu_reference_clamping(liu_machine());
  ASSERT_TRUE(reference.converged);
  EXPECT_LT(reference.difference, 1e-9);
  EXPECT_LT(reference.remaining, 1e-10);
}

TEST(LiuClampingCalibration, ClampingErrorsAndWhereTheyBringTheCylinderAreInverse) {
  const LiuClampingErrors errors = {-0.1, 0.04, 0.06, -0.25};
  RigidTransform clamped = liu_clamped(errors);
  // Any point of the axis will do.
  clamped.translation += 7 * (clamped.rotation * Eigen::Vector3d::UnitY());
  const LiuClampingErrors again =
      liu_clamping_errors({clamped.translation, clamped.rotation * Eigen::Vector3d::UnitY()});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(again[i], errors[i], 1e-14) << i;
}

TEST(LiuClampingCalibration, OfExactReadingsIsExactAndLeavesLessThanThePaper) {
  const Machine machine = liu_machine();
  const LiuClampingErrors truth = table_3_clamping();
  const LiuCampaign campaign = liu_campaign(machine, liu_errors(machine, LiuUnit::micrometre), truth, {});
  ASSERT_TRUE(campaign.converged());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(campaign.clamping.found[i], truth[i], 1e-10) << i;
  for (std::size_t q = 0; q < kLiuQuarters; ++q) {
    EXPECT_LT(largest_magnitude(campaign.a.places.remaining(q)), 1e-9);
    EXPECT_LT(largest_magnitude(campaign.c.places.remaining(q)), 1e-9);
    EXPECT_LT(largest_magnitude(campaign.clamping.places.remaining(q)), 1e-9);
  }
  // At 0 degrees nothing has turned yet: any axis fits.
  EXPECT_LT(largest_magnitude(campaign.c.places.nominal_difference(0)), 1e-9);
  EXPECT_GT(largest_magnitude(campaign.c.places.nominal_difference(2)), 0.1);
}

TEST(LiuClampingCalibration, AJointFitSpreadsAsItStatesAndTheLastStepMoreThanItStates) {
  const Machine machine = liu_machine();
  const ErrorSet stages = liu_errors(machine, LiuUnit::micrometre);
  const LiuClampingErrors truth = table_3_clamping();
  const LiuCampaign campaign = liu_campaign(machine, stages, truth, {"", liu_table_2_noise(), 0, 1});
  const LiuJointClamping joint = liu_joint_clamping(machine, stages, truth, 1);
  const LiuClampingSpreads spread = liu_clamping_spreads(machine, stages, truth, 25);
  ASSERT_TRUE(joint.converged);
  ASSERT_EQ(spread.steps.campaigns, 25U);
  ASSERT_EQ(spread.joint.campaigns, 25U);
  for (std::size_t i = 0; i < 4; ++i) {
    // A standard deviation of 25 values is uncertain by 14 %.
    EXPECT_NEAR(spread.joint.deviation[i] / joint.uncertainty[i], 1, 0.45) << i;
    EXPECT_LT(std::abs(spread.steps.mean[i]), 4 * spread.steps.deviation[i] / 5) << i;
    EXPECT_LT(campaign.clamping.uncertainty[i], joint.uncertainty[i]) << i;
  }
  EXPECT_GT(spread.steps.deviation[1], 1.5 * campaign.clamping.uncertainty[1]);
}

TEST(LiuProfile, OfTiltedStagesIsAConeAndOfAWrongClampingAnObliqueCylinder) {
  const Machine machine = liu_machine();
  const ErrorSet stages = liu_errors(machine, LiuUnit::micrometre);
  const std::vector<double> heights = {-10, 0, 10};
  const LiuProfile cone = liu_profile(machine, {"", stages, {}, liu_on_stage_axis(machine, stages), {}}, heights);
  EXPECT_LT(cone.lean, 1e-9);
  EXPECT_NEAR(cone.growth, std::tan(-0.8466 * kDegree), 1e-5);
  const LiuProfile oblique = liu_profile(machine, {"", {}, {}, liu_clamping(LiuUnit::micrometre), {}}, heights);
  EXPECT_GT(oblique.lean, 6 * kDegree);
  EXPECT_LT(std::abs(oblique.growth), 1e-6);
  // Without errors, or with those that the evaluation knows, it is the cylinder.
  const RigidTransform clamped = liu_clamping(LiuUnit::micrometre);
  EXPECT_LT(liu_profile(machine, {"", stages, stages, clamped, clamped}, heights).deviation, 1e-9);
}

TEST(LiuRepeats, AreAlikeOnlyIfTheStandardHasAFormOfItsOwn) {
  const Machine machine = liu_machine();
  const ErrorSet stages = liu_errors(machine, LiuUnit::micrometre);
  const LiuCase calibration{"", liu_table_2_noise(), 0, 1};
  const LiuRepeats plain = liu_repeats(machine, stages, table_3_clamping(), calibration, 0);
  const LiuRepeats lobes = liu_repeats(machine, stages, table_3_clamping(), calibration, 0.007);
  ASSERT_TRUE(plain.complete && lobes.complete);
  EXPECT_LT(std::abs(plain.correlation), 0.1);
  EXPECT_GT(lobes.correlation, 0.9);
  EXPECT_NEAR(plain.repeatability, 1.1e-3, 0.15e-3);
  EXPECT_NEAR(lobes.rms[0], std::hypot(0.007 / std::sqrt(2.0), 1.1e-3), 0.3e-3);
}

}  // namespace
}  // namespace abbe
