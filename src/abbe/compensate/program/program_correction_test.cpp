#include "abbe/compensate/program/program_correction.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/program/tool_centre_moves.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using test::ControlledMachine;

struct Missed {
  double point = 0, uncorrected = 0, direction = 0;
  std::size_t pieces = 0;
};

/// Share of the path at which the nominal point is nearest to a point, from a share on.
double nearest_share(const ControlledMachine& control, const ProgramMove& move, const RigidTransform& pose,
                     double from) {
  const MovePath path(move);
  const auto distance = [&](double s) {
    WordValues wanted;
    path.at(s, wanted);
    return control.point_missed(pose, control.pose(move, wanted, false));
  };
  constexpr int kScan = 100;
  double best = from, least = distance(from);
  for (int i = 1; i <= kScan; ++i) {
    const double s = from + (1 - from) * i / kScan, d = distance(s);
    if (d < least) {
      least = d;
      best = s;
    }
  }
  const double step = (1 - from) / kScan;
  double low = std::max(from, best - step), high = std::min(1.0, best + step);
  for (int n = 0; n < 60; ++n) {
    const double a = high - 0.618 * (high - low), b = low + 0.618 * (high - low);
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  return 0.5 * (low + high);
}

/// Runs corrected moves through the control and the machine with errors, and compares with the commanded path.
Missed drive(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
             const std::vector<ProgramMove>& moves, const CorrectedPieces& corrected, int samples) {
  const ControlledMachine control(machine, errors, words);
  Missed missed;
  missed.pieces = corrected.pieces.size();
  WordValues at = corrected.pieces[corrected.first[1] - 1].end;
  // The program begins where the machine stands, with its first move.
  for (std::size_t i = 1; i < moves.size(); ++i) {
    const ProgramMove& move = moves[i];
    const MovePath path(move);
    double s0 = 0;
    for (std::size_t k = corrected.first[i]; k < corrected.first[i + 1]; ++k) {
      const WordValues& end = corrected.pieces[k].end;
      const bool last = k + 1 == corrected.first[i + 1];
      const double s1 = last ? 1 : nearest_share(control, move, control.pose(move, end, true), s0);
      for (int j = 0; j <= samples; ++j) {
        const double t = static_cast<double>(j) / samples;
        WordValues wanted;
        path.at(s0 + (s1 - s0) * t, wanted);
        const RigidTransform commanded = control.pose(move, wanted, false);
        const RigidTransform actual = control.pose(move, test::between(at, end, t), true);
        missed.point = std::max(missed.point, control.point_missed(actual, commanded));
        missed.direction = std::max(missed.direction, control.direction_missed(actual, commanded));
        const RigidTransform before = control.pose(move, wanted, true);
        missed.uncorrected = std::max(missed.uncorrected, control.point_missed(before, commanded));
      }
      s0 = s1;
      at = end;
    }
  }
  return missed;
}

std::vector<ProgramMove> random_program(const Machine& machine, const WordAxes& words, ProgramCoordinates coordinates,
                                        std::size_t count, double share, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const WordKinematics kinematics(machine, words, {});
  std::vector<ProgramMove> moves;
  const auto to_words = [&](const WordValues& axis_words) {
    if (coordinates == ProgramCoordinates::axes) return axis_words;
    std::vector<double> axes(machine.axes.size(), 0.0);
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      if (words.axis[i] != Machine::npos) axes[words.axis[i]] = axis_words[i];
    }
    WordValues result = axis_words;
    const Eigen::Vector3d point = nominal_workpiece_from_tool(machine, axes).translation;
    for (std::size_t i = 0; i < 3; ++i) result[i] = point[static_cast<Eigen::Index>(i)];
    return result;
  };
  WordValues here = test::random_axis_words(machine, words, generator);
  for (std::size_t k = 0; k < count; ++k) {
    const WordValues there = test::between(here, test::random_axis_words(machine, words, generator), share);
    ProgramMove move;
    move.line = k + 1;
    move.kind = MoveKind::straight;
    move.coordinates = coordinates;
    move.feed = 1000;
    move.start = to_words(here);
    move.end = to_words(there);
    moves.push_back(move);
    here = there;
  }
  return moves;
}

