#include "abbe/compensate/program/move_path.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kX = 0, kY = 1, kZ = 2, kA = 3, kC = 5;

ProgramMove arc(MoveKind kind, ArcPlane plane) {
  ProgramMove move;
  move.kind = kind;
  move.plane = plane;
  move.feed = 100;
  return move;
}

TEST(MovePath, AHelixTurnsAboutItsCentreWhileAllElseIsLinear) {
  ProgramMove move = arc(MoveKind::arc_counterclockwise, ArcPlane::XY);
  move.arc_centre = {10, 20, 0};
  move.start[kX] = 15, move.start[kY] = 20, move.start[kZ] = 1, move.start[kC] = 0.2;
  move.end[kX] = 10, move.end[kY] = 25, move.end[kZ] = 3, move.end[kC] = 0.4;
  WordValues words;
  MovePath(move).at(0.5, words);
  EXPECT_NEAR(words[kX], 10 + 5 * std::cos(kPi / 4), 1e-12);
  EXPECT_NEAR(words[kY], 20 + 5 * std::sin(kPi / 4), 1e-12);
  EXPECT_NEAR(words[kZ], 2, 1e-12);
  EXPECT_NEAR(words[kC], 0.3, 1e-12);
  move.kind = MoveKind::arc_clockwise;
  MovePath(move).at(0.5, words);
  EXPECT_NEAR(words[kX], 10 - 5 * std::cos(kPi / 4), 1e-12);
  EXPECT_NEAR(words[kY], 20 - 5 * std::sin(kPi / 4), 1e-12);
  move.arc_turns = 2;
  MovePath(move).at(0.5, words);
  // Half of 270 + 360 degrees, clockwise from the positive X.
  EXPECT_NEAR(words[kX], 10 + 5 * std::cos(-315.0 / 180 * kPi), 1e-9);
}

TEST(MovePath, ArcsOfTheOtherPlanesAreSeenFromThePositiveEndOfTheirNormals) {
  // G18: counterclockwise is from Z to X; G19: from Y to Z.
  ProgramMove move = arc(MoveKind::arc_counterclockwise, ArcPlane::ZX);
  move.start[kZ] = 1;
  move.end[kX] = 1;
  WordValues words;
  MovePath(move).at(0.5, words);
  EXPECT_NEAR(words[kX], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(words[kZ], std::sqrt(0.5), 1e-12);
  move = arc(MoveKind::arc_counterclockwise, ArcPlane::YZ);
  move.start[kY] = 1;
  move.end[kZ] = 1;
  MovePath(move).at(0.5, words);
  EXPECT_NEAR(words[kY], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(words[kZ], std::sqrt(0.5), 1e-12);
}

TEST(MovePath, AnArcToItsStartIsAFullCircle) {
  for (const double gap : {0.0, 1e-9, -1e-9}) {
    ProgramMove move = arc(MoveKind::arc_clockwise, ArcPlane::XY);
    move.start[kX] = move.end[kX] = 3;
    move.end[kY] = gap;
    WordValues words;
    MovePath(move).at(0.25, words);
    EXPECT_NEAR(words[kX], 0, 1e-7);
    EXPECT_NEAR(words[kY], -3, 1e-7);
    EXPECT_NEAR(move_duration(move), 6 * kPi / 100, 1e-9);
  }
}

TEST(MovePath, AnArcOfATiltedPlaneIsThatOfAPlaneOfTwoAxesTurned) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const auto turned = [&](auto values) {
    const Eigen::Vector3d there = turn * Eigen::Vector3d(values[0], values[1], values[2]);
    for (std::size_t k = 0; k < 3; ++k) values[k] = there[static_cast<Eigen::Index>(k)];
    return values;
  };
  for (const MoveKind kind : {MoveKind::arc_clockwise, MoveKind::arc_counterclockwise}) {
    for (const int turns : {1, 3}) {
      ProgramMove flat = arc(kind, ArcPlane::XY);
      flat.arc_turns = turns;
      flat.arc_centre = {10, 20, 1};
      flat.start[kX] = 15, flat.start[kY] = 20, flat.start[kZ] = 1, flat.start[kC] = 0.2;
      flat.end[kX] = 10, flat.end[kY] = 25.02, flat.end[kZ] = 8, flat.end[kC] = 0.4;
      ProgramMove tilted = flat;
      tilted.plane = ArcPlane::tilted;
      tilted.start = turned(flat.start);
      tilted.end = turned(flat.end);
      tilted.arc_centre = turned(flat.arc_centre);
      tilted.arc_normal = turned(std::array<double, 3>{0, 0, 1});
      const MovePath expected(flat), path(tilted);
      WordValues wanted, words, before = tilted.start;
      for (int i = 0; i <= 100; ++i) {
        expected.at(i / 100.0, wanted);
        wanted = turned(wanted);
        path.at(i / 100.0, words);
        for (std::size_t k = 0; k < kAxisWords; ++k) ASSERT_NEAR(words[k], wanted[k], 1e-12);
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_LE(std::abs(words[k] - before[k]), path.speed()[k] / 100 * (1 + 1e-12));
        before = words;
      }
      EXPECT_NEAR(path.bend(), expected.bend(), 1e-9);
      EXPECT_NEAR(move_duration(tilted), move_duration(flat), 1e-12);
    }
  }
}

TEST(MovePath, ChordsLeaveTheArcByNoMoreThanItsBendSays) {
  ProgramMove move = arc(MoveKind::arc_counterclockwise, ArcPlane::XY);
  move.start[kX] = 5;
  move.end[kX] = 0, move.end[kY] = 5.01;  // radii differ
  const MovePath path(move);
  constexpr int kPieces = 20;
  double largest = 0;
  for (int i = 0; i < kPieces; ++i) {
    WordValues a, b, middle;
    path.at(i / 20.0, a);
    path.at((i + 1) / 20.0, b);
    for (int j = 1; j < 10; ++j) {
      const double t = j / 10.0;
      path.at((i + t) / 20.0, middle);
      largest = std::max(
          largest, std::hypot(middle[kX] - a[kX] - t * (b[kX] - a[kX]), middle[kY] - a[kY] - t * (b[kY] - a[kY])));
    }
  }
  const double bound = path.bend() / (8.0 * kPieces * kPieces);
  EXPECT_LE(largest, bound);
  EXPECT_GE(largest, 0.98 * bound);
}

TEST(PieceFeed, ARotaryMoveThatGetsLinearMotionKeepsItsDuration) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.feed = 2;  // rad/min
  move.end[kA] = 1;
  const double duration = move_duration(move);
  EXPECT_NEAR(duration, 0.5, 1e-15);
  CorrectedPiece piece;
  piece.end = move.end;
  set_piece_feed(move, duration, 1, move.start, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_minute);
  EXPECT_EQ(piece.feed, 2);
  piece.end[kX] = 0.02;
  set_piece_feed(move, duration, 1, move.start, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::inverse_time);
  EXPECT_NEAR(piece.feed, 2, 1e-12);  // 1 / (0.5 min)
}

