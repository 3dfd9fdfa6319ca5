#include "abbe/verify/parts/determined_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/errors/reversal.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Every error motion as constant and slope: 36 parameters, then the tool offset error.
ErrorSet errors_of(const Machine& machine, double size, std::uint64_t seed) {
  ErrorSet errors;
  RandomStream random(seed, 3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int component = 0; component < kComponentCount; ++component) {
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = static_cast<Component>(component);
      motion.basis = {BasisKind::legendre, 1, machine.axes[axis].travel_min, machine.axes[axis].travel_max};
      const double unit = is_rotation(motion.component) ? 1e-5 : 5e-3;
      motion.coefficients = {size * unit * random.normal(), size * unit * random.normal()};
      errors.motions.push_back(motion);
    }
  }
  return errors;
}

std::size_t parameter(std::size_t axis, Component component, std::size_t coefficient) {
  return 2 * (axis * kComponentCount + static_cast<std::size_t>(component)) + coefficient;
}

PoseList poses_of(const Machine& machine, std::size_t count) {
  PoseList poses;
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(5, k);
    std::vector<double> positions;
    for (const Axis& axis : machine.axes) positions.push_back(random.uniform(axis.travel_min, axis.travel_max));
    poses.append(positions);
  }
  return poses;
}

/// Three unseen directions: the slope of the roll of X, which no rigid motion replaces; a constant straightness, which
/// is a shift of the workpiece; and the constant yaw of X, a turn of the workpiece on the table.
Eigen::MatrixXd directions(std::size_t parameters) {
  Eigen::MatrixXd unseen = Eigen::MatrixXd::Zero(static_cast<Index>(parameters), 3);
  unseen(static_cast<Index>(parameter(0, Component::A, 1)), 0) = 1;
  unseen(static_cast<Index>(parameter(0, Component::Y, 0)), 1) = 1;
  unseen(static_cast<Index>(parameter(0, Component::C, 0)), 2) = 1;
  return unseen;
}

/// Usual size of a parameter, mm or rad: every second block of six coefficients are angles.
double unit_of(Index parameter) { return parameter >= 36 || (parameter % 12) < 6 ? 5e-3 : 1e-5; }

ParameterCovariance covariance_of(std::size_t parameters, double size) {
  ParameterCovariance covariance;
  const Index n = static_cast<Index>(parameters);
  Eigen::MatrixXd root(n, n);
  RandomStream random(8, 1);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) root(i, j) = size * unit_of(i) * random.normal() / std::sqrt(static_cast<double>(n));
  }
  covariance.covariance = root * root.transpose();
  for (std::size_t i = 0; i < parameters; ++i) covariance.parameters.push_back(i);
  return covariance;
}

class DeterminedParts : public testing::Test {
 protected:
  Machine machine = test::three_axis_mill();
  PoseList poses = poses_of(machine, 60);
  PoseSource source = pose_source(poses);
  ErrorSet identified = errors_of(machine, 1, 1);
  std::size_t count = identified.parameter_count();
  Eigen::MatrixXd unseen = directions(count);

  ErrorMap deviation_of(const Eigen::VectorXd& change) const {
    ErrorSet actual = identified;
    std::vector<double> values = actual.parameters();
    for (std::size_t i = 0; i < count; ++i) values[i] += change[static_cast<Index>(i)];
    actual.set_parameters(values);
    ErrorMapOptions options;
    options.orientation = false;
    options.remove_rigid_motion = true;
    return error_map(machine, actual, &identified, source, options);
  }
};

TEST_F(DeterminedParts, NothingIsLeftOfErrorsThatDifferByUnseenDirectionsOnly) {
  const Eigen::VectorXd change = unseen * Eigen::Vector3d(20e-6, 0.01, 30e-6);
  const ErrorMap map = deviation_of(change);
  EXPECT_GT(map.statistics.mean, 2e-3);  // the roll, after the best fit of the workpiece datum
  const DeterminedPart part = determined_part(machine, identified, covariance_of(count, 1), unseen, poses, map);
  EXPECT_EQ(part.open_directions, std::vector<std::size_t>{0});
  EXPECT_EQ(part.open_rank, 1u);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(part.displacement[c][k], 0, 2e-6);  // products of two errors
      EXPECT_NEAR(part.open[c][k], map.displacement[c][k], 2e-6);
    }
  }
}

TEST_F(DeterminedParts, WhatIsSeenStaysButForItsPartAlongTheOpenDirection) {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Index>(count));
  change[static_cast<Index>(parameter(1, Component::X, 1))] = 0.01;  // squareness of Y
  const DeterminedPart alone =
      determined_part(machine, identified, covariance_of(count, 1), unseen, poses, deviation_of(change));
  const DeterminedPart both = determined_part(machine, identified, covariance_of(count, 1), unseen, poses,
                                              deviation_of(change + unseen.col(0) * 50e-6));
  double size = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(alone.displacement[c][k], both.displacement[c][k], 2e-6);
      size = std::max(size, std::abs(alone.displacement[c][k]));
    }
  }
  EXPECT_GT(size, 2e-3);
}

