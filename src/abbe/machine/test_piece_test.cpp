#include "abbe/machine/test_piece.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

double distance_to_axis(const CurvePoint& tool, const Vector3d& point) {
  return (point - tool.point).cross(tool.direction).norm();
}

/// The tool's centre leaves the chord between two points by at most this, from three neighbouring points.
double sagitta(const Curve& curve, std::size_t k) {
  const Vector3d chord = curve.points[k + 1].point - curve.points[k - 1].point;
  const Vector3d to = curve.points[k].point - curve.points[k - 1].point;
  // Over two pieces the sagitta is four times that of one.
  return to.cross(chord).norm() / chord.norm() / 4;
}

TEST(TestPiece, TheToolTouchesTheConeAndCutsNothingOfIt) {
  ConeFrustum given;
  given.lean_azimuth = 0.7;
  given.inclination = 30 * kDegree;
  const TestPiece piece = cone_frustum(given);
  ASSERT_EQ(piece.rulings.size(), piece.curve.points.size());
  EXPECT_EQ((piece.rulings.front().foot - piece.rulings.back().foot).norm(), 0);
  for (std::size_t tool = 0; tool < piece.rulings.size(); tool += 23) {
    for (std::size_t k = 0; k < piece.rulings.size(); ++k) {
      const Ruling& ruling = piece.rulings[k];
      for (const double h : {0.0, 0.3, 1.0}) {
        const double distance =
            distance_to_axis(piece.curve.points[tool], ruling.foot + h * (ruling.head - ruling.foot));
        EXPECT_GE(distance, piece.tool_radius - 1e-9);
        if (k == tool) {
          EXPECT_NEAR(distance, piece.tool_radius, 1e-9);
        }
      }
    }
  }
}

TEST(TestPiece, TheConeHasTheAnglesAndDiametersAskedFor) {
  ConeFrustum given;
  given.base_diameter = 100;
  given.half_apex_angle = 20 * kDegree;
  given.inclination = 10 * kDegree;
  given.lean_azimuth = 90 * kDegree;
  const TestPiece piece = cone_frustum(given);
  const Vector3d axis(0, std::sin(10 * kDegree), std::cos(10 * kDegree));
  for (const Ruling& ruling : piece.rulings) {
    EXPECT_NEAR((ruling.foot - given.base_centre).norm(), 50, 1e-10);
    EXPECT_NEAR((ruling.foot - given.base_centre).dot(axis), 0, 1e-10);
    EXPECT_NEAR((ruling.head - given.base_centre).dot(axis), given.height, 1e-10);
    EXPECT_NEAR((ruling.head - ruling.foot).normalized().dot(axis), std::cos(20 * kDegree), 1e-12);
    EXPECT_NEAR(ruling.foot_normal.dot(ruling.head - ruling.foot), 0, 1e-10);
  }
}

TEST(TestPiece, NormalsOfTheWallAreThoseOfItsSurface) {
  SShape given;
  given.azimuth = 0.4;
  given.chord_tolerance = 1e-5;
  const TestPiece piece = s_shape(given);
  const std::size_t count = piece.rulings.size();
  ASSERT_GT(count, 1000U);
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const Ruling &before = piece.rulings[k - 1], &ruling = piece.rulings[k], &after = piece.rulings[k + 1];
    const Vector3d along = ruling.head - ruling.foot;
    EXPECT_NEAR((after.foot - before.foot).cross(along).normalized().dot(ruling.foot_normal), 1, 1e-8);
    EXPECT_NEAR((after.head - before.head).cross(along).normalized().dot(ruling.head_normal), 1, 1e-8);
    EXPECT_NEAR(along.z(), given.height, 1e-10);
  }
}

