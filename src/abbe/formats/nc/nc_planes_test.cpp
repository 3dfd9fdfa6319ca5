// Tilted planes of programs: where the tool of a nominal machine goes, by its forward kinematics alone.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "abbe/compensate/program/machine_planes.h"
#include "abbe/compensate/program/move_path.h"
#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/formats/nc/nc_correctors_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// The example's plane: I 30, J -40, K 15 about a point of the workpiece.
const char* const kPlane = "G21 G90\nG54 G0 X0 Y0 Z0 A0 B0 C0\nG68.2 X10 Y-20 Z30 I30 J40 K15\n";
Eigen::Matrix3d plane_rotation() {
  const auto about_z = [](double angle) {
    Eigen::Matrix3d r;
    r << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    return r;
  };
  Eigen::Matrix3d about_x;
  about_x << 1, 0, 0, 0, std::cos(40 * kDegree), -std::sin(40 * kDegree), 0, std::sin(40 * kDegree),
      std::cos(40 * kDegree);
  return about_z(30 * kDegree) * about_x * about_z(15 * kDegree);
}
const Vector3d kOrigin(10, -20, 30);

class TiltedPlanes : public testing::Test {
 protected:
  explicit TiltedPlanes(const Machine& given = test::trunnion_mill())
      : machine(given), axes(test::words_of(given)), planes(given, axes), control(given, {}, axes) {
    for (std::size_t k = 0; k < kAxisWords; ++k) options.words[k] = axes.axis[k] != Machine::npos;
    for (std::size_t k = 0; k < kAxisWords; ++k) options.start[k] = 0.0;
    options.tools = NcToolTable{{1, {0, 0, 50}}};
    options.planes = &planes;
    // The work offset is no multiple of anything.
    options.parameters = {{5221, 3.25}, {5222, -7.5}, {5223, -300}};
  }

  /// Without the rotary words that the machine has not.
  RunProgram run(std::string text) const {
    for (std::size_t k = 3; k < 6; ++k) {
      const std::string word = fmt::format(" {}0", "XYZABC"[k]);
      if (!options.words[k] && text.find(word) != std::string::npos) text.replace(text.find(word), 3, "");
    }
    return run_program(text, options);
  }
  std::string failure(const std::string& text) const {
    return message_of([&] { run(text); });
  }

  /// Where the tool is in the workpiece for a place in the plane, by the machine with its rotary axes at zero.
  Vector3d place(const Vector3d& in_plane, double tool_z = 0) const {
    const Vector3d words = kOrigin + plane_rotation() * in_plane + Vector3d(3.25, -7.5, -300 + tool_z);
    ProgramMove move;
    move.tool_length = {0, 0, tool_z};
    WordValues at{};
    for (std::size_t k = 0; k < 3; ++k) at[k] = words[static_cast<Eigen::Index>(k)];
    return control.pose(move, at, false).translation;
  }
  void expect_at(const ProgramMove& move, const Vector3d& in_plane, double tolerance = 1e-8) const {
    const RigidTransform there = control.pose(move, move.end, false);
    EXPECT_NEAR((there.translation - place(in_plane, move.tool_length[2])).norm(), 0, tolerance);
  }
  void expect_normal(const ProgramMove& move) const {
    // Turned planes keep their turn against the workpiece with axes at zero, which is parallel to X, Y, Z.
    const RigidTransform there = control.pose(move, move.end, false);
    EXPECT_NEAR((there.rotation * machine.tool_direction - plane_rotation().col(2)).norm(), 0, 1e-9);
  }

  void expect_arcs_of_the_plane(const std::string& turning) const {
    const RunProgram r =
        run(std::string(kPlane) + turning + "G0 X10 Y0 Z5\nG2 X0 Y10 I-10 J0 Z2 F100\nG2 X10 Y0 R10\nM2\n");
    ASSERT_GE(r.moves.size(), 4U);
    const std::size_t last = r.moves.size() - 1;
    for (const std::size_t i : {last - 1, last}) {
      const MovePath path(r.moves[i]);
      ASSERT_TRUE(path.is_arc());
      for (int k = 0; k <= 8; ++k) {
        // Clockwise by 270 degrees from X 10, and then the last 90.
        const double s = k / 8.0, angle = i == last - 1 ? -270 * kDegree * s : 90 * kDegree * (1 - s);
        const double height = i == last - 1 ? 5 - 3 * s : 2;
        ProgramMove move = r.moves[i];
        path.at(s, move.end);
        expect_at(move, {10 * std::cos(angle), 10 * std::sin(angle), height});
      }
    }
  }

