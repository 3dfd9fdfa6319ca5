// Programs for axes with reversal values, driven on machines whose axes have play: an independent route.
#include "abbe/compensate/program/program_reversals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/compensate/machine_with_play_for_test.h"
#include "abbe/compensate/program/program_correction.h"
#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/program/tool_centre_moves.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using test::MachineWithPlay;

constexpr double kTolerance = 1e-3;             // mm
constexpr double kOrientationTolerance = 1e-5;  // rad

struct MissedWithPlay {
  double point = 0;  ///< mm, of the actual tool from the commanded path of its move
  double both = 0;   ///< the same with the direction, both in their tolerances: sqrt(2) where each is kept
};

using Place = Eigen::Matrix<double, 6, 1>;

/// Distance of a place from a chain of straight lines, of its first n numbers.
double distance_from(const Place& place, const std::vector<Place>& path, Eigen::Index n, std::size_t& near) {
  double least = 1e300;
  // The tool goes on along the path and is never far from where it was.
  const std::size_t first = near > 30 ? near - 30 : 0, last = std::min(path.size() - 1, near + 400);
  for (std::size_t p = first; p < last; ++p) {
    const Eigen::VectorXd along = (path[p + 1] - path[p]).head(n), there = (place - path[p]).head(n);
    const double square = along.squaredNorm();
    const double s = square > 0 ? std::clamp(there.dot(along) / square, 0.0, 1.0) : 0.0;
    const double distance = (there - s * along).norm();
    if (distance >= least) continue;
    least = distance;
    near = p;
  }
  return least;
}

/// Drives moves and measures the actual tool against the commanded path from a move on.
MissedWithPlay drive(MachineWithPlay& machine, const std::vector<ProgramMove>& moves, const CorrectedPieces& pieces,
                     std::size_t measured_from, int samples) {
  constexpr int kPlaces = 800;
  MissedWithPlay missed;
  WordValues at = moves.front().start;
  std::vector<Place> path(kPlaces + 1);
  const auto place = [&](const RigidTransform& pose) {
    Place scaled;
    scaled << pose.translation / kTolerance, pose.rotation * machine.tool_direction() / kOrientationTolerance;
    return scaled;
  };
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const ProgramMove& move = moves[i];
    if (i >= measured_from) {
      const MovePath way(move);
      for (int k = 0; k <= kPlaces; ++k) {
        WordValues words;
        way.at(static_cast<double>(k) / kPlaces, words);
        path[static_cast<std::size_t>(k)] = place(machine.nominal(move, words));
      }
    }
    std::size_t near_point = 0, near = 0;
    for (std::size_t k = pieces.first[i]; k < pieces.first[i + 1]; ++k) {
      for (int j = 1; j <= samples; ++j) {
        machine.drive(machine.commands(move, test::between(at, pieces.pieces[k].end, double(j) / samples)));
        if (i < measured_from) continue;
        const Place actual = place(machine.actual(move));
        missed.point = std::max(missed.point, kTolerance * distance_from(actual, path, 3, near_point));
        missed.both = std::max(missed.both, distance_from(actual, path, 6, near));
      }
      at = pieces.pieces[k].end;
    }
  }
  return missed;
}

CorrectedPieces as_programmed(const std::vector<ProgramMove>& moves) {
  CorrectedPieces pieces;
  for (const ProgramMove& move : moves) {
    pieces.first.push_back(pieces.pieces.size());
    constexpr int kParts = 60;
    const MovePath path(move);
    for (int k = 1; k <= kParts; ++k) {
      CorrectedPiece piece{{}, move.feed, move.feed_mode};
      path.at(static_cast<double>(k) / kParts, piece.end);
      pieces.pieces.push_back(piece);
    }
  }
  pieces.first.push_back(pieces.pieces.size());
  return pieces;
}

/// Lost motion in every axis: tens of micrometres and microradians.
ErrorSet errors_with_play(const Machine& machine, std::uint64_t seed, bool geometric) {
  ErrorSet errors;
  if (geometric) errors = test::mixed_errors(machine, seed);
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    errors.reversals.push_back({i, -uniform(generator) * (rotary ? 60e-6 : 0.02), rotary ? 2e-6 : 1e-3});
  }
  return errors;
}

