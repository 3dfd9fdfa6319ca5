#include "abbe/study/verification/verification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/verification/verification_page.h"
#include "abbe/study/verification/verification_text.h"

namespace abbe {
namespace {

using testing::HasSubstr;

VerificationRequest trunnion() {
  VerificationRequest request = read_verification({.machine = test::example_file("machines/trunnion-mill.machine.toml"),
                                                   .errors = test::example_file("compensate/trunnion.errors.toml"),
                                                   .truth = test::example_file("verify/truth.errors.toml")});
  request.poses = 60;
  return request;
}

PieceToVerify cone(const Machine& machine) {
  const std::string before = test::example_file("verify/cone-before.csv"),
                    after = test::example_file("verify/cone-after.csv");
  return {ConeFrustum(), {before, read_trace(before, machine)}, {after, read_trace(after, machine)}};
}

TEST(Verification, FiguresAreThoseOfTheirPoses) {
  VerificationRequest request = trunnion();
  request.least_reduction = 5;
  request.largest_ratio = 2;
  const Verification result = verify_compensation(request);
  EXPECT_EQ(result.poses.after.size() + result.left_out().count(), 60U);
  double before = 0, after = 0;
  for (const double value : result.poses.before) before += value;
  for (const double value : result.poses.after) after += value;
  EXPECT_NEAR(result.poses.reduction(), before / after, 1e-9);
  EXPECT_GT(result.poses.reduction(), 5);
  EXPECT_EQ(result.verdicts.size(), 2U);
  EXPECT_FALSE(result.says_no()) << verification_text(result);
  EXPECT_TRUE(result.volumetric.true_after && result.volumetric.predicted_after);
  const nlohmann::ordered_json json = verification_json(result);
  EXPECT_NEAR(json["unseen_poses"]["position_after_um"]["mean"].get<double>(),
              1e3 * after / static_cast<double>(result.poses.after.size()), 1e-9);
  EXPECT_EQ(json["verdict"], verification_sentence(result));
  EXPECT_EQ(verification_page_data(result)["verification"]["poses"], result.poses.after.size());
}

TEST(Verification, ErrorsThatAreTheTruthLeaveNothing) {
  VerificationRequest request = trunnion();
  request.identified = request.truth;
  const Verification result = verify_compensation(request);
  EXPECT_GT(result.poses.before_statistics.mean, 0.01);
  EXPECT_LT(result.poses.after_statistics.maximum, 1e-6);
  request.least_reduction = 1e9;
  EXPECT_EQ(verify_compensation(request).says_no(), result.poses.reduction() < 1e9);
}

TEST(Verification, TheResultDoesNotNeedTheRequestThatItIsOf) {
  const auto passing = [] {
    VerificationRequest request = trunnion();
    request.pieces.push_back(cone(request.machine));
    return verify_compensation(request);
  };
  const Verification result = passing();
  ASSERT_EQ(result.pieces.size(), 1U);
  EXPECT_TRUE(result.pieces[0].is_cone);
  EXPECT_LT(2 * result.pieces[0].after.foot.roundness, result.pieces[0].before.foot.roundness);
  EXPECT_EQ(verification_text(result), verification_text(passing()));
}

TEST(Verification, TellsOfEveryStepInOrderAndStopsInEveryOne) {
  VerificationRequest request = trunnion();
  request.pieces.push_back(cone(request.machine));
  std::vector<VerificationStep> steps;
  VerificationOptions options;
  options.progress = [&](VerificationStep step, std::size_t done, std::size_t total) {
    EXPECT_LE(done, total);
    if (steps.empty() || steps.back() != step) steps.push_back(step);
  };
  verify_compensation(request, options);
  const std::vector all = {VerificationStep::poses, VerificationStep::figures, VerificationStep::pieces};
  EXPECT_EQ(steps, all);
  for (std::size_t allowed = 0; allowed < all.size(); ++allowed) {
    std::stop_source source;
    if (allowed == 0) source.request_stop();
    options.stop = source.get_token();
    options.progress = [&](VerificationStep step, std::size_t, std::size_t) {
      ASSERT_LT(allowed, all.size());
      if (allowed > 0 && step == all[allowed - 1]) source.request_stop();
      EXPECT_LT(step, all[allowed]);
    };
    EXPECT_THROW(verify_compensation(request, options), Stopped) << step_words(all[allowed]);
  }
}

TEST(Verification, WhatCannotBeAnsweredIsNamedByItsOption) {
  const auto problem = [](const VerificationRequest& request) {
    return message_of([&] { verify_compensation(request); });
  };
  VerificationRequest request = trunnion();
  request.least_reduction = std::nan("");
  EXPECT_THAT(problem(request), HasSubstr("--least-reduction: nan is not a condition"));
  request = trunnion();
  request.ranges.resize(request.machine.axes.size());
  for (std::optional<AxisRange>& range : request.ranges) range = AxisRange::fixed(0);
  request.ranges[request.machine.find_axis("Z")] = AxisRange::fixed(-100);
  EXPECT_THAT(problem(request), HasSubstr("--range: the tool is at one place at all poses"));
  request = trunnion();
  request.pieces.push_back(cone(request.machine));
  std::get<ConeFrustum>(request.pieces[0].sizes).base_centre.z() += 5;
  EXPECT_THAT(problem(request), HasSubstr("cone-before.csv:"));
  EXPECT_THAT(problem(request), HasSubstr("the tool never begins to cut the cone frustum"));
  std::get<ConeFrustum>(request.pieces[0].sizes).height = 1e4;
  EXPECT_THAT(problem(request), HasSubstr("cone frustum: these sizes make no test piece"));
  EXPECT_THAT(message_of([] { read_verification({}); }), HasSubstr("--machine: is missing"));
}

}  // namespace
}  // namespace abbe