TEST(ProgramCorrection, TheActualToolFollowsTheCommandedPath) {
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::nutating_head_mill(),
                                 test::three_axis_mill(), test::gantry_fork_head()}) {
    for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
      const WordAxes words = test::words_of(machine);
      const ErrorSet errors = test::mixed_errors(machine, 5);
      const std::vector<ProgramMove> moves = random_program(machine, words, coordinates, 6, 0.1, 7);
      ProgramCorrection correction(machine, errors, words);
      ASSERT_EQ(correction.problem(), "");
      CorrectedPieces corrected;
      correction.correct(moves, corrected);
      ASSERT_EQ(corrected.first.size(), moves.size() + 1);
      const Missed missed = drive(machine, errors, words, moves, corrected, 4);
      EXPECT_LE(missed.point, 1e-3);
      EXPECT_GE(missed.uncorrected, 0.05);
      EXPECT_EQ(correction.report().not_proven.count, 0U);
      EXPECT_GE(correction.report().split_moves, 1U);
    }
  }
}

TEST(ProgramCorrection, ResultsDoNotDependOnBatchesOrThreads) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 31);
  std::vector<ProgramMove> moves = random_program(machine, words, ProgramCoordinates::axes, 700, 0.002, 17);
  for (std::size_t i = 100; i < 300; ++i) moves[i].tool_length = {0, 0, 45};
  for (std::size_t i = 0; i < moves.size(); i += 7) moves[i].kind = MoveKind::rapid;
  const auto run = [&](std::size_t batch, int threads, ProgramReport& report) {
    ProgramCorrectionOptions options;
    options.threads = threads;
    ProgramCorrection correction(machine, errors, words, options);
    std::vector<double> numbers = test::numbers_in_batches(correction, moves, batch);
    report = correction.report();
    return numbers;
  };
  ProgramReport all, single, few;
  const std::vector<double> one = run(700, 1, all);
  EXPECT_EQ(one, run(1, 2, single));
  EXPECT_EQ(one, run(90, 2, few));
  EXPECT_EQ(all.pieces, single.pieces);
  EXPECT_EQ(all.largest_shift.line, few.largest_shift.line);
  EXPECT_EQ(all.largest_shift.value, single.largest_shift.value);
  EXPECT_EQ(all.tool_changes.count, 2U);
  EXPECT_EQ(single.tool_changes.count, 2U);
  EXPECT_EQ(single.tool_changes.line[1], 301U);
  EXPECT_EQ(all.status[static_cast<std::size_t>(CorrectionStatus::reached)].count,
            single.status[static_cast<std::size_t>(CorrectionStatus::reached)].count);
}

TEST(ProgramCorrection, ShortMovesStayWhole) {
  const Machine machine = test::head_table_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 31);
  const std::vector<ProgramMove> moves = random_program(machine, words, ProgramCoordinates::tool_centre, 500, 5e-4, 3);
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(moves, corrected);
  EXPECT_EQ(corrected.pieces.size(), moves.size());
  EXPECT_EQ(correction.report().split_moves, 0U);
}

TEST(ProgramCorrection, WithoutErrorsLinesComeBackToTheLastBit) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
    const std::vector<ProgramMove> moves = random_program(machine, words, coordinates, 50, 0.3, 3);
    ProgramCorrection correction(machine, {}, words);
    CorrectedPieces corrected;
    correction.correct(moves, corrected);
    ASSERT_EQ(corrected.pieces.size(), moves.size());
    for (std::size_t i = 0; i < moves.size(); ++i) {
      EXPECT_EQ(corrected.pieces[i].end, moves[i].end);
      EXPECT_EQ(corrected.pieces[i].feed, moves[i].feed);
    }
  }
}

TEST(ProgramCorrection, HelicesAreFollowedWithinTheTolerance) {
  for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
    const Machine machine = test::trunnion_mill();
    const WordAxes words = test::words_of(machine);
    const ErrorSet errors = test::mixed_errors(machine, 13);
    std::vector<ProgramMove> moves = random_program(machine, words, coordinates, 1, 1e-3, 7);
    ProgramMove helix = moves[0];
    helix.line = 2;
    helix.kind = MoveKind::arc_clockwise;
    helix.start = helix.end = moves[0].end;
    helix.end[2] += 5;
    helix.end[static_cast<std::size_t>(AxisWord::C)] += 0.3;
    helix.arc_centre = {helix.start[0] + 20, helix.start[1], 0};
    helix.tool_length = moves[0].tool_length = {0, 0, 30};
    moves.push_back(helix);
    ProgramCorrection correction(machine, errors, words);
    CorrectedPieces corrected;
    correction.correct(moves, corrected);
    // Sagitta alone: 2 pi 20 mm at 1 um.
    EXPECT_GE(corrected.first[2] - corrected.first[1], 200U);
    EXPECT_LE(corrected.first[2] - corrected.first[1], 1500U);
    const Missed missed = drive(machine, errors, words, moves, corrected, 2);
    EXPECT_LE(missed.point, 1e-3);
    EXPECT_GE(missed.uncorrected, 0.02);
  }
}

