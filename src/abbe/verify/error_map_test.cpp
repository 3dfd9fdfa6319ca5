#include "abbe/verify/error_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/kept_blocks_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

Machine machine() {
  Machine m;
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  c.point = {700, 0, -100};
  c.travel_max = 2 * std::numbers::pi;
  Axis x{.name = "X", .kind = AxisKind::linear, .side = ChainSide::workpiece, .primed = true};
  x.travel_max = 1400;
  Axis z{.name = "Z", .kind = AxisKind::linear, .side = ChainSide::tool};
  z.direction = Eigen::Vector3d::UnitZ();
  z.travel_max = 600;
  Axis a{.name = "A", .kind = AxisKind::rotary, .side = ChainSide::tool};
  a.point = {0, 0, 300};
  a.travel_min = -1.5;
  a.travel_max = 1.5;
  m.axes = {c, x, z, a};
  m.bed_from_workpiece = {rotation_about(Eigen::Vector3d::UnitX(), 0.3), {700, 0, -100}};
  m.tool_reference = {0, 0, 300};
  m.tool_offset = {0, 0, -120};
  return m;
}

ErrorSet errors_of(std::uint64_t seed) {
  RandomErrorOptions options;
  options.seed = seed;
  ErrorSet errors = random_errors(machine(), options);
  errors.tool_offset_error = {0.003, -0.002, 0.005};
  return errors;
}

PoseList random_poses(std::size_t count, std::uint64_t seed) {
  PoseList poses;
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(seed, k);
    poses.append({random.uniform(0, 6), random.uniform(0, 1400), random.uniform(0, 600), random.uniform(-1.5, 1.5)});
  }
  return poses;
}

Eigen::Vector3d at(const std::array<std::vector<double>, 3>& p, std::size_t k) { return {p[0][k], p[1][k], p[2][k]}; }

TEST(ErrorMap, AgreesWithSinglePosesOfAnotherRoute) {
  const PoseList poses = random_poses(300, 1);
  const ErrorSet errors = errors_of(1);
  const ErrorMap map = error_map(machine(), errors, nullptr, pose_source(poses));
  ASSERT_EQ(map.count(), 300u);
  double sum = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    Deviation deviation;
    ASSERT_EQ(tool_deviation(machine(), errors, poses.pose(k), deviation), PoseStatus::ok);
    EXPECT_LT((at(map.displacement, k) - deviation.head<3>()).norm(), 1e-10);
    EXPECT_LT((at(map.rotation, k) - deviation.tail<3>()).norm(), 1e-13);
    EXPECT_LT((at(map.point, k) - nominal_workpiece_from_tool(machine(), poses.pose(k)).translation).norm(), 1e-10);
    EXPECT_NEAR(map.norm[k], deviation.head<3>().norm(), 1e-10);
    sum += deviation.head<3>().norm() / 300;
  }
  EXPECT_NEAR(map.statistics.mean, sum, 1e-12);
}

TEST(ErrorMap, TruthMinusItselfIsNothingAndMinusTheIdentifiedIsTheRest) {
  const PoseList poses = random_poses(100, 2);
  const ErrorSet truth = errors_of(1), identified = errors_of(2);
  EXPECT_LT(error_map(machine(), truth, &truth, pose_source(poses)).statistics.maximum, 1e-12);
  const ErrorMap rest = error_map(machine(), truth, &identified, pose_source(poses));
  for (std::size_t k = 0; k < 100; ++k) {
    const RigidTransform a = actual_workpiece_from_tool(machine(), truth, poses.pose(k));
    const RigidTransform b = actual_workpiece_from_tool(machine(), identified, poses.pose(k));
    EXPECT_LT((at(rest.displacement, k) - (a.translation - b.translation)).norm(), 1e-10);
    EXPECT_LT((at(rest.rotation, k) - rotation_vector(a.rotation * b.rotation.transpose())).norm(), 1e-13);
  }
}

