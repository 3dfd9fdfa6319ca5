#include "abbe/verify/table_loss.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "abbe/compensate/tables/line_tables.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

PoseList commanded_poses(const Machine& machine, std::size_t count) {
  std::mt19937_64 generator(3);
  PoseList poses;
  for (std::size_t k = 0; k < count; ++k) poses.append(test::random_commands(machine, generator));
  return poses;
}

CorrectionMaker own_tables(const Machine& machine, bool cross) {
  return [&machine, cross](const ErrorSet& errors) -> std::unique_ptr<CommandCorrection> {
    LineTableOptions options;
    options.cross = cross;
    options.nodes = 65;
    return std::make_unique<AxisTableCorrection>(line_tables(machine, errors, options).tables);
  };
}

const CarriedError& named(const std::vector<CarriedError>& errors, const std::string& name) {
  return *std::find_if(errors.begin(), errors.end(), [&](const CarriedError& one) { return one.name == name; });
}

TEST(TableLoss, OwnTablesCarryPositioningAndNothingAcross) {
  const Machine machine = test::three_axis_mill();
  RandomErrorOptions options;
  options.seed = 4;
  const ErrorSet errors = random_errors(machine, options);
  const std::vector<CarriedError> carried =
      carried_errors(machine, errors, commanded_poses(machine, 60), own_tables(machine, false));
  // 18 error motions and the squareness errors that a three-axis machine has.
  EXPECT_GE(carried.size(), 18U + 3U);
  for (const char* name : {"EXX", "EYY", "EZZ"}) EXPECT_GT(named(carried, name).carried(), 0.99) << name;
  for (const char* name : {"EYX", "EZX", "EXY", "EC0Y"}) EXPECT_LT(named(carried, name).carried(), 0.05) << name;
  for (const CarriedError& one : carried) EXPECT_GT(one.carried(), -0.5) << one.name;
}

TEST(TableLoss, CrossTablesCarryStraightnessAndSquarenessToo) {
  const Machine machine = test::three_axis_mill();
  RandomErrorOptions options;
  options.seed = 4;
  const ErrorSet errors = random_errors(machine, options);
  const std::vector<CarriedError> carried =
      carried_errors(machine, errors, commanded_poses(machine, 60), own_tables(machine, true));
  for (const char* name : {"EXX", "EYX", "EZX", "EXY", "EC0Y"}) {
    EXPECT_GT(named(carried, name).carried(), 0.98) << name;
  }
}

TEST(TableLoss, TheIdealCorrectionLeavesNothingWhereAllErrorsAreReached) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = random_errors(machine, {});
  PoseList poses = commanded_poses(machine, 40);
  for (std::size_t i = 0; i < poses.axis.size(); ++i) poses.axis[i].push_back(machine.axes[i].travel_max);
  std::size_t not_reached = 1;
  const PoseDeviations ideal = ideal_deviations(machine, errors, poses, not_reached);
  EXPECT_EQ(not_reached, 0U);
  EXPECT_LT(ideal.position_statistics.maximum, 1e-9);
  const PoseDeviations before = deviations_with(machine, errors, poses, NoCorrection());
  EXPECT_GT(before.position_statistics.maximum, 0.01);
  // Three axes cannot turn the tool.
  EXPECT_GT(ideal.orientation_statistics.maximum, 0.5 * before.orientation_statistics.maximum);
}

TEST(TableLoss, ErrorsAloneAddUpToAllErrors) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors = random_errors(machine, {});
  errors.tool_offset_error = {0.01, 0, -0.02};
  const std::vector<NamedErrors> alone = errors_one_by_one(machine, errors);
  std::size_t motions = 0, locations = 0;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  for (const NamedErrors& one : alone) {
    motions += one.errors.motions.size();
    locations += one.errors.locations.size();
    tool += one.errors.tool_offset_error;
    EXPECT_GT(one.size, 0) << one.name;
  }
  EXPECT_EQ(motions, errors.motions.size());
  EXPECT_EQ(locations, errors.locations.size());
  EXPECT_EQ(tool, errors.tool_offset_error);
}

TEST(TableLoss, TablesOfBothDirectionsCarryReversalValuesAndTheMeanDoesNot) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  errors.reversals = {{machine.find_axis("X"), -0.02, 0}, {machine.find_axis("C"), 40e-6, 0}};
  const PoseList poses = commanded_poses(machine, 20);
  // An independent route: every combination of directions, one by one.
  double largest = 0;
  for (const int x : {-1, 1}) {
    for (const int c : {-1, 1}) {
      std::vector<double> stands = poses.pose(7);
      stands[machine.find_axis("X")] += -0.01 * x;
      stands[machine.find_axis("C")] += 20e-6 * c;
      largest = std::max(largest, (nominal_workpiece_from_tool(machine, stands).translation -
                                   nominal_workpiece_from_tool(machine, poses.pose(7)).translation)
                                      .norm());
    }
  }
  const PoseDeviations before = deviations_with(machine, errors, poses, NoCorrection());
  EXPECT_NEAR(before.position[7], largest, 1e-12);
  for (const bool directions : {true, false}) {
    const auto make = [&](const ErrorSet& set) -> std::unique_ptr<CommandCorrection> {
      LineTableOptions options;
      options.directions = directions;
      return std::make_unique<AxisTableCorrection>(line_tables(machine, set, options).tables);
    };
    const PoseDeviations after = deviations_with(machine, errors, poses, *make(errors));
    EXPECT_NEAR(after.position_statistics.maximum, directions ? 0 : before.position_statistics.maximum, 1e-9);
    const std::vector<CarriedError> carried = carried_errors(machine, errors, poses, make);
    ASSERT_EQ(carried.size(), 2U);
    EXPECT_NEAR(named(carried, "reversal_X").effect_before, 0.01, 1e-12);
    EXPECT_NEAR(named(carried, "reversal_X").carried(), directions ? 1 : 0, 1e-6);
    EXPECT_NEAR(named(carried, "reversal_C").carried(), directions ? 1 : 0, 1e-6);
  }
}

TEST(TableLoss, WithoutTablesTheVolumetricErrorIsThatOfTheErrorMapWhateverTheReversalValues) {
  const Machine machine = test::three_axis_mill();
  RandomErrorOptions options;
  options.seed = 4;
  ErrorSet errors = random_errors(machine, options);
  const PoseList poses = commanded_poses(machine, 60);
  ErrorMapOptions map_options;
  map_options.remove_rigid_motion = true;
  const ErrorMap map = error_map(machine, errors, nullptr, pose_source(poses), map_options);
  errors.reversals = {{machine.find_axis("X"), -0.02, 0}};
  const SampleStatistics error = volumetric_error_with(machine, errors, poses, NoCorrection());
  EXPECT_NEAR(error.mean, map.statistics.mean, 1e-9);
  EXPECT_NEAR(error.maximum, map.statistics.maximum, 1e-9);
  EXPECT_LT(error.rms, 0.99 * deviations_with(machine, errors, poses, NoCorrection()).position_statistics.rms)
      << "the datum is not fitted";
}

}  // namespace
}  // namespace abbe