TEST(ProgramCorrection, ArcsOfTiltedPlanesAreFollowedWithinTheTolerance) {
  for (const Machine& machine : {test::swivel_head_mill(), test::trunnion_mill()}) {
    for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
      SCOPED_TRACE(machine.name);
      const WordAxes words = test::words_of(machine);
      const ErrorSet errors = test::mixed_errors(machine, 17);
      std::vector<ProgramMove> moves = random_program(machine, words, coordinates, 1, 1e-3, 8);
      ProgramMove arc = moves[0];
      arc.line = 2;
      arc.kind = MoveKind::arc_counterclockwise;
      arc.plane = ArcPlane::tilted;
      arc.arc_normal = {0.48, -0.6, 0.64};
      // From the centre along (0.8, 0, -0.6), which is at right angles to the normal, and half round with a pitch of 4.
      arc.start = arc.end = moves[0].end;
      for (std::size_t k = 0; k < 3; ++k) {
        const double outwards = std::array<double, 3>{0.8, 0, -0.6}[k];
        arc.arc_centre[k] = arc.start[k] - 25 * outwards;
        arc.end[k] = arc.start[k] - 50 * outwards + 4 * arc.arc_normal[k];
      }
      moves.push_back(arc);
      ProgramCorrection correction(machine, errors, words);
      CorrectedPieces corrected;
      correction.correct(moves, corrected);
      EXPECT_EQ(correction.report().not_proven.count, 0U);
      EXPECT_GE(corrected.first[2] - corrected.first[1], 100U);
      const Missed missed = drive(machine, errors, words, moves, corrected, 2);
      EXPECT_LE(missed.point, 1e-3);
      EXPECT_GE(missed.uncorrected, 0.01);
    }
  }
}

TEST(ProgramCorrection, WorkFromAndToTheEndOfATravelIsProvenBetween) {
  // The correction of Z leads out of the travel at its top, by 20 um there.
  Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  const std::size_t z = machine.find_axis("Z");
  const double top = machine.axes[z].travel_max;
  ErrorSet errors;
  const Basis basis{.kind = BasisKind::monomial, .order = 2, .from = machine.axes[z].travel_min, .to = top};
  errors.motions.push_back({z, Component::Z, basis, {-0.01, -0.006, -0.004}, {}});
  errors.motions.push_back({z, Component::X, basis, {0, 0.02, 0.03}, {}});
  ProgramMove up, down, back;
  up.line = 3, down.line = 4, back.line = 5;
  up.kind = MoveKind::rapid;
  down.kind = back.kind = MoveKind::straight;
  down.feed = back.feed = 100;
  for (ProgramMove* move : {&up, &down, &back}) move->start[0] = move->end[0] = 100;
  up.start[2] = top - 50;
  up.end[2] = down.start[2] = top;
  down.end[2] = back.start[2] = top - 200;
  down.end[0] = back.start[0] = back.end[0] = 130;
  back.end[2] = top;
  const std::vector<ProgramMove> moves = {up, down, back};
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(moves, corrected);
  const ProgramReport& report = correction.report();
  EXPECT_EQ(report.held_at_travel.line[0], 3U);
  EXPECT_EQ(report.held_starts.count, 1U);
  EXPECT_EQ(report.held_starts.line[0], 4U);
  EXPECT_NEAR(report.largest_held_start.value, 0.02, 1e-4);
  // The end at work is another matter than the beginning.
  EXPECT_EQ(report.status[static_cast<std::size_t>(CorrectionStatus::outside_travel)].line[0], 5U);
  EXPECT_EQ(report.not_proven.count, 0U);
  const test::ControlledMachine control(machine, errors, words);
  WordValues at = corrected.pieces[corrected.first[1] - 1].end;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    ASSERT_GE(corrected.first[i + 1] - corrected.first[i], 3U);
    for (std::size_t k = corrected.first[i]; k < corrected.first[i + 1]; ++k) {
      const WordValues& end = corrected.pieces[k].end;
      for (int j = 0; j <= 8; ++j) {
        const WordValues driven = test::between(at, end, j / 8.0);
        EXPECT_LE(driven[2], top);
        const Eigen::Vector3d actual = control.pose(moves[i], driven, true).translation;
        const Eigen::Vector3d first = control.pose(moves[i], moves[i].start, false).translation;
        const Eigen::Vector3d last = control.pose(moves[i], moves[i].end, false).translation;
        const Eigen::Vector3d along = (last - first).normalized();
        const Eigen::Vector3d off =
            actual - first - along * std::clamp(along.dot(actual - first), 0.0, (last - first).norm());
        // Near the end of the travel by what is missing there, to its side by no more than the tolerance.
        EXPECT_LE(off.norm(), driven[2] > top - 0.05 ? 0.0201 : 1e-3);
      }
      at = end;
    }
  }
}

