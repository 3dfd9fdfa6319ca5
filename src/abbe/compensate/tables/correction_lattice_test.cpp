#include "abbe/compensate/tables/correction_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/compensate/tables/line_tables.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TEST(CorrectionLattice, IsLinearInEveryInputAndHoldsItsEndValues) {
  CorrectionLattice lattice;
  lattice.inputs = {0, 2};
  lattice.positions = {{0, 10}, {0, 1, 3}};
  lattice.modulo = {false, true};
  lattice.outputs = {1};
  lattice.corrections = {{0, 1, 2, 5, 0, 1}};
  const LatticeCorrection correction(lattice);
  const auto at = [&](double x, double c) {
    PoseList pose, found;
    pose.append({x, 0, c});
    correction.evaluate(pose, found);
    EXPECT_EQ(found.axis[0][0], 0);
    return found.axis[1][0];
  };
  EXPECT_DOUBLE_EQ(at(0, 0), 0);
  EXPECT_DOUBLE_EQ(at(10, 1), 5);
  EXPECT_DOUBLE_EQ(at(5, 0.5), 2);  // mean of 0, 1, 2, 5
  EXPECT_DOUBLE_EQ(at(-7, 1), 2);
  EXPECT_DOUBLE_EQ(at(99, 1), 5);
  EXPECT_DOUBLE_EQ(at(10, 1 + 3), 5);
  EXPECT_DOUBLE_EQ(at(10, 2 - 3), at(10, 2));
}

TEST(CorrectionLattice, TakesTheShiftAwayInTheWholeVolumeWithinTheLimitOfItsInterpolation) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = random_errors(machine, {});
  LatticeOptions options;
  options.inputs = options.outputs = {0, 1, 2};
  options.reference = middle_of_travel(machine, errors);
  options.tolerance_mm = 5e-4;
  const BuiltLattice built = build_lattice(machine, errors, options);
  ASSERT_TRUE(built.within);
  const LatticeCorrection correction(built.lattice);
  std::mt19937_64 generator(8);
  PoseList poses, added;
  for (int k = 0; k < 2000; ++k) poses.append(test::random_commands(machine, generator));
  correction.evaluate(poses, added);
  double before = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    const std::vector<double> pose = poses.pose(k);
    std::vector<double> corrected = pose;
    for (std::size_t i = 0; i < 3; ++i) corrected[i] += added.axis[i][k];
    const Eigen::Vector3d wanted = nominal_workpiece_from_tool(machine, pose).translation;
    before = std::max(before, (actual_workpiece_from_tool(machine, errors, pose).translation - wanted).norm());
    EXPECT_LT((actual_workpiece_from_tool(machine, errors, corrected).translation - wanted).norm(),
              std::sqrt(3.0) * options.tolerance_mm);
  }
  EXPECT_GT(before, 0.02);
}

TEST(CorrectionLattice, TooSmallALatticeSaysWhatItReaches) {
  const Machine machine = test::moving_table_cmm();
  const ErrorSet errors = random_errors(machine, {});
  LatticeOptions options;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    options.inputs.push_back(i);
    options.outputs.push_back(i);
  }
  options.reference = middle_of_travel(machine, errors);
  options.most_nodes = 50;
  const BuiltLattice built = build_lattice(machine, errors, options);
  EXPECT_LE(built.lattice.count(), 50U);
  EXPECT_FALSE(built.within);
  EXPECT_GT(*std::max_element(built.interpolation_error.begin(), built.interpolation_error.end()), 1e-4);
}

}  // namespace
}  // namespace abbe