  Machine machine;
  WordAxes axes;
  MachinePlanes planes;
  test::ControlledMachine control;
  NcProgramOptions options;
};

class TiltedPlanesOfAHead : public TiltedPlanes {
 protected:
  TiltedPlanesOfAHead() : TiltedPlanes(far_turning()) {}

 private:
  static Machine far_turning() {
    Machine machine = test::swivel_head_mill();
    for (Axis& axis : machine.axes) {
      if (axis.kind == AxisKind::rotary) axis.travel_max = -(axis.travel_min = -180 * kDegree);
    }
    return machine;
  }
};

TEST_F(TiltedPlanes, MovesReachThePlacesOfThePlaneWithTheToolAlongItsNormal) {
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X1 Y2 Z50\nG1 Z-3 F100\nX40\nG91 Y5\nG90 X0 Y0 Z0\nM2\n");
  ASSERT_EQ(r.moves.size(), 7U);
  EXPECT_EQ(r.moves[1].kind, MoveKind::rapid);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(r.moves[1].start[k], r.moves[1].end[k]);
  for (std::size_t i = 1; i < r.moves.size(); ++i) expect_normal(r.moves[i]);
  expect_at(r.moves[2], {1, 2, 50});
  expect_at(r.moves[3], {1, 2, -3});
  expect_at(r.moves[4], {40, 2, -3});
  expect_at(r.moves[5], {40, 7, -3});
  expect_at(r.moves[6], {0, 0, 0});
  EXPECT_NEAR(r.moves[4].feed, 100, 0);
  for (std::size_t i = 1; i < r.moves.size(); ++i) EXPECT_EQ(r.moves[i].start, r.moves[i - 1].end);
}

TEST_F(TiltedPlanesOfAHead, MovesReachThePlacesToo) {
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG43 H1\nG0 X1 Y2 Z50\nG1 Z-3 F100\nX40 Y5\nM2\n");
  ASSERT_EQ(r.moves.size(), 5U);
  for (std::size_t i = 1; i < r.moves.size(); ++i) expect_normal(r.moves[i]);
  expect_at(r.moves[2], {1, 2, 50});
  expect_at(r.moves[3], {1, 2, -3});
  expect_at(r.moves[4], {40, 5, -3});
  EXPECT_EQ(r.moves[4].tool_length[2], 50);
}

TEST_F(TiltedPlanes, TheToolLengthMayChangeInThePlane) {
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X1 Y2 Z80\nG43 H1\nX1 Y2 Z80\nG49\nX1 Y2 Z80\nM2\n");
  ASSERT_EQ(r.moves.size(), 5U);
  for (std::size_t i = 2; i < 5; ++i) expect_at(r.moves[i], {1, 2, 80});
  EXPECT_NEAR(r.moves[3].end[2] - r.moves[2].end[2], 50, 1e-9);
}

TEST_F(TiltedPlanes, WithoutG531ThePlaneCountsWithTheToolAsItIs) {
  const RunProgram r = run(std::string(kPlane) + "G0 X1 Y2 Z50\nM2\n");
  ASSERT_EQ(r.moves.size(), 2U);
  expect_at(r.moves[1], {1, 2, 50});
  EXPECT_EQ(r.moves[1].end[3], 0);
}

TEST_F(TiltedPlanes, ArcsAndHelicesAreThoseOfThePlane) { expect_arcs_of_the_plane("G53.1\n"); }

TEST_F(TiltedPlanes, ArcsOfAPlaneToWhichTheToolDoesNotTurn) { expect_arcs_of_the_plane(""); }

TEST_F(TiltedPlanesOfAHead, ArcsLieInNoPlaneOfTwoAxes) {
  expect_arcs_of_the_plane("G53.1\n");
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X10 Y0 Z5\nG2 X0 Y10 I-10 J0 F100\nM2\n");
  EXPECT_EQ(r.moves.back().plane, ArcPlane::tilted);
}

TEST_F(TiltedPlanes, ArcsOfTheOtherPlanesOfAPlane) {
  const RunProgram r =
      run(std::string(kPlane) + "G18 G0 X10 Y3 Z0\nG3 X0 Z-10 I-10 K0 F100\nG19 G2 Y13 Z0 J10 K0 P2\nM2\n");
  ASSERT_EQ(r.moves.size(), 4U);
  for (int k = 0; k <= 8; ++k) {
    const double s = k / 8.0;
    // G18: counterclockwise is from Z to X; G19: clockwise from Z to Y, from below the centre by a quarter and a turn.
    const auto at = [&](std::size_t i) {
      ProgramMove move = r.moves[i];
      MovePath(r.moves[i]).at(s, move.end);
      return move;
    };
    const double first = 90 * kDegree + 90 * kDegree * s;
    expect_at(at(2), {10 * std::sin(first), 3, 10 * std::cos(first)});
  }
  const Vector3d centre(0, 13, -10);
  ProgramMove end = r.moves[3];
  expect_at(end, {0, 13, 0});
  MovePath(r.moves[3]).at(0.2, end.end);
  // A fifth of 90 + 360 degrees, clockwise seen from X: from minus Y to Z.
  expect_at(end, centre + Vector3d(0, 0, 10));
}