TEST(TestPiece, TheWallLeansToBothSidesAndIsCutAlongItsFootAndHead) {
  const SShape given;
  const TestPiece piece = s_shape(given);
  double least = 1, most = -1, undercut = 0;
  for (const Ruling& ruling : piece.rulings) {
    const Vector3d out = (ruling.foot_normal - ruling.foot_normal.z() * Vector3d::UnitZ()).normalized();
    const Vector3d along = ruling.head - ruling.foot;
    const double lean = std::atan2(along.dot(out), along.z());
    least = std::min(least, lean);
    most = std::max(most, lean);
  }
  // lean cos + twist sin has the amplitude sqrt(lean^2 + twist^2).
  const double amplitude = std::hypot(given.lean, given.twist);
  EXPECT_NEAR(most, amplitude, 2e-3);
  EXPECT_NEAR(least, -amplitude, 2e-3);
  for (std::size_t k = 0; k < piece.rulings.size(); ++k) {
    const Ruling& ruling = piece.rulings[k];
    for (const double h : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const Vector3d point = ruling.foot + h * (ruling.head - ruling.foot);
      undercut = std::max(undercut, piece.tool_radius - distance_to_axis(piece.curve.points[k], point));
    }
  }
  EXPECT_LT(undercut, 0.25);
}

TEST(TestPiece, PointsAreAsCloseAsTheToleranceAsks) {
  for (const double tolerance : {0.01, 0.0005}) {
    ConeFrustum frustum;
    frustum.chord_tolerance = tolerance;
    SShape shape;
    shape.chord_tolerance = tolerance;
    for (const TestPiece& piece : {cone_frustum(frustum), s_shape(shape)}) {
      double largest = 0;
      for (std::size_t k = 1; k + 1 < piece.curve.points.size(); ++k) {
        largest = std::max(largest, sagitta(piece.curve, k));
      }
      EXPECT_LT(largest, 1.01 * tolerance);
      EXPECT_GT(largest, 0.1 * tolerance);
    }
  }
}

TEST(TestPiece, ATrunnionMillFollowsBothWithAllAxesInMotion) {
  const Machine machine = test::trunnion_mill();
  for (const TestPiece& piece : {cone_frustum({}), s_shape({})}) {
    const ToolPath path = plan_tool_path(machine, piece.curve);
    ASSERT_EQ(path.status, ToolPathStatus::followed) << path.message;
    EXPECT_TRUE(path.working_jumps.empty());
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      double least = 1e9, most = -1e9;
      for (const ToolPathStep& step : path.steps) {
        least = std::min(least, step.command[axis]);
        most = std::max(most, step.command[axis]);
      }
      EXPECT_GT(most - least, machine.axes[axis].kind == AxisKind::rotary ? 0.1 : 5.0) << machine.axes[axis].name;
    }
  }
}

TEST(TestPiece, MorePointsThanAnybodyWantsAreRefused) {
  ConeFrustum frustum;
  frustum.chord_tolerance = 1e-12;
  EXPECT_THROW(cone_frustum(frustum), std::invalid_argument);
  frustum.chord_tolerance = 1e-300;  // the angle of a chord is zero then
  EXPECT_THROW(cone_frustum(frustum), std::invalid_argument);
  frustum = {};
  frustum.base_diameter = 1e300;
  EXPECT_THROW(cone_frustum(frustum), std::invalid_argument);
  SShape shape;
  shape.chord_tolerance = 1e-12;
  EXPECT_THROW(s_shape(shape), std::invalid_argument);
  shape = {};
  shape.length = 1e300;
  EXPECT_THROW(s_shape(shape), std::invalid_argument);
}

TEST(TestPiece, SizesThatMakeNoPieceAreRefused) {
  ConeFrustum frustum;
  frustum.height = 150;
  EXPECT_THROW(cone_frustum(frustum), std::invalid_argument);
  frustum = {};
  frustum.tool_radius = 0;
  EXPECT_THROW(cone_frustum(frustum), std::invalid_argument);
  SShape shape;
  shape.tool_radius = 20;
  EXPECT_THROW(s_shape(shape), std::invalid_argument);
  shape = {};
  shape.twist = 1;
  EXPECT_THROW(s_shape(shape), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