/// There and back through the whole of the middle of the travel, so that every axis has a direction and is settled.
void begin_program(const Machine& machine, const WordAxes& words, ProgramCoordinates coordinates, const WordValues& to,
                   std::vector<ProgramMove>& moves) {
  const MachineWithPlay nominal(machine, {}, words);
  const auto to_words = [&](const WordValues& axis_words) {
    ProgramMove on_axes;
    WordValues result = axis_words;
    if (coordinates == ProgramCoordinates::axes) return result;
    const Eigen::Vector3d point = nominal.nominal(on_axes, axis_words).translation;
    for (std::size_t i = 0; i < 3; ++i) result[i] = point[static_cast<Eigen::Index>(i)];
    return result;
  };
  WordValues aside = to;
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (words.axis[i] != Machine::npos) aside[i] -= i >= 3 && i < 6 ? 0.01 : 3;
  }
  ProgramMove move;
  move.line = 1;
  move.kind = MoveKind::rapid;
  move.coordinates = coordinates;
  move.feed = 1000;
  move.start = to_words(aside);
  move.end = to_words(to);
  moves.push_back(move);
}

ProgramMove next_move(const ProgramMove& before, MoveKind kind, const WordValues& end) {
  ProgramMove move = before;
  ++move.line;
  move.kind = kind;
  move.start = before.end;
  move.end = end;
  return move;
}

struct Outcome {
  MissedWithPlay corrected, programmed;
  ProgramReport report;
};

Outcome outcome(const Machine& machine, const ErrorSet& errors, const std::vector<ProgramMove>& moves, int samples) {
  const WordAxes words = test::words_of(machine);
  ProgramCorrection correction(machine, errors, words);
  EXPECT_EQ(correction.problem(), "");
  CorrectedPieces corrected;
  correction.correct(moves, corrected);
  Outcome result;
  result.report = correction.report();
  EXPECT_EQ(result.report.not_proven.count, 0U);
  MachineWithPlay driven(machine, errors, words), plain(machine, errors, words);
  result.corrected = drive(driven, moves, corrected, 1, samples);
  result.programmed = drive(plain, moves, as_programmed(moves), 1, 2);
  return result;
}

TEST(ProgramReversals, CirclesOfAxesWithPlayStayWithinTheTolerance) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  for (const bool geometric : {false, true}) {
    const ErrorSet errors = errors_with_play(machine, 3, geometric);
    for (const ArcPlane plane : {ArcPlane::XY, ArcPlane::ZX, ArcPlane::YZ}) {
      std::vector<ProgramMove> moves;
      std::mt19937_64 generator(5);
      begin_program(machine, words, ProgramCoordinates::axes, test::random_axis_words(machine, words, generator),
                    moves);
      ProgramMove circle = next_move(moves.back(), MoveKind::arc_counterclockwise, moves.back().end);
      circle.plane = plane;
      circle.arc_centre = {circle.start[0] + 11, circle.start[1] - 7, circle.start[2] + 9};
      moves.push_back(circle);
      const Outcome found = outcome(machine, errors, moves, 5);
      EXPECT_LE(found.corrected.point, kTolerance);
      EXPECT_GE(found.programmed.point, 8e-3);
      // The beginning of three axes, two quadrants of two each, and where the circle begins in negative direction;
      // errors may turn an axis round besides.
      const std::size_t first = plane == ArcPlane::XY ? 0 : plane == ArcPlane::ZX ? 2 : 1, second = (first + 1) % 3;
      const std::size_t turned = (circle.arc_centre[second] < circle.start[second] ? 1U : 0U) +
                                 (circle.arc_centre[first] > circle.start[first] ? 1U : 0U);
      std::size_t taken_up = 0;
      for (const StatusCount& count : found.report.take_ups) taken_up += count.count;
      if (geometric) {
        EXPECT_GE(taken_up, 7U + turned);
      } else {
        EXPECT_EQ(taken_up, 7U + turned);
      }
    }
  }
}