TEST(PieceFeed, InverseTimesOfPiecesAddUpToThatOfTheMove) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.feed_mode = FeedMode::inverse_time;
  move.feed = 4;
  move.end[kX] = 10;
  const double duration = move_duration(move);
  double sum = 0;
  for (const double share : {0.2, 0.5, 0.3}) {
    CorrectedPiece piece;
    piece.end = move.end;
    set_piece_feed(move, duration, share, move.start, piece);
    EXPECT_EQ(piece.feed_mode, FeedMode::inverse_time);
    sum += 1 / piece.feed;
  }
  EXPECT_NEAR(sum, 0.25, 1e-15);
  CorrectedPiece whole;
  set_piece_feed(move, duration, 1, move.start, whole);
  EXPECT_EQ(whole.feed, 4);
}

TEST(PieceFeed, LinearMovesAndFeedsPerRevolutionStayAsTheyAre) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.feed = 500;
  move.end[kX] = 10;
  CorrectedPiece piece;
  piece.end = move.end;
  piece.end[kX] += 0.01;
  piece.end[kA] = 1e-4;
  set_piece_feed(move, move_duration(move), 1, move.start, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_minute);
  EXPECT_EQ(piece.feed, 500);
  move.feed_mode = FeedMode::per_revolution;
  move.feed = 0.2;
  EXPECT_LT(move_duration(move), 0);
  set_piece_feed(move, move_duration(move), 0.5, move.start, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_revolution);
  EXPECT_EQ(piece.feed, 0.2);
}

TEST(PieceFeed, AMotionOfOneAxisAloneHasTheFeedOfItsKindOrTheRightTime) {
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.feed = 600;
  move.end[0] = 50;
  CorrectedPiece piece;
  set_take_up_feed(move, false, 0.01, 0.1, 50, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_minute);
  EXPECT_EQ(piece.feed, 600);
  // 20 um at the speed of 50 mm in a tenth of a minute.
  set_take_up_feed(move, true, 0.02, 0.1, 50, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::inverse_time);
  EXPECT_DOUBLE_EQ(piece.feed, 500 / 0.02);
  // Never longer than the piece, never in no time.
  set_take_up_feed(move, true, 0.02, 0.1, 0, piece);
  EXPECT_DOUBLE_EQ(piece.feed, 10);
  set_take_up_feed(move, true, 1e-300, 0.1, 50, piece);
  EXPECT_DOUBLE_EQ(piece.feed, 1e8);
  // Nothing is known of the time.
  set_take_up_feed(move, true, 0.02, 0, 0, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_minute);
  move.feed_mode = FeedMode::inverse_time;
  move.feed = 10;
  set_take_up_feed(move, false, 0.02, 0.1, 50, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::inverse_time);
  EXPECT_DOUBLE_EQ(piece.feed, 500 / 0.02);
  ProgramMove turn;
  turn.kind = MoveKind::straight;
  turn.feed = 4;
  turn.end[5] = 1;
  set_take_up_feed(turn, true, 0.02, 0.25, 100, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::per_minute);
  set_take_up_feed(turn, false, 0.02, 0.25, 100, piece);
  EXPECT_EQ(piece.feed_mode, FeedMode::inverse_time);
  EXPECT_DOUBLE_EQ(piece.feed, 400 / 0.02);
}

}  // namespace
}  // namespace abbe