TEST_F(TiltedPlanes, CyclesDrillAlongTheNormal) {
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X0 Y0 Z40\nG98 G81 X5 Y6 Z-8 R2 F100\nX9\nG80\nM2\n");
  ASSERT_EQ(r.moves.size(), 11U);
  const std::vector<Vector3d> places = {{5, 6, 40}, {5, 6, 2}, {5, 6, -8}, {5, 6, 40},
                                        {9, 6, 40}, {9, 6, 2}, {9, 6, -8}, {9, 6, 40}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    SCOPED_TRACE(i);
    expect_at(r.moves[3 + i], places[i]);
  }
}

TEST_F(TiltedPlanes, PositionsOfTheAxesAreThoseAfterG69AndWithG53) {
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X1 Y2 Z50\nG53 G0 Z0\nX3 Y4\nG69\nG0 X1 Y2 Z3\nM2\n");
  ASSERT_EQ(r.moves.size(), 6U);
  EXPECT_EQ(r.moves[3].end[2], 0);
  EXPECT_EQ(r.moves[3].end[0], r.moves[2].end[0]);
  // Z of the plane is where the axis stands now.
  const Vector3d in_plane = plane_rotation().transpose() *
                            (control.pose(r.moves[3], r.moves[3].end, false).translation - place(Vector3d::Zero()));
  expect_at(r.moves[4], {3, 4, in_plane.z()});
  EXPECT_NEAR(r.moves[5].end[0], 4.25, 1e-12);
  EXPECT_NEAR(r.moves[5].end[1], -5.5, 1e-12);
  EXPECT_NEAR(r.moves[5].end[2], -297, 1e-12);
}

TEST_F(TiltedPlanes, TheWrittenProgramHasPlainMovesAndSaysWhatTheyWere) {
  const std::string text =
      std::string(kPlane) + "N5 G53.1 M3 S100\nG0 X1 Y2 Z50\nG1 Z-3 F100\nN9 G69\nG0 X0 Y0 Z0\nM2\n";
  const RunProgram r = run(text);
  EXPECT_THAT(r.text, HasSubstr("(G68.2 X10 Y-20 Z30 I30 J40 K15, until G69 written as moves of the axes)"));
  EXPECT_THAT(r.text, HasSubstr("N5 M3 S100 G0 A"));
  EXPECT_THAT(r.text, HasSubstr("(G53.1)"));
  EXPECT_EQ(r.text.find("G69\n"), std::string::npos);
  NcProgramOptions plain = options;
  plain.planes = nullptr;
  const RunProgram again = run_program(r.text, plain);
  const auto near = [](const ProgramMove& a, const ProgramMove& b) {
    for (std::size_t k = 0; k < kAxisWords; ++k) ASSERT_NEAR(a.end[k], b.end[k], 1e-6);
  };
  ASSERT_EQ(again.moves.size(), r.moves.size());
  for (std::size_t i = 0; i < again.moves.size(); ++i) near(again.moves[i], r.moves[i]);
}

TEST_F(TiltedPlanes, ProgramsOfThePointReachTheSamePlaces) {
  // X, Y, Z are the point in the workpiece: the plane stands in the frame of the workpiece.
  options.tool_centre = true;
  const RunProgram r = run(std::string(kPlane) + "G53.1\nG0 X1 Y2 Z50\nM2\n");
  ASSERT_EQ(r.moves.size(), 3U);
  ProgramMove move = r.moves[2];
  move.coordinates = ProgramCoordinates::tool_centre;
  const Vector3d wanted = kOrigin + plane_rotation() * Vector3d(1, 2, 50) + Vector3d(3.25, -7.5, -300);
  EXPECT_NEAR((control.pose(move, move.end, false).translation - wanted).norm(), 0, 1e-9);
  expect_normal(move);
}

TEST_F(TiltedPlanes, InchesAndAnglesAboutOneAxisOnly) {
  const RunProgram r =
      run("G20 G90\nG0 X0 Y0 Z0 A0 C0\nG68.2 J90\nG53.1\nG0 X1 Y2 Z3\nG69\nG68.2 X1\nG0 X0 Y0 Z0\nM2\n");
  ASSERT_EQ(r.moves.size(), 4U);
  EXPECT_NEAR(std::abs(r.moves[1].end[3]), 90 * kDegree, 1e-9);
}