TEST(ProgramReversals, RandomMovesOfManyMachinesStayWithinTheTolerance) {
  std::mt19937_64 generator(17);
  std::size_t taken_up = 0;
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::nutating_head_mill(),
                                 test::three_axis_mill(), test::gantry_fork_head(), test::redundant_gantry()}) {
    SCOPED_TRACE(machine.name);
    const WordAxes words = test::words_of(machine);
    for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
      const ErrorSet errors = errors_with_play(machine, generator(), true);
      std::vector<ProgramMove> moves;
      begin_program(machine, words, coordinates, test::random_axis_words(machine, words, generator), moves);
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (int n = 0; n < 6; ++n) {
        WordValues end = moves.back().end;
        for (std::size_t i = 0; i < kAxisWords; ++i) {
          if (words.axis[i] == Machine::npos || generator() % 4 == 0) continue;
          end[i] += (i >= 3 && i < 6 ? 0.05 : 8) * uniform(generator);
        }
        moves.push_back(next_move(moves.back(), MoveKind::straight, end));
      }
      const Outcome found = outcome(machine, errors, moves, 4);
      EXPECT_LE(found.corrected.point, kTolerance);
      EXPECT_GE(found.programmed.point, 10e-3);
      if (machine.axes.size() > 3) {
        const double left = found.report.largest_orientation_left.value / kOrientationTolerance;
        EXPECT_LE(found.corrected.both, std::numbers::sqrt2 + left);
      }
      for (const StatusCount& count : found.report.take_ups) taken_up += count.count;
    }
  }
  EXPECT_GE(taken_up, 100U);
}

TEST(ProgramReversals, CommandsGetHalfOfItAgainstTheDirectionOfTheirLastMotion) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  errors.reversals = {{machine.find_axis("X"), -0.012, 0}, {machine.find_axis("Y"), 0.004, 0}};
  ProgramMove out;
  out.line = 1;
  out.kind = MoveKind::straight;
  out.feed = 600;
  out.start[1] = out.end[1] = 50;  // within the travel
  out.start[0] = 10;
  out.end[0] = 30;
  WordValues end = out.end;
  end[0] = 10;
  end[1] = 55;
  const ProgramMove back = next_move(out, MoveKind::straight, end);
  end[2] = -40;
  const ProgramMove down = next_move(back, MoveKind::rapid, end);
  ProgramCorrection correction(machine, errors, words);
  ASSERT_EQ(correction.reversals().size(), 2U);
  EXPECT_DOUBLE_EQ(correction.reversals()[0].dead_band, 1.25e-4);
  CorrectedPieces corrected;
  correction.correct(std::vector<ProgramMove>{out, back, down}, corrected);
  const std::vector<std::array<double, 3>> wanted = {
      {10.006, 50, 0},     {30.006, 50, 0},                          // half of the gap first, Y has not moved
      {29.994, 50, 0},     {29.994, 49.998, 0}, {9.994, 54.998, 0},  // X all of it, Y half
      {9.994, 54.998, -40}};                                         // nothing turns round
  ASSERT_EQ(corrected.pieces.size(), wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(corrected.pieces[k].end[i], wanted[k][i], 1e-9) << k;
    EXPECT_EQ(corrected.pieces[k].feed_mode, FeedMode::per_minute);
  }
  EXPECT_EQ(corrected.first, (std::vector<std::size_t>{0, 2, 5, 6}));
  const ProgramReport& report = correction.report();
  EXPECT_EQ(report.take_ups[machine.find_axis("X")].count, 2U);
  EXPECT_EQ(report.direction_unknown[machine.find_axis("X")].count, 0U);
  EXPECT_EQ(report.direction_unknown[machine.find_axis("Y")].count, 1U);
  EXPECT_NEAR(report.by_axis[machine.find_axis("X")].value, 0.006, 1e-12);
  EXPECT_EQ(report.largest_shift.approach[machine.find_axis("Y")], 1);
}

// LinuxCNC 2.9 may stand beside its place after rapid moves of a cycle or two between which it rounds corners.
TEST(ProgramReversals, TakeUpsOfRapidMovesAreExactAndNothingElseIs) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  errors.reversals = {{machine.find_axis("X"), -0.012, 0}};
  ProgramMove out;
  out.line = 1;
  out.kind = MoveKind::rapid;
  out.end[0] = 30;
  WordValues end = out.end;
  end[0] = 10;
  ProgramMove back = next_move(out, MoveKind::straight, end);
  back.feed = 600;
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(std::vector<ProgramMove>{out, back}, corrected);
  ASSERT_EQ(corrected.first, (std::vector<std::size_t>{0, 2, 4}));
  const bool exact[] = {true, false, false, false};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(corrected.pieces[k].exact, exact[k]) << k;
}