TEST(ErrorMap, LargeRotationsAreExactToo) {
  ErrorSet errors = errors_of(3);
  for (ErrorMotion& motion : errors.motions) {
    if (is_rotation(motion.component)) motion.coefficients[1] += 0.2;
  }
  const PoseList poses = random_poses(50, 3);
  const ErrorMap map = error_map(machine(), errors, nullptr, pose_source(poses));
  for (std::size_t k = 0; k < 50; ++k) {
    Deviation deviation;
    tool_deviation(machine(), errors, poses.pose(k), deviation);
    EXPECT_LT((at(map.rotation, k) - deviation.tail<3>()).norm(), 1e-12);
  }
}

TEST(ErrorMap, RemovingTheRigidMotionTakesOutExactlyAShiftedWorkpieceDatum) {
  const PoseList poses = random_poses(5000, 4);
  const ErrorSet errors = errors_of(1);
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  const ErrorMap map = error_map(machine(), errors, nullptr, pose_source(poses), options);
  const ErrorMap all = error_map(machine(), errors, nullptr, pose_source(poses));
  EXPECT_LT(map.statistics.rms, 0.98 * all.statistics.rms);
  // Nothing of a rigid motion is left: forces and moments of the displacements vanish.
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < poses.count(); ++k) {
    force += at(map.displacement, k) / 5000;
    moment += at(map.point, k).cross(at(map.displacement, k)) / 5000;
  }
  EXPECT_LT(force.norm(), 1e-10);
  EXPECT_LT(moment.norm(), 1e-6);

  // Another datum of the workpiece: the reference displaced by a rigid motion leaves the same.
  Machine moved = machine();
  const RigidTransform shift{rotation_from_vector({1e-2, -2e-2, 5e-3}), {3, -4, 5}};
  moved.bed_from_workpiece = moved.bed_from_workpiece * shift;
  const ErrorMap other = error_map(moved, errors, nullptr, pose_source(poses), options);
  for (std::size_t k = 0; k < poses.count(); k += 100) EXPECT_NEAR(other.norm[k], map.norm[k], 1e-9);
}

TEST(ErrorMap, UncertaintyAgreesWithDrawnParameters) {
  const Machine m = machine();
  const ErrorSet errors = errors_of(1);
  const PoseList poses = random_poses(150, 5);
  // A correlated covariance of some parameters, mm and rad mixed, the tool offset among them.
  ParameterCovariance covariance;
  const std::vector<bool> angles = parameters_are_angles(m, errors);
  for (std::size_t i = 0; i < errors.parameter_count(); i += 9) covariance.parameters.push_back(i);
  covariance.parameters.push_back(errors.parameter_count() - 2);
  const Eigen::Index n = static_cast<Eigen::Index>(covariance.parameters.size());
  Eigen::MatrixXd root(n, n);
  RandomStream random(6);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      root(i, j) = random.normal() * (angles[covariance.parameters[static_cast<std::size_t>(i)]] ? 1e-6 : 1e-3);
    }
  }
  covariance.covariance = root * root.transpose();
  for (const bool remove : {false, true}) {
    ErrorMapOptions options;
    options.covariance = &covariance;
    options.remove_rigid_motion = remove;
    const ErrorMap map = error_map(m, errors, nullptr, pose_source(poses), options);
    ErrorMapOptions plain;
    plain.remove_rigid_motion = remove;
    const int draws = 1500;
    std::vector<Eigen::Matrix<double, 7, 1>> squares(poses.count(), Eigen::Matrix<double, 7, 1>::Zero());
    for (int draw = 0; draw < draws; ++draw) {
      std::vector<double> values = errors.parameters();
      Eigen::VectorXd normal(n);
      for (Eigen::Index i = 0; i < n; ++i) normal[i] = random.normal();
      const Eigen::VectorXd change = root * normal;
      for (Eigen::Index i = 0; i < n; ++i) values[covariance.parameters[static_cast<std::size_t>(i)]] += change[i];
      ErrorSet drawn = errors;
      drawn.set_parameters(values);
      const ErrorMap one = error_map(m, drawn, nullptr, pose_source(poses), plain);
      for (std::size_t k = 0; k < poses.count(); ++k) {
        Eigen::Matrix<double, 7, 1> d;
        d << at(one.displacement, k) - at(map.displacement, k), at(one.rotation, k) - at(map.rotation, k),
            (at(one.displacement, k) - at(map.displacement, k)).dot(at(map.displacement, k)) / map.norm[k];
        squares[k] += d.cwiseAbs2() / draws;
      }
    }
    // One standard uncertainty from 1500 draws is known to 1.8 %; the mean over poses and the worst of them.
    double mean_ratio = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      for (std::size_t c = 0; c < 7; ++c) {
        const double stated = c < 6 ? map.uncertainty[c][k] : map.norm_uncertainty[k];
        const double ratio = std::sqrt(squares[k][static_cast<int>(c)]) / stated;
        EXPECT_NEAR(ratio, 1, 0.12) << "pose " << k << " component " << c << (remove ? " removed" : "");
        mean_ratio += ratio / static_cast<double>(7 * poses.count());
      }
    }
    EXPECT_NEAR(mean_ratio, 1, 0.03);
  }
}

