#include "abbe/verify/parts/test_piece_deviation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/machine/tool_path.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kChord = 1e-3;     // of the programs, mm
constexpr double kFine = 1e-5;      // of the pieces that they are compared with
constexpr double kStraight = 5e-5;  // of the moves between two points of a program

/// What a control commands while it runs the tool path of a piece: from 15 mm above its first point down, along it,
/// and up again, in steps of about 0.05 mm.
PoseList trace_of(const Machine& machine, const TestPiece& piece) {
  ToolPathOptions options;
  options.retract = 15;
  options.tolerance = kStraight;
  const ToolPath path = plan_tool_path(machine, piece.curve, options);
  EXPECT_EQ(path.status, ToolPathStatus::followed);
  PoseList trace;
  trace.axis.resize(machine.axes.size());
  for (std::size_t n = 0; n + 1 < path.steps.size(); ++n) {
    const auto& from = path.steps[n].command;
    const auto& to = path.steps[n + 1].command;
    const RigidTransform a = nominal_workpiece_from_tool(machine, std::span(from).first(machine.axes.size()));
    const RigidTransform b = nominal_workpiece_from_tool(machine, std::span(to).first(machine.axes.size()));
    const int count = std::max(1, static_cast<int>(std::ceil((a.translation - b.translation).norm() / 0.05)));
    for (int k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        trace.axis[i].push_back(from[i] + (to[i] - from[i]) * k / count);
      }
    }
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) trace.axis[i].push_back(path.steps.back().command[i]);
  return trace;
}

template <typename Piece>
Piece with_tolerance(Piece piece, double tolerance) {
  piece.chord_tolerance = tolerance;
  return piece;
}

class TestPieceDeviations : public testing::Test {
 protected:
  // Made once for all tests.
  static const Machine& the_machine() {
    static const Machine machine = test::trunnion_mill();
    return machine;
  }
  static const PoseList& trace(bool is_cone) {
    static const PoseList of_cone = trace_of(the_machine(), cone_frustum(with_tolerance(ConeFrustum{}, kChord)));
    static const PoseList of_s = trace_of(the_machine(), s_shape(with_tolerance(SShape{}, kChord)));
    return is_cone ? of_cone : of_s;
  }

  const Machine& machine = the_machine();
  const PoseList &cone_trace = trace(true), &s_trace = trace(false);
  TestPiece cone = cone_frustum(with_tolerance(ConeFrustum{}, kFine));
  TestPiece s = s_shape(with_tolerance(SShape{}, kFine));

  /// Displacement of the tool in the workpiece frame when the axis X stands 1 mm too far, at a sample.
  Vector3d by_x(const PoseList& run, std::size_t row) const {
    return nominal_bed_from_workpiece(machine, run.pose(row)).rotation.transpose() * Vector3d::UnitX();
  }
};

void expect_whole_cut(const PieceDeviation& cut, std::size_t samples) {
  ASSERT_EQ(cut.status, PieceTraceStatus::done);
  EXPECT_NEAR(cut.reached, cut.length, 1e-3);
  EXPECT_LT(cut.along.front(), 0.1);
  // All but the 15 mm down and up.
  EXPECT_GT(cut.rows.size(), samples - 2 * 300 - 10);
  EXPECT_TRUE(std::is_sorted(cut.along.begin(), cut.along.end()));
  for (std::size_t k = 1; k < cut.rows.size(); ++k) EXPECT_EQ(cut.rows[k], cut.rows[k - 1] + 1);
}

TEST_F(TestPieceDeviations, APerfectMachineLeavesTheChordsOfItsProgramOnly) {
  for (const bool is_cone : {true, false}) {
    const TestPiece& piece = is_cone ? cone : s;
    const PieceDeviation cut = test_piece_deviation(piece, actual_tool(machine, ErrorSet{}, trace(is_cone)));
    expect_whole_cut(cut, trace(is_cone).count());
    const PieceFigures figures = piece_figures(cut, false);
    // Lines between points at kChord at most, seen on a piece with lines of kFine; the foot runs with the tool's end.
    EXPECT_LT(figures.foot.largest(), kChord + 2 * kStraight);
    EXPECT_GT(figures.foot.largest(), 0.5 * kChord);
    EXPECT_LT(figures.contour.largest, kChord + 2 * kStraight);
    EXPECT_LT(figures.head.largest(), 3 * kChord);
    if (is_cone) {
      // Chords of a circle lie inside, where more of the material is taken away.
      EXPECT_LT(figures.foot.lowest, -0.9 * kChord);
      EXPECT_LT(figures.foot.highest, 2 * kStraight);
    }
  }
}