TEST_F(TiltedPlanes, WhatIsNotSimpleIsAnErrorWithLineAndWord) {
  const std::string plane = kPlane;
  EXPECT_EQ(failure(plane + "G68.2 I3\n"),
            "p.ngc:4:1: G68.2: a tilted plane in a tilted plane; "
            "expected G69 before it");
  const std::vector<std::pair<std::string, std::string>> errors = {
      {"G68.2 P1 X0 I10", "P1: this form of G68.2 is not handled"},
      {"G68.2 Q1", "Q1: "},
      {"G68.2 A5", "words of other axes"},
      {"G91 G68.2 X1", "G91: another G code in a block with G68.2"},
      {"G91\nG68.2 X1", "G68.2 in incremental distances"},
      {"G53.1", "there is no tilted plane"},
      {"G68 X0 Y0 R5", "rotated coordinates are not handled"},
      {"G68.3 X0", "a tilted plane defined by the tool direction"},
      {"G53.6", "while the tool keeps its place"},
      {"G68.2 J40\nG53.1 P1", "choosing the solution"},
      {"G68.2 J40\nG53.1 X1", "G53.1 with axis words"},
      {"G68.2 J40\nG55", "while a plane is tilted"},
      {"G68.2 J40\nG92 X0", "while a plane is tilted"},
      {"G68.2 J40\nG28", "while a plane is tilted"},
      {"G68.2 J40\nG0 A5", "A5: moves another axis"},
      {"G68.2 J40\nG53 G0 A5", "A5: moves another axis"},
      {"G68.2 J40\nG69 X5", "G69 with axis words"},
      {"G81 X1 Y1 Z-1 R2 F100\nG68.2 J40", "a canned cycle is in force"},
      {"G68.2 J150\nG53.1", "rotary axes would leave their travel"},
  };
  for (const auto& [text, message] : errors) {
    SCOPED_TRACE(text);
    EXPECT_THAT(failure("G21 G90\nG0 X0 Y0 Z0 A0 C0\n" + text + "\n"), HasSubstr(message));
  }
  NcProgramOptions unknown = options;
  unknown.start = {};
  EXPECT_THAT(message_of([&] { run_program("G21 G90\nG68.2 J40\n", unknown); }), HasSubstr("where A, C stand"));
  EXPECT_THAT(message_of([&] { run_program("G21 G90\nG0 A0 C0\nG68.2 J40\nG53.1\nG0 X1 Y1\n", unknown); }),
              HasSubstr("every move takes all three"));
  unknown.planes = nullptr;
  EXPECT_THAT(message_of([&] { run_program("G68.2 J40\n", unknown); }), HasSubstr("the machine is not known"));
}

class TiltedPlanesOfASkewMachine : public TiltedPlanes {
 protected:
  TiltedPlanesOfASkewMachine() : TiltedPlanes(skew()) {}

  static Machine skew() {
    Machine machine = test::trunnion_mill();
    machine.axes[machine.find_axis("X")].direction = Vector3d(1, 0.001, 0).normalized();
    return machine;
  }
};

TEST_F(TiltedPlanesOfASkewMachine, AnArcOfATurnedWorkpieceIsRefusedBecauseItIsNone) {
  const auto turned = [](const char* c) {
    return fmt::format("G21 G90\nG54 G0 X0 Y0 Z0 A0 B0 C{}\nG68.2 X10 Y-20 Z30 I0 J0 K0\nG0 X5 Y0 Z0\n", c);
  };
  const std::string arc = "G2 X-5 I-5 F100\nM2\n";
  EXPECT_THAT(failure(turned("30") + arc), HasSubstr("X, Y and Z are not at right angles"));
  EXPECT_EQ(run(turned("30") + "G1 X-5 F100\nM2\n").moves.size(), 3U);
  // The words themselves are turned, and the control makes circles of words.
  EXPECT_EQ(run(turned("0") + arc).moves.back().kind, MoveKind::arc_clockwise);
}

TEST_F(TiltedPlanes, AnArcOfATurnedWorkpieceIsOneOnAMachineAtRightAngles) {
  const RunProgram r =
      run("G21 G90\nG54 G0 X0 Y0 Z0 A0 B0 C30\nG68.2 X10 Y-20 Z30 I0 J0 K0\nG0 X5 Y0 Z0\nG2 X-5 I-5 F100\nM2\n");
  EXPECT_EQ(r.moves.back().kind, MoveKind::arc_clockwise);
}

}  // namespace
}  // namespace abbe