TEST(ProgramReversals, MotionsBesideTheProgramLeaveTheDirectionOfTheirAxesUnknown) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  errors.reversals = {{machine.find_axis("X"), -0.012, 0}, {machine.find_axis("Y"), -0.004, 0}};
  ProgramMove first;
  first.line = 1;
  first.end[0] = first.end[1] = 30;
  ProgramMove second = first;
  second.line = 2;
  second.start = first.end;
  second.start[0] = 50;  // X came there by a word that is not a move
  second.end = second.start;
  second.end[2] = -10;
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(std::vector<ProgramMove>{first, second}, corrected);
  EXPECT_NEAR(corrected.pieces.back().end[0], 50, 1e-12);
  EXPECT_NEAR(corrected.pieces.back().end[1], 30.002, 1e-12);
}

TEST(ProgramReversals, ResultsDoNotDependOnBatchesOrThreads) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = errors_with_play(machine, 7, true);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<ProgramMove> moves;
  begin_program(machine, words, ProgramCoordinates::axes, test::random_axis_words(machine, words, generator), moves);
  for (int n = 0; n < 600; ++n) {
    WordValues end = moves.back().end;
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      if (words.axis[i] != Machine::npos && generator() % 3 != 0) end[i] += (i >= 3 ? 1e-4 : 0.05) * uniform(generator);
    }
    moves.push_back(next_move(moves.back(), n % 50 == 0 ? MoveKind::rapid : MoveKind::straight, end));
  }
  const auto run = [&](std::size_t batch, int threads, std::size_t& taken_up) {
    ProgramCorrectionOptions options;
    options.threads = threads;
    ProgramCorrection correction(machine, errors, words, options);
    std::vector<double> numbers = test::numbers_in_batches(correction, moves, batch);
    taken_up = 0;
    for (const StatusCount& count : correction.report().take_ups) taken_up += count.count;
    return numbers;
  };
  std::size_t all = 0, single = 0, few = 0;
  const std::vector<double> one = run(601, 1, all);
  EXPECT_EQ(one, run(1, 2, single));
  EXPECT_EQ(one, run(90, 2, few));
  EXPECT_GE(all, 100U);
  EXPECT_EQ(all, single);
  EXPECT_EQ(all, few);
}

TEST(ProgramReversals, ALargerDeadBandComesOnTopOfTheTolerance) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = errors_with_play(machine, 3, true);
  std::vector<ProgramMove> moves;
  std::mt19937_64 generator(5);
  begin_program(machine, words, ProgramCoordinates::axes, test::random_axis_words(machine, words, generator), moves);
  for (const double x : {60.0, -60.0, 50.0}) {
    WordValues end = moves.back().end;
    end[0] += x;
    moves.push_back(next_move(moves.back(), MoveKind::straight, end));
  }
  std::array<std::size_t, 2> taken_up{};
  std::array<double, 2> missed{};
  for (std::size_t k = 0; k < 2; ++k) {
    ProgramCorrectionOptions options;
    options.reversal_dead_band = k == 0 ? 0 : 0.006;
    ProgramCorrection correction(machine, errors, words, options);
    CorrectedPieces corrected;
    correction.correct(moves, corrected);
    EXPECT_EQ(correction.report().not_proven.count, 0U);
    for (const StatusCount& count : correction.report().take_ups) taken_up[k] += count.count;
    MachineWithPlay driven(machine, errors, words);
    missed[k] = drive(driven, moves, corrected, 1, 4).point;
  }
  EXPECT_LE(missed[0], kTolerance);
  EXPECT_LE(missed[1], kTolerance + std::sqrt(3.0) * 0.006);
  // Y and Z stand still but for their corrections.
  EXPECT_LT(taken_up[1], taken_up[0]);
}