TEST_F(TestPieceDeviations, ADisplacedWorkpieceIsSeenAlongTheNormalsAndTakenOutByTheBestFit) {
  const Vector3d shift(0.03, -0.05, 0.02), turn(2e-4, -1e-4, 3e-4);
  for (const bool is_cone : {true, false}) {
    ToolPlaces tool = actual_tool(machine, ErrorSet{}, is_cone ? cone_trace : s_trace);
    const PieceDeviation still = test_piece_deviation(is_cone ? cone : s, tool);
    for (Index k = 0; k < tool.point.cols(); ++k) {
      tool.point.col(k) += shift + turn.cross(tool.point.col(k));
      tool.direction.col(k) = (tool.direction.col(k) + turn.cross(tool.direction.col(k))).normalized();
    }
    const PieceDeviation cut = test_piece_deviation(is_cone ? cone : s, tool);
    ASSERT_EQ(cut.status, PieceTraceStatus::done);
    double largest = 0;
    for (std::size_t n = 0; n < cut.rows.size(); n += 7) {
      const auto k = static_cast<Index>(n);
      // The tool touches at the surface, and a normal turns about itself there: its radius takes no part.
      EXPECT_NEAR(cut.foot[n], cut.foot_normal.col(k).dot(shift + turn.cross(cut.foot_point.col(k))), 1.5e-3);
      EXPECT_NEAR(cut.head[n], cut.head_normal.col(k).dot(shift + turn.cross(cut.head_point.col(k))), 3.5e-3);
      largest = std::max(largest, std::abs(cut.foot[n]));
    }
    EXPECT_GT(largest, 0.04);
    const PieceFigures left = piece_figures(cut, true), nothing = piece_figures(still, true);
    EXPECT_NEAR(left.foot.range(), nothing.foot.range(), 1e-4);
    EXPECT_NEAR(left.head.range(), nothing.head.range(), 1e-4);
    EXPECT_NEAR(left.contour.largest, nothing.contour.largest, 1e-4);
    EXPECT_EQ(left.datum.rank, is_cone ? 5 : 6);  // a cone may turn about its axis
  }
}

TEST_F(TestPieceDeviations, AToolTurnedAboutItsEndShowsAtTheHeadOnly) {
  ToolPlaces tool = actual_tool(machine, ErrorSet{}, cone_trace);
  const PieceDeviation still = test_piece_deviation(cone, tool);
  for (std::size_t n = 0; n < still.rows.size(); ++n) {
    // Across the cone the tool stands at right angles to the normal.
    const auto row = static_cast<Index>(still.rows[n]);
    tool.direction.col(row) =
        (tool.direction.col(row) + 1e-4 * still.head_normal.col(static_cast<Index>(n))).normalized();
  }
  const PieceDeviation cut = test_piece_deviation(cone, tool);
  ASSERT_EQ(cut.rows, still.rows);
  const ConeFrustum sizes;
  const double slant = sizes.height / std::cos(sizes.half_apex_angle);
  for (std::size_t n = 0; n < cut.rows.size(); ++n) {
    EXPECT_NEAR(cut.foot[n], still.foot[n], 1e-12);
    EXPECT_NEAR(cut.head[n] - still.head[n], 1e-4 * slant, 1e-6);
  }
}

