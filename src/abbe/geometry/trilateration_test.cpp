#include "abbe/geometry/trilateration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

struct Room {
  TrilaterationData data;
  Vector3d station = {-900, 650, -300};
  std::vector<double> dead_path;
};

/// Points in a box of given size, lengths in runs with dead paths, each length with a uniform error.
Room room(std::size_t count, const Vector3d& size, std::size_t runs, double error, unsigned seed = 5) {
  Room result;
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t r = 0; r < runs; ++r) result.dead_path.push_back(400 + 130.0 * static_cast<double>(r));
  result.data.dead_path.resize(runs);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d point(size.x() * unit(generator), size.y() * unit(generator), size.z() * unit(generator));
    const std::size_t run = i * runs / count;
    result.data.points.push_back(point);
    result.data.run.push_back(run);
    result.data.lengths.push_back((point - result.station).norm() - result.dead_path[run] +
                                  error * (2 * unit(generator) - 1));
  }
  return result;
}

/// Standard uncertainty of the position, largest direction, for lengths with standard uncertainty 1.
double dilution(const Room& room, bool without_thirds = false) {
  const Eigen::Index runs = static_cast<Eigen::Index>(room.dead_path.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 + runs, 3 + runs);
  for (std::size_t i = 0; i < room.data.points.size(); ++i) {
    if (without_thirds && i % 3 == 0) continue;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(3 + runs);
    row.head<3>() = (room.station - room.data.points[i]).normalized();
    row[3 + static_cast<Eigen::Index>(room.data.run[i])] = -1;
    normal += row * row.transpose();
  }
  const Eigen::MatrixXd covariance = PartialLu(normal).inverse();
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
}

TEST(Trilateration, FindsPositionAndDeadPathsFromLengthsAlone) {
  const Room exact = room(40, {700, 400, 450}, 3, 0);
  const Trilateration found = trilaterate(exact.data);
  ASSERT_EQ(found.status, TrilaterationStatus::ok);
  EXPECT_LT((found.position - exact.station).norm(), 1e-6);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR(found.dead_path[r], exact.dead_path[r], 1e-6);
  EXPECT_LT(found.rms, 1e-8);
}

TEST(Trilateration, StaysNearWhenTheMachineIsNotNominal) {
  const Room rough = room(60, {700, 400, 450}, 2, 0.1);
  const Trilateration found = trilaterate(rough.data);
  ASSERT_EQ(found.status, TrilaterationStatus::ok);
  EXPECT_LT((found.position - rough.station).norm(), 2.5 * 0.058 * dilution(rough));
  EXPECT_NEAR(found.rms, 0.1 / std::sqrt(3.0), 0.02);
}

TEST(Trilateration, LeavesOutAThirdOfWrongLengths) {
  Room rough = room(60, {700, 400, 450}, 1, 0.02);
  for (std::size_t i = 0; i < 60; i += 3) rough.data.lengths[i] += i % 2 == 0 ? 40 : -7;
  const Trilateration found = trilaterate(rough.data);
  ASSERT_EQ(found.status, TrilaterationStatus::ok);
  EXPECT_LT((found.position - rough.station).norm(), 2.5 * 0.0116 * dilution(rough, true));
  for (std::size_t i = 0; i < 60; i += 3) EXPECT_EQ(found.inliers[i], 0) << i;
}

TEST(Trilateration, KnownDeadPathsNeedOneLengthLess) {
  Room exact = room(4, {700, 400, 450}, 1, 0);
  EXPECT_EQ(trilaterate(room(3, {700, 400, 450}, 1, 0).data).status, TrilaterationStatus::too_few_points);
  exact.data.dead_path[0] = exact.dead_path[0];
  const Trilateration found = trilaterate(exact.data);
  ASSERT_EQ(found.status, TrilaterationStatus::ok);
  EXPECT_LT((found.position - exact.station).norm(), 1e-6);
}

TEST(Trilateration, SaysThatPointsInAPlaneLeaveTheSideOpenAndGivesBothPositions) {
  for (const double error : {0.0, 0.05}) {
    Room flat = room(50, {700, 400, 0}, 1, error);
    Trilateration found = trilaterate(flat.data);
    ASSERT_EQ(found.status, TrilaterationStatus::mirrored);
    EXPECT_NEAR(std::abs(found.direction.z()), 1, 1e-12);
    const Vector3d mirrored = flat.station.cwiseProduct(Vector3d(1, 1, -1));
    const double tolerance = error > 0 ? 2 : 1e-5;
    const bool same = found.position.z() < 0;
    EXPECT_LT((found.position - (same ? flat.station : mirrored)).norm(), tolerance);
    EXPECT_LT((found.other - (same ? mirrored : flat.station)).norm(), tolerance);
    for (const double side : {-1.0, 1.0}) {
      flat.data.near = Vector3d(0, 0, 50 * side);
      found = trilaterate(flat.data);
      ASSERT_EQ(found.status, TrilaterationStatus::mirrored);
      EXPECT_GT(found.position.z() * side, 0);
      EXPECT_LT(found.other.z() * side, 0);
    }
  }
}

TEST(Trilateration, AStationInThePlaneOfThePointsHasNoMirrorImage) {
  Room flat = room(50, {700, 400, 0}, 1, 0);
  flat.station.z() = 0;
  for (std::size_t i = 0; i < 50; ++i) {
    flat.data.lengths[i] = (flat.data.points[i] - flat.station).norm() - flat.dead_path[0];
  }
  const Trilateration found = trilaterate(flat.data);
  // The height enters quadratically: known to the root of the rounding only.
  EXPECT_EQ(found.status, TrilaterationStatus::ok);
  EXPECT_LT((found.position - flat.station).norm(), 0.05);
}

TEST(Trilateration, SaysWhatLinesAndContradictionsDoNotDetermine) {
  const Trilateration line = trilaterate(room(20, {700, 0, 0}, 1, 0).data);
  EXPECT_EQ(line.status, TrilaterationStatus::collinear);
  EXPECT_NEAR(std::abs(line.direction.x()), 1, 1e-12);
  Room mixed = room(40, {700, 400, 450}, 1, 0);
  std::mt19937_64 generator(3);
  std::shuffle(mixed.data.lengths.begin(), mixed.data.lengths.end(), generator);
  EXPECT_EQ(trilaterate(mixed.data).status, TrilaterationStatus::no_consensus);
  mixed.data.run.pop_back();
  EXPECT_THROW(trilaterate(mixed.data), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
