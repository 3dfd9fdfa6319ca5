#include "abbe/study/report/truth_in_gauge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/formats/study/study_file.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/study/study_steps.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

Study example(const std::string& name) {
  return read_study(std::string(ABBE_SOURCE_DIR "/examples/three_axis/") + name + ".study.toml");
}

TEST(TruthInGauge, OfLasersIsTheTrueMachineButForTheWorkpieceDatum) {
  // The angle of the optical squares and the scales are known beforehand only: left out, they would drift by
  // micrometres.
  const Study study = example("interferometer");
  StudyResult result;
  result.campaign = gather_readings(study);
  identify_study(study, result);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const std::optional<ErrorSet> truth = truth_in_gauge(study, result);
  ASSERT_TRUE(truth.has_value());
  const PoseList poses = random_plan(study.machine, full_ranges(study.machine, 2), 200, 1);
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  const ErrorMap before = error_map(study.machine, *result.campaign.truth, nullptr, pose_source(poses), options);
  const ErrorMap map = error_map(study.machine, *result.campaign.truth, &*truth, pose_source(poses), options);
  EXPECT_GT(before.statistics.mean, 3e-3);
  EXPECT_LT(map.statistics.maximum, 2e-5);
}

TEST(TruthInGauge, ParametersAreThoseOfTheTruthOrTheNearestInTheModel) {
  Study study = example("interferometer");
  ErrorSet truth = true_errors(study);
  const std::vector<double> same = true_parameters(truth, truth), own = truth.parameters();
  ASSERT_EQ(same.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_NEAR(same[i], own[i], 1e-12) << i;
  // A straight line has the mean and the slope of the parabola; what the truth does not have is zero.
  ErrorSet model;
  ErrorMotion line = truth.motions.front();
  line.basis.order = 1;
  line.coefficients = {0, 0};
  model.motions = {line};
  model.locations = {{2, Component::A, 0.5, 0}};
  truth.locations.clear();
  const std::vector<double> nearest = true_parameters(truth, model);
  ASSERT_EQ(nearest.size(), 6u);
  // Legendre polynomials are orthogonal over the range; at equal steps nearly so.
  EXPECT_NEAR(nearest[0], truth.motions.front().coefficients[0],
              0.05 * std::abs(truth.motions.front().coefficients[2]));
  EXPECT_NEAR(nearest[1], truth.motions.front().coefficients[1], 1e-9);
  EXPECT_EQ(nearest[2], 0);
}

}  // namespace
}  // namespace abbe