TEST(ProgramReversals, TheDeadBandOfARotaryAxisIsThatOfTheToolInForce) {
  // The machine file's tool is short, that of the program is not.
  Machine machine = test::swivel_head_mill();
  machine.tool_offset = {0, 0, -2};
  machine.tool_reference = machine.axes[machine.find_axis("B")].point;
  const std::size_t b = machine.find_axis("B");
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  errors.reversals = {{b, -400e-6, 0}};
  std::vector<ProgramMove> moves;
  ProgramMove move;
  move.line = 1;
  move.kind = MoveKind::straight;
  move.feed = 1000;
  move.tool_length = {0, 0, 300};
  move.start[0] = move.end[0] = 1000;
  move.start[2] = move.end[2] = -300;
  move.end[4] = 0.02;
  moves.push_back(move);
  for (const double turn : {-390e-6, -80e-6, 300e-6, -20e-6, 0.001}) {
    WordValues end = moves.back().end;
    end[4] += turn;
    moves.push_back(next_move(moves.back(), MoveKind::straight, end));
  }
  for (const bool wide : {false, true}) {
    SCOPED_TRACE(wide);
    ProgramCorrectionOptions options;
    options.reversal_dead_band = 0.01;
    if (wide) options.tolerance.orientation = 0.1;  // so that the lever decides
    ProgramCorrection correction(machine, errors, words, options);
    ASSERT_EQ(correction.problem(), "");
    CorrectedPieces corrected;
    correction.correct(moves, corrected);
    EXPECT_EQ(correction.report().not_proven.count, 0U);
    if (wide) {
      EXPECT_NEAR(correction.reversals().at(0).dead_band, 0.01 / 2, 1e-5);
    } else {
      EXPECT_EQ(correction.reversals().at(0).dead_band, options.tolerance.orientation);
    }
    MachineWithPlay driven(machine, errors, words), plain(machine, errors, words);
    EXPECT_LE(drive(driven, moves, corrected, 1, 4).point, kTolerance + 0.01);
    EXPECT_GE(drive(plain, moves, as_programmed(moves), 1, 4).point, 0.05);
    // The start and every turn back; with the wide dead band not that of the smallest motion.
    EXPECT_EQ(correction.report().take_ups[b].count, wide ? 3U : 5U);
  }
}

TEST(ProgramReversals, ThreadsAndTapsCountWhereTheirAxesTurnRound) {
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  const auto counted = [&](const char* axis, SpindleMove spindle, double z_before) {
    ErrorSet errors;
    errors.reversals = {{machine.find_axis(axis), -0.01, 0}};
    ProgramMove there;
    there.line = 1;
    there.start[0] = 100;
    there.end[0] = 110;
    there.start[2] = z_before;
    there.end[2] = -50;
    ProgramMove cut = there;
    cut.line = 2;
    cut.kind = MoveKind::straight;
    cut.spindle = spindle;
    cut.feed_mode = FeedMode::per_revolution;
    cut.feed = 1.5;
    cut.start = cut.end = there.end;
    cut.end[2] = -70;
    ProgramCorrection correction(machine, errors, words);
    CorrectedPieces corrected;
    correction.correct(std::vector<ProgramMove>{there, cut}, corrected);
    return correction.report().play_with_spindle.count;
  };
  const SpindleMove thread = SpindleMove::thread, tap = SpindleMove::rigid_tapping;
  for (const SpindleMove spindle : {thread, tap}) {
    EXPECT_EQ(counted("X", spindle, -60), 0U);
    EXPECT_EQ(counted("Z", spindle, -60), 1U);
    EXPECT_EQ(counted("Z", spindle, -50), 1U);  // the direction before is not known
  }
  EXPECT_EQ(counted("Z", thread, -40), 0U);
  EXPECT_EQ(counted("Z", tap, -40), 1U);  // at the bottom
}

TEST(ProgramReversals, TakeUpsInInverseTimeAreCounted) {
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  errors.reversals = {{machine.find_axis("C"), -50e-6, 0}};
  ProgramMove out;
  out.line = 1;
  out.kind = MoveKind::straight;
  out.feed = 600;
  out.end[0] = 20;
  out.end[5] = 0.5;
  const ProgramMove back = next_move(out, MoveKind::straight, out.start);
  ProgramCorrection correction(machine, errors, words);
  CorrectedPieces corrected;
  correction.correct(std::vector<ProgramMove>{out, back}, corrected);
  std::size_t in_inverse_time = 0;
  for (const CorrectedPiece& piece : corrected.pieces) in_inverse_time += piece.feed_mode == FeedMode::inverse_time;
  EXPECT_GE(in_inverse_time, 2U);
  EXPECT_EQ(correction.report().inverse_time.count, in_inverse_time);
  EXPECT_EQ(correction.report().take_ups[machine.find_axis("C")].count, 2U);
}

}  // namespace
}  // namespace abbe