TEST_F(DeterminedParts, TheUncertaintyIsTheSameInEveryConvention) {
  const ErrorMap map = deviation_of(Eigen::VectorXd::Zero(static_cast<Index>(count)));
  ParameterCovariance one = covariance_of(count, 1), other = one;
  // Another convention moves every estimate along the unseen directions, by an amount that depends on all of them.
  Eigen::MatrixXd amount = Eigen::MatrixXd::Zero(3, static_cast<Index>(count));
  for (Index i = 0; i < 3; ++i) {
    const double unit = i == 1 ? 5e-3 : 1e-5;
    for (Index j = 0; j < amount.cols(); ++j) {
      amount(i, j) = unit / unit_of(j) * std::sin(static_cast<double>(7 * i + 3 * j));
    }
  }
  const Eigen::MatrixXd moved = Eigen::MatrixXd::Identity(amount.cols(), amount.cols()) + unseen * amount;
  other.covariance = moved * one.covariance * moved.transpose();
  const DeterminedPart a = determined_part(machine, identified, one, unseen, poses, map);
  const DeterminedPart b = determined_part(machine, identified, other, unseen, poses, map);
  const DeterminedPart all = determined_part(machine, identified, one, Eigen::MatrixXd(amount.cols(), 0), poses, map);
  double difference = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GT(a.uncertainty[c][k], 0);
      EXPECT_NEAR(a.uncertainty[c][k], b.uncertainty[c][k], 1e-3 * a.uncertainty[c][k]);
      difference = std::max(difference, std::abs(all.uncertainty[c][k] - a.uncertainty[c][k]));
    }
  }
  EXPECT_GT(difference, 1e-4);
  EXPECT_TRUE(all.open_directions.empty());
}

TEST_F(DeterminedParts, WithoutUnseenDirectionsItIsTheMapAndItsUncertainty) {
  Eigen::VectorXd change(static_cast<Index>(count));
  RandomStream random(4, 4);
  for (Index i = 0; i < change.size(); ++i) change[i] = 0.2 * unit_of(i) * random.normal();
  const ErrorMap map = deviation_of(change);
  const ParameterCovariance covariance = covariance_of(count, 1);
  const DeterminedPart part =
      determined_part(machine, identified, covariance, Eigen::MatrixXd(change.size(), 0), poses, map);
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.covariance = &covariance;
  const ErrorMap predicted = error_map(machine, identified, nullptr, source, options);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(part.displacement[c][k], map.displacement[c][k], 1e-6);
      EXPECT_NEAR(part.uncertainty[c][k], predicted.uncertainty[c][k], 1e-6 * predicted.uncertainty[c][k]);
      EXPECT_EQ(part.open[c][k], 0);
    }
  }
}

TEST_F(DeterminedParts, AnErrorThatCannotReachTheFunctionalPointIsNotOpen) {
  // The roll of Z about the axis through the functional point: 0.01 mm of tool offset error are no lever.
  identified.tool_offset_error = {0.01, 0, 0};
  Eigen::MatrixXd roll = Eigen::MatrixXd::Zero(static_cast<Index>(count), 1);
  roll(static_cast<Index>(parameter(2, Component::C, 1)), 0) = 1;
  const ErrorMap map = deviation_of(Eigen::VectorXd::Zero(static_cast<Index>(count)));
  const auto open = [&] {
    return determined_part(machine, identified, covariance_of(count, 1), roll, poses, map).open_rank;
  };
  EXPECT_EQ(open(), 0u);
  machine.tool_offset = {100, 0, -120};
  EXPECT_EQ(open(), 1u);
}

TEST_F(DeterminedParts, OpenDirectionsAloneAreTheSame) {
  // Reversal values, which poses with an approach displace in their own way, take part in two directions.
  identified.reversals = {{0, 2e-3}, {2, 1e-3}};
  count = identified.parameter_count();
  RandomStream random(8, 1);
  for (std::vector<std::int8_t>& side : poses.approach = std::vector<std::vector<std::int8_t>>(3)) {
    for (std::size_t k = 0; k < poses.count(); ++k) side.push_back(random.uniform() < 0.5 ? -1 : 1);
  }
  const Index rows = static_cast<Index>(count);
  Eigen::MatrixXd some = Eigen::MatrixXd::Zero(rows, 6);
  some.topLeftCorner(36, 3) = unseen.topRows(36);
  some(static_cast<Index>(parameter(1, Component::A, 1)), 2) = 1e-13;  // rounding
  some(static_cast<Index>(first_reversal(identified)), 3) = 1;
  some.col(4) = some.col(0) + some.col(1) + 1e-3 * some.col(3);
  some(static_cast<Index>(parameter(1, Component::B, 1)), 5) = -1;
  std::vector<std::size_t> parameters(count);
  for (std::size_t p = 0; p < parameters.size(); ++p) parameters[p] = p;
  ErrorMap map = deviation_of(Eigen::VectorXd::Zero(rows));
  map.covered[3] = 0;
  const DeterminedPart part = determined_part(machine, identified, covariance_of(count, 1), some, poses, map);
  const OpenDirections open = open_directions(machine, identified, parameters, some, poses, map.covered);
  EXPECT_EQ(part.open_directions, (std::vector<std::size_t>{0, 3, 4, 5}));
  EXPECT_EQ(open.directions, part.open_directions);
  EXPECT_EQ(open.rank, part.open_rank);
  EXPECT_EQ(open.rank, 3u);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(rows, 2);
  EXPECT_EQ(open_directions(machine, identified, parameters, none, poses, map.covered).rank, 0u);
  EXPECT_THROW(open_directions(machine, identified, {1, 2}, none, poses, map.covered), std::invalid_argument);
}

TEST_F(DeterminedParts, PosesOutsideTheKnownRangeTakeNoPart) {
  ErrorMap map = deviation_of(unseen.col(0) * 20e-6);
  map.covered[7] = 0;
  map.displacement[0][7] = 1e6;
  const DeterminedPart part = determined_part(machine, identified, covariance_of(count, 1), unseen, poses, map);
  EXPECT_EQ(part.displacement[0][7], 0);
  EXPECT_EQ(part.uncertainty[0][7], 0);
  EXPECT_NEAR(part.displacement[0][8], 0, 2e-6);
  EXPECT_THROW(determined_part(machine, identified, covariance_of(count, 1), Eigen::MatrixXd::Zero(3, 1), poses, map),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