TEST(ErrorMap, RefusesACovarianceThatIsNone) {
  const PoseList poses = random_poses(5, 1);
  const ErrorSet errors = errors_of(1);
  ParameterCovariance covariance{{0, 1}, Eigen::MatrixXd::Identity(2, 2)};
  covariance.covariance(0, 1) = covariance.covariance(1, 0) = 2;
  ErrorMapOptions options;
  options.covariance = &covariance;
  EXPECT_THROW(error_map(machine(), errors, nullptr, pose_source(poses), options), std::invalid_argument);
  covariance = {{0, 100000}, Eigen::MatrixXd::Identity(2, 2)};
  EXPECT_THROW(error_map(machine(), errors, nullptr, pose_source(poses), options), std::invalid_argument);
}

TEST(ErrorMap, PosesOutsideTheMeasuredRangeAreMarkedAndNotCounted) {
  PoseList poses = random_poses(10, 6);
  poses.axis[1][3] = 1401;
  const ErrorMap map = error_map(machine(), errors_of(1), nullptr, pose_source(poses));
  EXPECT_EQ(map.covered[3], 0);
  EXPECT_EQ(map.statistics.excluded, 1u);
  EXPECT_EQ(map.statistics.count, 9u);
}

TEST(ErrorMap, StreamIsTheSameWithAnyNumberOfThreads) {
  const PoseGrid grid{
      {evenly_spaced(0, 6, 9), evenly_spaced(0, 1400, 13), evenly_spaced(0, 600, 11), evenly_spaced(-1, 1, 7)}};
  ErrorMapOptions one, three;
  one.remove_rigid_motion = three.remove_rigid_motion = true;
  one.threads = 1;
  three.threads = 3;
  std::size_t last = 0;
  one.progress = [&last](std::size_t done, std::size_t total) {
    EXPECT_GT(done, last);
    EXPECT_EQ(total, 2u * 9009);
    last = done;
  };
  const ErrorMap a = error_map(machine(), errors_of(1), nullptr, pose_source(grid), one);
  const ErrorMap b = error_map(machine(), errors_of(1), nullptr, pose_source(grid), three);
  EXPECT_EQ(last, 2u * 9009);
  EXPECT_EQ(a.norm, b.norm);
  EXPECT_EQ(a.statistics.mean, b.statistics.mean);
}