TEST(ProgramCorrection, WhatCannotBeCorrectedIsSaidByLine) {
  Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  const Basis part{.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 50};
  errors.motions.push_back({machine.find_axis("X"), Component::X, part, {0.03, 0.01}, {}});
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.feed = 100;
  move.line = 4;
  move.end[0] = 20;
  ProgramMove beyond = move, strange = move, back = move;
  beyond.line = 5;
  beyond.start = move.end;
  beyond.end[0] = 70;
  back.line = 6;
  back.start = beyond.end;
  back.end[0] = 30;
  strange.line = 7;
  strange.start = back.end;
  strange.end[static_cast<std::size_t>(AxisWord::B)] = 1;
  ProgramCorrectionOptions options;
  options.limit = 0.035;
  ProgramCorrection correction(machine, errors, words, options);
  CorrectedPieces corrected;
  correction.correct(std::vector<ProgramMove>{move, beyond, back, strange}, corrected);
  const ProgramReport& report = correction.report();
  const StatusCount& unknown = report.status[static_cast<std::size_t>(CorrectionStatus::not_covered)];
  EXPECT_EQ(unknown.count, 1U);
  EXPECT_EQ(unknown.line[0], 5U);
  EXPECT_EQ(report.impossible.line[0], 7U);
  EXPECT_EQ(report.not_proven.line[0], 6U);
  // At X 20 the correction is 28 um, at 30 it is 32 um; the limit is not reached.
  EXPECT_EQ(report.above_limit.count, 0U);
  EXPECT_NEAR(report.largest_shift.value, 0.032, 1e-4);
  EXPECT_EQ(report.largest_shift.line, 6U);
  options.limit = 0.03;
  ProgramCorrection strict(machine, errors, words, options);
  strict.correct(std::vector<ProgramMove>{move, beyond, back}, corrected);
  EXPECT_EQ(strict.report().above_limit.line[0], 6U);
}

TEST(ProgramCorrection, ARotaryMoveKeepsItsDuration) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 13);
  std::vector<ProgramMove> moves = random_program(machine, words, ProgramCoordinates::axes, 1, 1e-3, 7);
  ProgramMove turn = moves[0];
  turn.line = 2;
  turn.start = turn.end;
  turn.end[static_cast<std::size_t>(AxisWord::C)] += 1;
  turn.feed = 4;
  moves.push_back(turn);
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(moves, corrected);
  double minutes = 0;
  for (std::size_t k = corrected.first[1]; k < corrected.first[2]; ++k) {
    EXPECT_EQ(corrected.pieces[k].feed_mode, FeedMode::inverse_time);
    minutes += 1 / corrected.pieces[k].feed;
  }
  EXPECT_NEAR(minutes, 0.25, 1e-12);
  EXPECT_GE(correction.report().inverse_time.count, 1U);
}

TEST(ProgramCorrection, ProgramsForKinematicsOfTheControlAreToolCentreMovesWithTheToolLengthAdded) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 13);
  std::vector<ProgramMove> moves = random_program(machine, words, ProgramCoordinates::tool_centre, 3, 1e-2, 7);
  std::vector<ProgramMove> with_length = moves;
  const std::array<double, 3> length = {0, 0, 30};
  for (std::size_t k = 0; k < moves.size(); ++k) {
    moves[k].tool_length = with_length[k].tool_length = length;
    with_length[k].coordinates = ProgramCoordinates::axes;
    with_length[k].start[2] += 30;
    with_length[k].end[2] += 30;
  }
  ProgramCorrection one(machine, errors, words), other(machine, errors, words);
  CorrectedPieces wanted, got;
  one.correct(moves, wanted);
  ToolCentreMoves adapted(other);
  adapted.correct(with_length, got);
  ASSERT_EQ(wanted.pieces.size(), got.pieces.size());
  for (std::size_t k = 0; k < got.pieces.size(); ++k) {
    for (std::size_t i = 0; i < kAxisWords; ++i)
      EXPECT_NEAR(got.pieces[k].end[i], wanted.pieces[k].end[i] + (i == 2 ? 30 : 0), 1e-9);
  }
}

TEST(ProgramCorrection, ErrorsComposedInOtherWaysAreRefused) {
  ErrorSet errors;
  errors.composition.order = ErrorOrder::after_motion;
  const Machine machine = test::trunnion_mill();
  EXPECT_NE(ProgramCorrection(machine, errors, test::words_of(machine)).problem(), "");
}

}  // namespace
}  // namespace abbe
