#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/study/compensation/corrected_commands.h"
#include "abbe/study/identification/identified_expansions.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kExample = ABBE_SOURCE_DIR "/examples/expansion/";

const Study& example_study() {
  static const Study study = read_study(kExample + "mill.study.toml");
  return study;
}

const StudyResult& example_result() {
  static const StudyResult result = run_study(example_study());
  return result;
}

CommandsRequest example_part() {
  CommandsRequest request;
  request.machine = example_study().machine;
  request.errors = identified_errors_file(example_study(), example_result());
  request.poses = read_poses(kExample + "part.csv", request.machine);
  return request;
}

/// Estimate and standard uncertainty of a parameter, mm.
std::pair<double, double> estimate_of(const Identification& identified, const std::string& name) {
  for (std::size_t i = 0; i < identified.parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (identified.parameters[i].name == name) return {identified.estimates[at], identified.standard_uncertainties[at]};
  }
  ADD_FAILURE() << name;
  return {};
}

TEST(ExpansionExample, FindsTheScaleAndTheGrowthOfTheSpindle) {
  const StudyResult& result = example_result();
  ASSERT_TRUE(result.usable()) << result.identification.message;
  EXPECT_TRUE(result.distrusted.empty());
  const FoundExpansion scale = found_expansions(example_study(), result).at(0);
  EXPECT_NEAR(scale.coefficient, 9.4e-6, 1.5 * scale.expanded_uncertainty);
  EXPECT_LT(scale.expanded_uncertainty, 0.5e-6) << "the readings know it better than its maker";
  const auto [growth, u] = estimate_of(result.identification, "EZ0Z*spindle");
  EXPECT_LT(u, 0.02e-3);
  EXPECT_NEAR(growth, -1.9e-3, 3 * u);
}

TEST(ExpansionExample, TheToolIsBroughtToTheWarmPart) {
  CommandsRequest request = example_part();
  request.workpiece = WorkpieceExpansion{.state = find_state(request.machine, "part"),
                                         .coefficient = 23.4e-6,
                                         .standard_uncertainty = 1e-6,
                                         .temperature_uncertainty = 0,
                                         .fixed_point = {0, 0, 0}};
  const CorrectedCommands result = correct_commands(request);
  ASSERT_EQ(result.not_reached, 0U);
  const GivenStates states(request.machine, request.errors.errors);
  for (std::size_t k = 0; k < request.poses.count(); ++k) {
    const Eigen::Vector3d nominal = nominal_workpiece_from_tool(request.machine, request.poses.pose(k)).translation;
    const Eigen::Vector3d actual =
        actual_workpiece_from_tool(request.machine, request.errors.errors, result.corrected.commands.pose(k),
                                   states.at(request.poses, k))
            .translation;
    EXPECT_LT((actual - (1 + 23.4e-6 * 2.4) * nominal).norm(), 1e-9) << k;
    // By hand, with the true errors: the spindle is 1.9 um/K longer at 31.5 degC, the part 23.4 um/(m K) at 22.4 degC.
    const double by_hand = 1.9e-3 * 11.5 + 23.4e-6 * 2.4 * nominal.z();
    EXPECT_NEAR(result.corrected.commands.axis[2][k] - request.poses.axis[2][k], by_hand, 0.5e-3) << k;
  }
  EXPECT_THAT(corrected_commands_text(result),
              HasSubstr("workpiece: 23.4 um/(m K), right at 20 degC and now at 22.4 degC, fixed at (0, 0, 0) mm"));
  EXPECT_GT(result.corrected.uncertainty[0], correct_commands(example_part()).corrected.uncertainty[0]);
}

TEST(ExpansionExample, WithoutItsTemperatureNothingIsCorrected) {
  CommandsRequest request = example_part();
  request.workpiece = WorkpieceExpansion{.state = find_state(request.machine, "part"), .coefficient = 23.4e-6};
  request.poses.state[request.workpiece->state].clear();
  EXPECT_THROW(correct_commands(request), std::runtime_error);
}

}  // namespace
}  // namespace abbe