TEST_F(TestPieceDeviations, AZeroPositionErrorOfALinearAxisMakesItsPatternThroughTheRotaryAxes) {
  const std::size_t x = machine.find_axis("X");
  ErrorSet errors;
  errors.locations = {{x, Component::X, 0.01, 0}};
  for (const bool is_cone : {true, false}) {
    const PoseList& run = trace(is_cone);
    const PieceDeviation cut = test_piece_deviation(is_cone ? cone : s, actual_tool(machine, errors, run));
    ASSERT_EQ(cut.status, PieceTraceStatus::done);
    double largest = 0;
    for (std::size_t n = 0; n < cut.rows.size(); ++n) {
      const Vector3d displacement = 0.01 * by_x(run, cut.rows[n]);
      const auto k = static_cast<Index>(n);
      EXPECT_NEAR(cut.foot[n], cut.foot_normal.col(k).dot(displacement), 1.1e-3);
      EXPECT_NEAR(cut.head[n], cut.head_normal.col(k).dot(displacement), 3.1e-3);
      largest = std::max(largest, std::abs(cut.foot[n]));
    }
    EXPECT_GT(largest, 0.007);
  }
}

TEST_F(TestPieceDeviations, LostMotionStepsWhereTheAxisTurnsBack) {
  const std::size_t x = machine.find_axis("X");
  ErrorSet errors;
  errors.reversals = {{x, -0.02, 0}};
  const PieceDeviation cut =
      test_piece_deviation(cone, actual_tool(machine, errors, positions_with_play(errors, cone_trace)));
  ASSERT_EQ(cut.status, PieceTraceStatus::done);
  const std::vector<double>& command = cone_trace.axis[x];
  double turned_at = command[cut.rows.front()];
  int side = 0, compared = 0, turns = 0;
  for (std::size_t n = 1; n < cut.rows.size(); ++n) {
    const std::size_t row = cut.rows[n];
    const double step = command[row] - command[row - 1];
    const int now = step > 1e-9 ? 1 : step < -1e-9 ? -1 : side;
    if (now != side) {
      turns += side != 0 ? 1 : 0;
      turned_at = command[row - 1];
      side = now;
    }
    if (std::abs(command[row] - turned_at) < 0.021) continue;  // the play is not passed through yet
    const Vector3d displacement = -0.01 * side * by_x(cone_trace, row);
    EXPECT_NEAR(cut.foot[n], cut.foot_normal.col(static_cast<Index>(n)).dot(displacement), 1.1e-3);
    ++compared;
  }
  EXPECT_GE(turns, 2);
  EXPECT_GT(compared, static_cast<int>(cut.rows.size()) * 8 / 10);
}

TEST_F(TestPieceDeviations, TracesThatAreNotOfThePieceAreToldApart) {
  const ToolPlaces whole = actual_tool(machine, ErrorSet{}, cone_trace);
  EXPECT_EQ(test_piece_deviation(s, whole).status, PieceTraceStatus::never_begins);
  ConeFrustum elsewhere = with_tolerance(ConeFrustum{}, kFine);
  elsewhere.base_diameter = 70;
  EXPECT_EQ(test_piece_deviation(cone_frustum(elsewhere), whole).status, PieceTraceStatus::never_begins);

  ToolPlaces part = whole;
  const Index half = whole.point.cols() / 2;
  part.point.conservativeResize(3, half);
  part.direction.conservativeResize(3, half);
  part.covered.resize(static_cast<std::size_t>(half));
  const PieceDeviation cut = test_piece_deviation(cone, part);
  EXPECT_EQ(cut.status, PieceTraceStatus::ends_early);
  EXPECT_EQ(cut.row, static_cast<std::size_t>(half - 1));
  EXPECT_NEAR(cut.reached, cut.length / 2, 3);

  ToolPlaces off = whole;
  off.point.col(half) += Vector3d(0, 0, 3);
  const PieceDeviation left = test_piece_deviation(cone, off);
  EXPECT_EQ(left.status, PieceTraceStatus::leaves_piece);
  EXPECT_EQ(left.row, static_cast<std::size_t>(half));
  EXPECT_NEAR(left.distance, 3, 0.1);

  EXPECT_EQ(test_piece_deviation(cone, ToolPlaces{}).status, PieceTraceStatus::never_begins);
}

