#include "abbe/verify/compensated_poses.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;

class PosesOfACompensatedMachine : public testing::Test {
 protected:
  Machine machine = test::trunnion_mill();
  ErrorSet identified = with_reversals(test::tens_of_micrometres(machine, 4));
  Eigen::MatrixXd nothing;

  ErrorSet with_reversals(ErrorSet errors) const {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      errors.reversals.push_back({i, machine.axes[i].kind == AxisKind::rotary ? -30e-6 : -0.008, 0});
    }
    return errors;
  }

  static std::vector<double> lengths(const Eigen::Matrix3Xd& displacements) {
    std::vector<double> result;
    for (Index k = 0; k < displacements.cols(); ++k) result.push_back(displacements.col(k).norm());
    return result;
  }

  /// Random poses in the middle of the travel, axes coming from either side.
  PoseList poses(std::size_t count) const {
    PoseList list;
    list.approach.resize(machine.axes.size());
    for (std::size_t k = 0; k < count; ++k) {
      RandomStream random(9, k);
      std::vector<double> pose;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double middle = axis.endless ? 0 : (axis.travel_min + axis.travel_max) / 2;
        const double half = axis.endless ? std::numbers::pi : 0.4 * (axis.travel_max - axis.travel_min);
        pose.push_back(random.uniform(middle - half, middle + half));
        list.approach[i].push_back(random.uniform() < 0.5 ? std::int8_t{-1} : std::int8_t{1});
      }
      list.append(pose);
    }
    return list;
  }
};

TEST_F(PosesOfACompensatedMachine, NothingIsLeftOfErrorsThatAreKnownExactly) {
  const CompensatedPoses check = check_compensated_poses(machine, identified, identified, nothing, poses(200));
  EXPECT_EQ(check.after.size(), 200u);
  EXPECT_GT(check.before_statistics.mean, 0.03);
  // The approach shifts the place at which the errors are looked up, by some um times a slope of some 1e-6.
  EXPECT_LT(check.after_statistics.maximum, 5e-6);
  // Where the table is level C cannot turn the tool, and a part stays.
  EXPECT_LT(check.direction_after_statistics.p90, 1e-7);
  EXPECT_GT(check.direction_before_statistics.mean, 3e-5);
  EXPECT_EQ(check.uncertainty_ratio(), 0);
  EXPECT_TRUE(check.uncertainty.empty());
}

TEST_F(PosesOfACompensatedMachine, TheErrorAtTheCommandsAsTheyAreIsTheOneBefore) {
  const PoseList list = poses(100);
  const CompensatedPoses check = check_compensated_poses(machine, identified, identified, nothing, list);
  std::vector<std::uint8_t> used(100, 1);
  EXPECT_EQ(lengths(errors_at_commands(machine, identified, ErrorSet{}, list, used)), check.before);
  // Against themselves nothing is left; of a machine without the reversal values these are, whatever is not used.
  used[3] = 0;
  const std::vector<double> same = lengths(errors_at_commands(machine, identified, identified, list, used));
  ASSERT_EQ(same.size(), 100U);
  EXPECT_LT(*std::max_element(same.begin(), same.end()), 1e-9);
  ErrorSet mean = identified;
  mean.reversals.clear();
  std::vector<double> reversal = lengths(errors_at_commands(machine, identified, mean, list, used));
  EXPECT_EQ(reversal[3], 0);
  reversal.erase(reversal.begin() + 3);
  EXPECT_GT(*std::min_element(reversal.begin(), reversal.end()), 1e-3);
}

TEST_F(PosesOfACompensatedMachine, ReversalValuesThatAreNotKnownStay) {
  ErrorSet mean = identified;
  mean.reversals.clear();
  const CompensatedPoses check = check_compensated_poses(machine, identified, mean, nothing, poses(200));
  // Three linear axes at +-4 um each: 7 um, and what the rotary ones add.
  EXPECT_GT(check.after_statistics.mean, 5e-3);
  EXPECT_LT(check.after_statistics.mean, 12e-3);
}

TEST_F(PosesOfACompensatedMachine, AnotherWorkpieceDatumChangesNothing) {
  ErrorSet truth = test::tens_of_micrometres(machine, 7);
  const PoseList list = poses(150);
  const CompensatedPoses check = check_compensated_poses(machine, truth, identified, nothing, list);
  Machine turned = machine;
  // The workpiece stands elsewhere on the table and is turned: same errors, same machine.
  turned.bed_from_workpiece.translation += Eigen::Vector3d(20, -30, 10);
  turned.bed_from_workpiece.rotation *=
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const CompensatedPoses again = check_compensated_poses(turned, truth, identified, nothing, list);
  EXPECT_NEAR(again.before_statistics.mean, check.before_statistics.mean, 1e-6);
  EXPECT_NEAR(again.after_statistics.mean, check.after_statistics.mean, 1e-6);
  EXPECT_NEAR(again.direction_before_statistics.mean, check.direction_before_statistics.mean, 1e-9);
  EXPECT_NEAR(again.direction_after_statistics.mean, check.direction_after_statistics.mean, 1e-9);
  EXPECT_GT(check.after_statistics.mean, 0.02);
  EXPECT_GT(check.direction_after_statistics.mean, 2e-5);
}