TEST(ErrorMap, DoesNotDependOnTheBedFrame) {
  const PoseList poses = random_poses(50, 7);
  Machine moved = machine();
  ErrorSet errors = errors_of(1);
  const Eigen::Vector3d shift(100, 200, -300);
  for (Axis& axis : moved.axes) axis.point += shift;
  moved.tool_reference += shift;
  moved.bed_from_workpiece.translation += shift;
  const ErrorMap a = error_map(machine(), errors, nullptr, pose_source(poses));
  const ErrorMap b = error_map(moved, errors, nullptr, pose_source(poses));
  for (std::size_t k = 0; k < 50; ++k) EXPECT_LT((at(a.displacement, k) - at(b.displacement, k)).norm(), 1e-10);
}

TEST(ErrorMap, ResultsOfBlocksCanComeFromElsewhere) {
  const PoseList poses = random_poses(10000, 7);
  const ErrorSet errors = errors_of(1), other = errors_of(2);
  ParameterCovariance covariance;
  covariance.parameters = {3, 4, 10};
  covariance.covariance = Eigen::Vector3d(1e-6, 2e-6, 1e-6).asDiagonal();
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  options.covariance = &covariance;
  const ErrorMap alone = error_map(machine(), errors, nullptr, pose_source(poses), options);
  test::KeptBlocks kept;
  options.work = kept.keeping();
  error_map(machine(), errors, nullptr, pose_source(poses), options);
  options.work = kept.giving();
  const ErrorMap given = error_map(machine(), errors, nullptr, pose_source(poses), options);
  EXPECT_EQ(given.point, alone.point);
  EXPECT_EQ(given.displacement, alone.displacement);
  EXPECT_EQ(given.rotation, alone.rotation);
  EXPECT_EQ(given.norm, alone.norm);
  EXPECT_EQ(given.uncertainty, alone.uncertainty);
  EXPECT_EQ(given.norm_uncertainty, alone.norm_uncertainty);
  EXPECT_EQ(given.covered, alone.covered);
  EXPECT_EQ(given.statistics.mean, alone.statistics.mean);

  // Other inputs, other fingerprints: both passes of each map.
  options.work = kept.keeping();
  error_map(machine(), other, nullptr, pose_source(poses), options);
  error_map(machine(), errors, &other, pose_source(poses), options);
  const PoseList moved = random_poses(10000, 8);
  error_map(machine(), errors, nullptr, pose_source(moved), options);
  covariance.covariance(1, 1) *= 2;
  error_map(machine(), errors, nullptr, pose_source(poses), options);
  Machine longer = machine();
  longer.tool_offset.z() += 1;
  error_map(longer, errors, nullptr, pose_source(poses), options);
  ASSERT_EQ(kept.fingerprints.size(), 12u);
  EXPECT_EQ(std::set<std::uint64_t>(kept.fingerprints.begin(), kept.fingerprints.end()).size(), 12u);
}

TEST(ErrorShares, AddUpToOneAndASingleKindHasAll) {
  const PoseList poses = random_poses(2000, 8);
  ErrorSet errors = errors_of(1);
  double sum = 0;
  for (const ErrorShare& share : shares_by_kind(machine(), errors, pose_source(poses))) sum += share.share;
  EXPECT_NEAR(sum, 1, 0.01);
  sum = 0;
  for (const ErrorShare& share : shares_by_axis(machine(), errors, pose_source(poses))) sum += share.share;
  // The tool offset error belongs to no axis.
  EXPECT_NEAR(sum, 1, 0.05);

  ErrorSet only;
  for (const ErrorMotion& motion : errors.motions) {
    if (is_rotation(motion.component)) only.motions.push_back(motion);
  }
  const std::vector<ErrorShare> shares = shares_by_kind(machine(), only, pose_source(poses));
  EXPECT_EQ(shares[0].share, 0);
  EXPECT_NEAR(shares[1].share, 1, 1e-12);
  EXPECT_NEAR(shares[1].mean, error_map(machine(), only, nullptr, pose_source(poses)).statistics.mean, 1e-12);
}

}  // namespace
}  // namespace abbe