TEST_F(TestPieceDeviations, SamplesMayBeFartherApartThanTheReach) {
  // Every 60th sample of 0.05 mm, but those at the first and at the last point of the piece.
  PoseList sparse;
  sparse.axis.resize(machine.axes.size());
  const PieceDeviation dense = test_piece_deviation(cone, actual_tool(machine, ErrorSet{}, cone_trace));
  for (std::size_t k = dense.rows.front() - 60; k <= dense.rows.back(); k += 60) {
    for (std::size_t i = 0; i < sparse.axis.size(); ++i) sparse.axis[i].push_back(cone_trace.axis[i][k]);
  }
  const PieceDeviation cut = test_piece_deviation(cone, actual_tool(machine, ErrorSet{}, sparse), 0.5);
  ASSERT_NE(cut.status, PieceTraceStatus::never_begins);
  EXPECT_GT(cut.rows.size(), dense.rows.size() / 60 - 2);
  EXPECT_LT(piece_figures(cut, false).foot.largest(), kChord + 2 * kStraight);
}

TEST_F(TestPieceDeviations, WaitingAtBothEndsAndOnTheWayChangesNothing) {
  PoseList waiting;
  waiting.axis.resize(machine.axes.size());
  for (std::size_t k = 0; k < cone_trace.count(); ++k) {
    const bool waits = k == 300 || k == cone_trace.count() / 2 || k + 301 == cone_trace.count();
    for (int n = 0; n < (waits ? 50 : 1); ++n) {
      for (std::size_t i = 0; i < waiting.axis.size(); ++i) waiting.axis[i].push_back(cone_trace.axis[i][k]);
    }
  }
  const ErrorSet errors = test::tens_of_micrometres(machine, 2);
  const PieceDeviation moving = test_piece_deviation(cone, actual_tool(machine, errors, cone_trace));
  const PieceDeviation cut = test_piece_deviation(cone, actual_tool(machine, errors, waiting));
  ASSERT_EQ(cut.status, PieceTraceStatus::done);
  EXPECT_EQ(cut.foot, moving.foot);
  EXPECT_EQ(cut.head, moving.head);
}

TEST_F(TestPieceDeviations, RoundnessIsWhatIsLeftOfTheRadiusAboutTheCentre) {
  const ConeFrustum frustum = with_tolerance(ConeFrustum{}, kFine);
  const ToolPlaces still = actual_tool(machine, ErrorSet{}, cone_trace);
  const Eigen::Matrix3d lean = Eigen::AngleAxisd(frustum.inclination, Vector3d::UnitY()).toRotationMatrix();
  const double r = frustum.base_diameter / 2;
  // A shift across the axis is an eccentric circle; an oval has its own roundness.
  ToolPlaces eccentric = still, oval = still;
  for (Index k = 0; k < still.point.cols(); ++k) {
    eccentric.point.col(k) += lean * Vector3d(0.03, -0.02, 0);
    Vector3d at = lean.transpose() * (still.point.col(k) - frustum.base_centre);
    at.z() = 0;
    const double angle = std::atan2(at.y(), at.x());
    oval.point.col(k) += lean * (0.01 * std::cos(2 * angle) * at.normalized());
  }
  for (const bool head : {false, true}) {
    const Roundness perfect = cone_roundness(frustum, test_piece_deviation(cone, still), head);
    ASSERT_TRUE(perfect.evaluated);
    EXPECT_LT(perfect.roundness, 1.5 * kChord);
    const Roundness round = cone_roundness(frustum, test_piece_deviation(cone, eccentric), head);
    ASSERT_TRUE(round.evaluated);
    EXPECT_LT((round.centre - Eigen::Vector2d(0.03, -0.02)).norm(), 2e-4);
    EXPECT_NEAR(round.roundness, perfect.roundness, 2e-4);
    const Roundness lobes = cone_roundness(frustum, test_piece_deviation(cone, oval), head);
    ASSERT_TRUE(lobes.evaluated);
    EXPECT_NEAR(lobes.roundness, 0.02, 1.5 * kChord);
    EXPECT_LT(lobes.centre.norm(), 2e-4);
    EXPECT_NEAR(lobes.radius_deviation, -2 * kChord / 3, kChord) << r;
  }
}

}  // namespace
}  // namespace abbe