TEST_F(PosesOfACompensatedMachine, PosesOnALineDoNotSayHowTheWorkpieceIsTurned) {
  ErrorSet truth = test::tens_of_micrometres(machine, 7);
  PoseList list = poses(40);
  const auto fix = [&](const char* axis) {
    for (double& value : list.axis[machine.find_axis(axis)]) value = list.axis[machine.find_axis(axis)].front();
  };
  for (const char* const axis : {"A", "C", "Z"}) fix(axis);
  const CompensatedPoses area = check_compensated_poses(machine, truth, identified, nothing, list);
  EXPECT_EQ(area.datum, BestFitStatus::ok);
  EXPECT_EQ(area.after.size(), 40u);
  fix("Y");
  const CompensatedPoses line = check_compensated_poses(machine, truth, identified, nothing, list);
  EXPECT_EQ(line.datum, BestFitStatus::collinear);
  EXPECT_TRUE(line.after.empty());
  EXPECT_TRUE(line.direction_before.empty());
  EXPECT_EQ(line.outside_travel + line.not_covered, 0u);
  fix("X");
  EXPECT_EQ(check_compensated_poses(machine, truth, identified, nothing, list).datum, BestFitStatus::coincident);
}

TEST_F(PosesOfACompensatedMachine, ThePredictionIsWhatErrorsOfThatCovarianceLeave) {
  // True errors drawn about the identified ones, all of them, reversal values too.
  const std::size_t count = identified.parameter_count();
  const std::vector<bool> is_angle = parameters_are_angles(machine, identified);
  RandomStream random(21);
  const auto n = static_cast<Index>(count);
  Eigen::MatrixXd root(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      root(i, j) =
          (is_angle[static_cast<std::size_t>(i)] ? 3e-6 : 1e-3) * random.normal() / std::sqrt(static_cast<double>(n));
    }
  }
  const Eigen::MatrixXd covariance = root * root.transpose();
  const PoseList list = poses(120);
  double squares = 0, coverage = 0;
  constexpr int kDraws = 12;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd drawn(n);
    for (Index i = 0; i < n; ++i) drawn[i] = random.normal();
    const Eigen::VectorXd change = root * drawn;
    std::vector<double> values = identified.parameters();
    for (std::size_t i = 0; i < count; ++i) values[i] += change[static_cast<Index>(i)];
    ErrorSet truth = identified;
    truth.set_parameters(values);
    const CompensatedPoses check = check_compensated_poses(machine, truth, identified, covariance, list);
    squares += check.uncertainty_ratio() * check.uncertainty_ratio() / kDraws;
    coverage += check.coverage / kDraws;
  }
  EXPECT_NEAR(std::sqrt(squares), 1, 0.1);
  EXPECT_NEAR(coverage, 0.954, 0.03);

  // The reversal values alone: half of each, by either side, whatever the place.
  Eigen::MatrixXd reversal_only = Eigen::MatrixXd::Zero(n, n);
  const Index x = n - 3 - 5 + static_cast<Index>(machine.find_axis("X"));
  reversal_only(x, x) = 1e-6;
  const CompensatedPoses one = check_compensated_poses(machine, identified, identified, reversal_only, list);
  EXPECT_NEAR(one.uncertainty_statistics.rms, 0.5e-3, 0.03e-3);
}

TEST_F(PosesOfACompensatedMachine, AReversalValueThatIsABitWrongLeavesWhatIsPredictedAtEveryPose) {
  // Displacements by the axes of a machine without other errors, so that the first order is all there is.
  ErrorSet only;
  only.reversals = identified.reversals;
  const PoseList list = poses(80);
  const auto n = static_cast<Index>(only.parameter_count());
  for (std::size_t r = 0; r < only.reversals.size(); ++r) {
    const double change = machine.axes[only.reversals[r].axis].kind == AxisKind::rotary ? 2e-6 : 1e-3;
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    const Index parameter = n - 3 - static_cast<Index>(only.reversals.size()) + static_cast<Index>(r);
    covariance(parameter, parameter) = change * change;
    ErrorSet truth = only;
    truth.reversals[r].value += change;
    const CompensatedPoses check = check_compensated_poses(machine, truth, only, covariance, list);
    ASSERT_EQ(check.uncertainty.size(), check.after.size());
    EXPECT_GT(check.uncertainty_statistics.maximum, 1e-4);
    for (std::size_t k = 0; k < check.after.size(); ++k) EXPECT_NEAR(check.after[k], check.uncertainty[k], 1e-7);
  }
}

TEST_F(PosesOfACompensatedMachine, PosesAtTheEndOfTravelAreLeftOutAndCounted) {
  PoseList list = poses(60);
  const std::size_t z = machine.find_axis("Z");
  for (std::size_t k = 0; k < 10; ++k) list.axis[z][k] = machine.axes[z].travel_max;
  const CompensatedPoses check = check_compensated_poses(machine, identified, identified, nothing, list);
  EXPECT_EQ(check.after.size() + check.outside_travel + check.not_covered, 60u);
  EXPECT_GT(check.outside_travel + check.not_covered, 0u);
  EXPECT_LE(check.outside_travel + check.not_covered, 10u);
}

TEST_F(PosesOfACompensatedMachine, WhatDoesNotFitIsRefused) {
  EXPECT_THROW(check_compensated_poses(machine, identified, identified, nothing, PoseList{{{0}}}),
               std::invalid_argument);
  EXPECT_THROW(check_compensated_poses(machine, identified, identified, Eigen::MatrixXd::Zero(2, 2), poses(20)),
               std::invalid_argument);
  const auto n = static_cast<Index>(identified.parameter_count());
  EXPECT_THROW(check_compensated_poses(machine, identified, identified, -Eigen::MatrixXd::Identity(n, n), poses(20)),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
