#include "abbe/formats/nc/nc_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "abbe/formats/nc/nc_correctors_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

TEST(NcProgram, AMoveStatesWhatIsInForce) {
  const RunProgram run = run_program("G21 G90 G55\nG10 L2 P2 X1 C5\nG43 H1\nG0 X2 Z3\nG1 Z1 C10 F120\nM2\n");
  ASSERT_EQ(run.moves.size(), 2U);
  const ProgramMove& move = run.moves[1];
  EXPECT_EQ(move.line, 5U);
  EXPECT_EQ(move.kind, MoveKind::straight);
  EXPECT_EQ(move.coordinates, ProgramCoordinates::axes);
  EXPECT_EQ(move.feed_mode, FeedMode::per_minute);
  EXPECT_DOUBLE_EQ(move.feed, 120);
  EXPECT_DOUBLE_EQ(move.start[0], 3);
  EXPECT_DOUBLE_EQ(move.start[2], 53);
  EXPECT_DOUBLE_EQ(move.end[2], 51);
  EXPECT_DOUBLE_EQ(move.end[5], 15 * kDegree);
  EXPECT_DOUBLE_EQ(move.tool_length[2], 50);
}

TEST(NcProgram, AFeedIsPerMinuteOfLengthOfAngleOrOfTheMove) {
  const RunProgram run =
      run_program("G20\nF2\nG1 X1\nA90\nX2 A0\nG93 X3 F4\nG95 F.1 S100\nX4\nG94 G21 F6\nG1 X0\nG20 X1\nM2\n");
  ASSERT_EQ(run.moves.size(), 7U);
  EXPECT_DOUBLE_EQ(run.moves[0].feed, 50.8);
  EXPECT_DOUBLE_EQ(run.moves[1].feed, 2 * kDegree);
  EXPECT_DOUBLE_EQ(run.moves[2].feed, 50.8);
  EXPECT_EQ(run.moves[3].feed_mode, FeedMode::inverse_time);
  EXPECT_DOUBLE_EQ(run.moves[3].feed, 4);
  EXPECT_EQ(run.moves[4].feed_mode, FeedMode::per_revolution);
  EXPECT_DOUBLE_EQ(run.moves[4].feed, 2.54);
  // F stands before G21 in the order of execution: it is in inches still.
  EXPECT_DOUBLE_EQ(run.moves[5].feed, 152.4);
  EXPECT_DOUBLE_EQ(run.moves[6].feed, 152.4);
}

TEST(NcProgram, ToolCentreControlStatesThePointInTheWorkpiece) {
  NcProgramOptions options = options_at_zero();
  const RunProgram run = run_program(
      "G43 H1\nG0 X1 Y1 Z1 A0 B0 C0\nG49\nG43.4 H1\nG0 X5 Y5 Z5 A1\nG1 X6 A2 F10\nG49\nG0 X0 Y0 Z0\nM2\n", options);
  ASSERT_EQ(run.moves.size(), 4U);
  EXPECT_EQ(run.moves[2].coordinates, ProgramCoordinates::tool_centre);
  EXPECT_DOUBLE_EQ(run.moves[2].start[2], 5);
  EXPECT_DOUBLE_EQ(run.moves[2].end[2], 5);
  EXPECT_DOUBLE_EQ(run.moves[2].tool_length[2], 50);
  EXPECT_EQ(run.moves[0].coordinates, ProgramCoordinates::axes);
  EXPECT_EQ(run.moves[3].coordinates, ProgramCoordinates::axes);
  // Where the axes stand after the change is not known: those rapid moves are corrected where they end.
  EXPECT_EQ(run.moves[1].start, run.moves[1].end);
  EXPECT_EQ(run.moves[3].start, run.moves[3].end);
  EXPECT_EQ(run.result.uncorrected_moves, 0U);
}

TEST(NcProgram, WhatIsNoMovePassesAsItStands) {
  const std::string text =
      "%\n(a part)\nN10 G21 G90 G94 (metric)\nT1 M6 ; cutter\nS12000 M3\nG4 P0.5\nM8\nG64 P0.01\nM62 P1\nM101 P3\n"
      "N20 G0 X1.000000 Y0.000000 Z0.000000 A0.000000 B0.000000 C0.000000 (to the start)\n"
      "N30 M7 G1 X2.500000 F100\nM5\nM30\n%\n";
  EXPECT_EQ(run_program(text).text, text);
}

TEST(NcProgram, WhatIsResolvedIsReplacedByItsResult) {
  EXPECT_EQ(run_program("G21 G90\n#5=2 #100=[1/8]\n#<_depth>=3\n(DEBUG, x #5 and #100)\nG91 G0 X#5 M8\nX#100 S[10*#5]\n"
                        "O1 repeat [2]\nY1 (loop)\nO1 endrepeat\nM2\nG0 X99\n")
                .text,
            "G21 G90\n#100=0.125\n#<_depth>=3\n(DEBUG, x 2 and 0.125)\n"
            "M8 G0 X2.000000 Y0.000000 Z0.000000 A0.000000 B0.000000 C0.000000\nS20 G0 X2.125000\n"
            "G0 Y1.000000 (loop)\nG0 Y2.000000 (loop)\nM2\n");
}

TEST(NcProgram, CyclesBecomeMovesAndDwells) {
  EXPECT_EQ(
      run_program("G21 G90 G94 F100\nG0 X0 Y0 Z5 A0 B0 C0\nN7 G98 G82 X1 Z-1 R1 P.25 M8 (hole)\nG80\nG64 P.1\n"
                  "G81 X2 Z-1 R1\nM2\n")
          .text,
      "G21 G90 G94 F100\nG0 X0.000000 Y0.000000 Z5.000000 A0.000000 B0.000000 C0.000000\nG61\n"
      "N7 M8 G0 X1.000000 (hole)\nG0 Z1.000000\nG1 Z-1.000000 F100\nG4 P0.25\nG0 Z5.000000\nG64\nG80\nG64 P.1\nG61\n"
      "G0 X2.000000\nG0 Z1.000000\nG1 Z-1.000000\nG0 Z5.000000\nG64 P.1\nM2\n");
}

TEST(NcProgram, G80BesideAnotherCodeEndsTheCycleAndIsNotRepeated) {
  EXPECT_EQ(run_program("G21 G90\nG0 G17 G40 G49 G80 G90\nG0 X0 Y0 Z5 A0 B0 C0\nN5 G80 G0 X1 M8\nM2\n").text,
            "G21 G90\nG0 G17 G40 G49 G80 G90\nG0 X0.000000 Y0.000000 Z5.000000 A0.000000 B0.000000 C0.000000\n"
            "N5 M8 G0 X1.000000\nM2\n");
}

TEST(NcProgram, AByteOrderMarkIsLeftOut) { EXPECT_EQ(run_program("\xEF\xBB\xBFG21\nM2").text, "G21\nM2\n"); }

TEST(NcProgram, BytesOfCommentsPassWhateverTheirCode) {
  const std::string text = "G21 (\xFF\xFE \xE4)\n; \xC3\xA4\x80\nM2\n";
  EXPECT_EQ(run_program(text).text, text);
  EXPECT_EQ(run_program("G21 (\xFF)\r\nM5 ; a\r\n%\r\nM2\r\n").text, "G21 (\xFF)\nM5 ; a\n%\nM2\n%\n");
}

/// Adds to X, and says the moves in inverse time.
class ShiftedMoves final : public MoveCorrector {
 public:
  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : moves) {
      for (const double share : {0.5, 1.0}) {
        if (move.kind == MoveKind::rapid && share < 1) continue;
        CorrectedPiece piece{move.end, 2 * move.feed, FeedMode::inverse_time};
        for (std::size_t k = 0; k < kAxisWords; ++k) {
          piece.end[k] = move.start[k] + share * (move.end[k] - move.start[k]);
        }
        piece.end[0] += 0.25;
        corrected.pieces.push_back(piece);
      }
      corrected.first.push_back(corrected.pieces.size());
    }
  }
};

std::string written_with(MoveCorrector& corrector, std::string_view text, const NcProgramOptions& options) {
  std::string out;
  correct_nc_program(text, "p.ngc", options, corrector, [&](std::string_view part) { out += part; });
  return out;
}

std::string shifted(std::string_view text, NcProgramOptions options = options_at_zero()) {
  options.words = {true, true, false, false, false, false, false, false, false};
  options.start = {0, 0};
  options.decimals_mm = 3;
  ShiftedMoves corrector;
  return written_with(corrector, text, options);
}

TEST(NcProgram, PiecesOfAMoveFollowEachOtherAndModesAreSaidWhereTheyChange) {
  EXPECT_EQ(
      shifted("G21 G90 G94 F3\nG0 X0 Y0\nN9 G1 X2 M8 (cut)\nG1 Y2\nM2\n"),
      "G21 G90 G94 F3\nG0 X0.250 Y0.000\nN9 M8 G93 G1 X1.250 F6 (cut)\nG1 X2.250 F6\nG1 Y1.000 F6\nG1 Y2.000 F6\nM2\n");
}

/// Turns with a correction of X by 1 um more from move to move, in the time of the move.
class CorrectedTurns final : public MoveCorrector {
 public:
  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : moves) {
      CorrectedPiece piece{move.end, move.feed, move.feed_mode};
      piece.end[0] += x_ += 0.001;
      if (move.feed_mode == FeedMode::per_minute) {
        piece.feed = move.feed / (move.end[3] - move.start[3]);
        piece.feed_mode = FeedMode::inverse_time;
      }
      corrected.pieces.push_back(piece);
      corrected.first.push_back(corrected.pieces.size());
    }
  }

 private:
  double x_ = 0;
};

std::string corrected_turns(std::string_view text, int decimals_mm) {
  NcProgramOptions options = options_at_zero();
  options.words = {true, false, false, true, false, false, false, false, false};
  options.decimals_mm = decimals_mm;
  options.decimals_deg = 0;
  CorrectedTurns corrector;
  return written_with(corrector, text, options);
}

TEST(NcProgram, TurnsKeepTheirTimeWhereLinuxCncsLeastFeedInInverseTimeIsFasterThanTheirCorrection) {
  // Inverse times of 3, 3000 and 3 per minute. LinuxCNC 2.9 makes 0.1 mm/min (inch/min) of less.
  EXPECT_EQ(corrected_turns("G21 G94\nG1 A10 F30\nA20 F30000\nA30 F30\nM2\n", 3),
            "G21 G94\nG90 G1 X0.001 A10 F0.003\nG93 G1 X0.002 A20 F3000\nG94 G1 X0.003 A30 F0.003\nM2\n");
  EXPECT_EQ(corrected_turns("G20 G94\nG1 A10 F30\nM2\n", 6), "G20 G94\nG90 G1 X0.0000394 A10 F0.0001182\nM2\n");
  // A turn in inverse time has its time as well; a linear motion is LinuxCNC's as it is.
  EXPECT_EQ(corrected_turns("G21 G93\nG1 A10 F3\nM2\n", 3), "G21 G93\nG90 G94 G1 X0.001 A10 F0.003\nM2\n");
  EXPECT_EQ(corrected_turns("G21 G93\nG1 X.02 A10 F3\nM2\n", 3), "G21 G93\nG90 G1 X0.021 A10 F3\nM2\n");
}

TEST(NcProgram, TurnsKeepTheirFeedPerRevolutionWhereTheirCorrectionMovesLinearAxes) {
  // 20 revolutions of the spindle.
  EXPECT_EQ(corrected_turns("G21 G95 S100\nG1 A10 F.5\nM2\n", 3), "G21 G95 S100\nG90 G1 X0.001 A10 F0.00005\nM2\n");
}

/// Every rapid move goes a little ahead first, exactly.
class AheadFirst final : public MoveCorrector {
 public:
  explicit AheadFirst(double way) : way_(way) {}
  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : moves) {
      if (move.kind == MoveKind::rapid) {
        CorrectedPiece& piece = corrected.pieces.emplace_back();
        piece.end = move.start;
        piece.end[0] += way_;
        piece.exact = true;
      }
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
      corrected.first.push_back(corrected.pieces.size());
    }
  }

 private:
  double way_;
};

std::string ahead_first(std::string_view text, double way = 0.25) {
  NcProgramOptions options = options_at_zero();
  options.words = {true, true, true, false, false, false, false, false, false};
  options.decimals_mm = 2;
  AheadFirst corrector(way);
  return written_with(corrector, text, options);
}

TEST(NcProgram, ExactPiecesStandInExactPathModeAndTheProgramsOwnModeIsSaidAgain) {
  EXPECT_EQ(ahead_first("G21 G90 G94 F9\nN5 G0 X1 Y0 Z0 M8 (there)\nG1 X2\nG0 X3\nM5\nM2\n"),
            "G21 G90 G94 F9\nG61\nN5 M8 G0 X0.25 Y0.00 Z0.00 (there)\nG64\nG0 X1.00\nG1 X2.00 F9\n"
            "G61\nG0 X2.25\nG64\nG0 X3.00\nM5\nM2\n");
  // The mode that is in force where the move stands, and none where the path is exact by itself.
  EXPECT_EQ(ahead_first("G21 G90 G64 P.5\nG0 X1 Y0 Z0\nG61\nG0 X2\nG61.1\nG0 X3\nG64\nG0 X4\nM2\n"),
            "G21 G90 G64 P.5\nG61\nG0 X0.25 Y0.00 Z0.00\nG64 P.5\nG0 X1.00\nG61\nG0 X1.25\nG0 X2.00\nG61.1\nG0 X2.25\n"
            "G0 X3.00\nG64\nG61\nG0 X3.25\nG64\nG0 X4.00\nM2\n");
  // A piece that changes no word is not written, nor are modes for it.
  EXPECT_EQ(ahead_first("G21 G90 G94\nG1 X1 Y0 Z0 F9\nG0 X2\nM2\n", 1e-3),
            "G21 G90 G94\nG1 X1.00 Y0.00 Z0.00 F9\nG0 X2.00\nM2\n");
}

TEST(NcProgram, G92TellsTheControlTheSameOffsetFromWhereItStands) {
  // The control stands at 1.25, not at 1: with X0 its offset would be 0.25 too large.
  EXPECT_EQ(shifted("G21 G90\nG0 X1 Y1\nG92 X0\nG0 X0\nX5\nM2\n"),
            "G21 G90\nG0 X1.250 Y1.000\nG92 X0.2500000000\nG0 X5.250\nM2\n");
  EXPECT_EQ(shifted("G21 G90\nG0 X1 Y1\nG10 L20 P1 X0\nG0 X0\nX5\nM2\n"),
            "G21 G90\nG0 X1.250 Y1.000\nG10 L2 P1 X1.0000000000\nG0 X5.250\nM2\n");
}

TEST(NcProgram, OtherWordsOfABlockWithAnOffsetStay) {
  EXPECT_EQ(shifted("G90\nG0 X1 Y1\nN4 M8 G92 X0 F7 (zero)\nN5 G10 L20 P2 Y0 S5\nG91 G55 G92 X1\nG90 G1 X1 Y2\nM2\n"),
            "G90\nG21 G0 X1.250 Y1.000\nN4 M8 F7 G92 X0.2500000000 (zero)\nN5 S5 G10 L2 P2 Y1.0000000000\n"
            "G55 G92 X1.2500000000\nG90 G93 G1 Y1.000 F14\nG1 Y2.000 F14\nM2\n");
}

TEST(NcProgram, FeedsOfAnglesAreDegreesPerMinute) {
  EXPECT_EQ(run_program("G21 G90 G94\nG1 A90 F360\nX1\nA0\nG20\nX1 F2\nM2\n").text,
            "G21 G90 G94\nG1 X0.000000 Y0.000000 Z0.000000 A90.000000 B0.000000 C0.000000 F360\nG1 X1.000000\n"
            "G1 A0.000000\nG20\nG1 X1.0000000 F2\nM2\n");
}

/// Keeps the moves but for a length too small for the program's decimals, which goes where it was not, or is lost.
class HairsBreadth final : public MoveCorrector {
 public:
  void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : moves) {
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
      corrected.pieces.back().end[1] += move.end[3] > 0 ? 6e-4 : 0;
      corrected.first.push_back(corrected.pieces.size());
    }
  }
};

TEST(NcProgram, AFeedOfAnglesInInchesIsNotTheFeedOfLengthsBehindThem) {
  EXPECT_EQ(run_program("G21 G90 G94 F300\nG0 X1\nG20\nG1 A90\nG21\nG1 X5\nM2\n").text,
            "G21 G90 G94 F300\nG0 X1.000000 Y0.000000 Z0.000000 A0.000000 B0.000000 C0.000000\nG20\n"
            "G1 A90.000000 F300\nG21\nG1 X5.000000 F300\nM2\n");
}

TEST(NcProgram, AWayThatRoundingLeavesOfTheSamePlaceIsNone) {
  // 0.1 + 0.2 is not 0.3: F is still of the angle.
  const RunProgram run = run_program("G21 G90 G94\nG0 X[.1+.2] Y0 Z0 A0 B0 C0\nG1 X.3 A90 F360\nM2\n");
  EXPECT_NE(run.moves[1].start[0], run.moves[1].end[0]);
  EXPECT_DOUBLE_EQ(run.moves[1].feed, 360 * kDegree);
  EXPECT_NE(run.text.find("\nG1 A90.000000 F360\n"), std::string::npos) << run.text;
  NcProgramOptions options = options_at_zero();
  options.decimals_mm = 9;
  EXPECT_NE(run_program("G21 G90 G94\nG0 X1\nG1 X1.00000009 A90 F360\nM2\n", options).text.find("G1 A90.000000 F360"),
            std::string::npos);
}

TEST(NcProgram, AFeedThatRoundingWouldTurnIntoAnotherBecomesATime) {
  NcProgramOptions options = options_at_zero();
  options.words = {true, true, false, true, false, false, false, false, false};
  options.decimals_mm = options.decimals_deg = 3;
  HairsBreadth corrector;
  // 90 degrees in a quarter of a minute; 2^-13 mm at 360 mm/min.
  EXPECT_EQ(written_with(corrector, "G21 G90 G94 F360\nG1 A90\nX2\nA180 X2.0001220703125\nM2\n", options),
            "G21 G90 G94 F360\nG1 X0.000 Y0.001 A90.000 F0.004\nG1 X2.000 F360\nG93 G1 A180.000 F2949120\nM2\n");
}

TEST(NcProgram, AStopHoldsBehindTheLastPieceOfItsMove) {
  EXPECT_EQ(shifted("G21 G90 F3\nG1 X2 M0\nM2\n"), "G21 G90 F3\nG93 G1 X1.250 Y0.000 F6\nG1 X2.250 F6\nM0\nM2\n");
}

TEST(NcProgram, InchesAreWrittenWithOneMoreDecimal) {
  EXPECT_EQ(shifted("G20 G90\nG0 X1\nG21 X2\nM2\n"), "G20 G90\nG0 X1.0098 Y0.0000\nG21 G0 X2.250\nM2\n");
}

TEST(NcProgram, WhatTheProgramLeavesToTheControlIsSaid) {
  EXPECT_EQ(shifted("G0 X1\nG1 X2 F1\n"), "G21 G90 G0 X1.250 Y0.000\nG93 G1 X1.750 F2\nG1 X2.250 F2\n");
}

TEST(NcProgram, AxesThatWereNotSentAnywhereAreNotMoved) {
  NcProgramOptions options;
  options.words = {true, true, true, true, false, true, false, false, false};
  const RunProgram run = run_program("G21 G90\nG53 G0 Z0\nG0 A0 C0\nG0 X1 Y2\nG1 Z-1 F10\nM2\n", options);
  EXPECT_EQ(run.text,
            "G21 G90\nG0 Z0.000000\nG0 A0.000000 C0.000000\nG0 X1.000000 Y2.000000\nG94 G1 Z-1.000000 F10\nM2\n");
  // The third ends where all axes are known, and is corrected.
  EXPECT_EQ(run.result.uncorrected_moves, 2U);
  EXPECT_EQ(run.result.first_uncorrected_line, 2U);
  ASSERT_EQ(run.moves.size(), 2U);
  EXPECT_EQ(run.moves[0].start, run.moves[0].end);
}

TEST(NcProgram, AWorkOffsetThatNobodyHasSaidIsToldOf) {
  EXPECT_EQ(run_program("G53 G0 X1\nG10 L2 P2 X5\nG55 X1\nG56 X2\nM2\n").result.first_assumed_offset_line, 4U);
  NcProgramOptions options = options_at_zero();
  options.parameters[5221] = 0;
  EXPECT_EQ(run_program("G0 X1\nM2\n", options).result.first_assumed_offset_line, 0U);
}

TEST(NcProgram, ParametersAndToolsComeFromFilesOfLinuxCnc) {
  const auto parameters = parse_nc_parameters("5220\t2\n5241 10.5\n; comment\n\n5161 -0.000000\r\n", "p.var");
  EXPECT_EQ(parameters.at(5241), 10.5);
  const NcToolTable tools = parse_nc_tools("T1 P1 Z50.0 D6 ;endmill\nT12 P3 X-1.5 Z+20 A90\n", "t.tbl");
  EXPECT_EQ(tools.at(1)[2], 50);
  EXPECT_EQ(tools.at(12)[0], -1.5);
  EXPECT_DOUBLE_EQ(tools.at(12)[3], 90 * kDegree);
  EXPECT_EQ(parse_nc_tools("T1 Z2", "t.tbl", true).at(1)[2], 50.8);
  NcProgramOptions options = options_at_zero();
  options.parameters = parameters;
  const RunProgram run = run_program("G0 X1\nG0 Y#5241\nM2\n", options);
  EXPECT_EQ(run.moves[0].end[0], 11.5);
  EXPECT_EQ(run.moves[1].end[1], 10.5);
  EXPECT_EQ(message_of([] { parse_nc_tools("Z5\n", "t.tbl"); }),
            "t.tbl:1:1: Z5: the number of the tool is missing; expected T");
  EXPECT_EQ(message_of([] { parse_nc_tools("T1 Z5,0\n", "t.tbl"); }),
            "t.tbl:1:5: 5,0: is not a number that can be used; expected an offset in mm or degrees");
  EXPECT_EQ(message_of([] { parse_nc_parameters("5220 1\n5220 2\n", "p.var"); }),
            "p.var:2:1: 5220 2: this parameter has a value already");
  EXPECT_EQ(message_of([] { parse_nc_parameters("9999 1\n", "p.var"); }),
            "p.var:1:1: 9999: is not a whole number; expected the number of a parameter, 1 to 5601");
}

TEST(NcProgram, AUnitThatChangesBesideAMoveAtWorkIsSaidBeforeItsFeed) {
  // The control takes F of a block before its G20.
  EXPECT_EQ(run_program("G21 G90 G94 F300\nG0 X1\nN5 M8 G20 G1 X1 (in)\nX2 F5\nG21 X5 F90\nM2\n").text,
            "G21 G90 G94 F300\nG0 X1.000000 Y0.000000 Z0.000000 A0.000000 B0.000000 C0.000000\nN5 M8 G20 (in)\n"
            "G1 X1.0000000 F11.811024\nG1 X2.0000000 F5\nG21\nG1 X5.000000 F2286\nM2\n");
}

TEST(NcProgram, CommentsSayWhatParametersAreBehindTheirBlock) {
  EXPECT_EQ(run_program("#1=1\n#1=5 (debug, #1)\n#31=7 M2\n").text, "(debug, 5)\n#31=7\nM2\n");
}

TEST(NcProgram, ASubprogramHasItsCallersNumbersAndNamesOfItsOwn) {
  const RunProgram run = run_program(
      "#<a>=5\n#1=1\nM98 P100 L2\nG0 X#<a> Y#1\nM2\nO100\nG0 Z[EXISTS[#<a>]]\n#<a>=3\n#1=[#1+1]\nG0 A#<a>\nM99\n");
  ASSERT_EQ(run.moves.size(), 5U);
  EXPECT_EQ(run.moves[2].end[2], 0);
  EXPECT_EQ(run.moves[4].end[0], 5);
  EXPECT_EQ(run.moves[4].end[1], 3);
}

TEST(NcProgram, ACycleGoesToTheNextHoleAtTheHeightWhereItStandsAboveR) {
  const RunProgram run = run_program("G0 Z10 F9\nG98 G81 X1 Z-1 R2\nX2 G99 R4\nX3 G98 R3\nG80\nM2\n");
  const std::array<double, 3> lifts = {10, 10, 4};
  std::vector<double> found;
  double x = 0;
  for (const ProgramMove& move : run.moves) {
    if (move.end[0] != x) found.push_back(move.end[2]);
    x = move.end[0];
  }
  EXPECT_TRUE(std::equal(lifts.begin(), lifts.end(), found.begin(), found.end()));
  // At the end to where the series began.
  EXPECT_EQ(run.moves.back().end[2], 10);
}

TEST(NcProgram, ATapDwellsAsLongAsTheCycleBeforeIt) {
  const std::string text = run_program("F9 M3\nG0 Z5\nG82 X1 Z-1 R2 P.5\nG84 X2 Z-1 R2\nG80\nM2\n").text;
  EXPECT_NE(text.find("M4\nG4 P0.5\n"), std::string::npos) << text;
}

TEST(NcProgram, ACycleBetweenStopsInCornersIsInExactPathMode) {
  const std::string text = run_program("F9 G61.1\nG0 Z5\nG81 X1 Z-1 R2\nG80\nM2\n").text;
  EXPECT_NE(text.find("\nG61\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nG61.1\nG80\n"), std::string::npos) << text;
}

TEST(NcProgram, AnOrientedSpindleHasItsAngle) {
  EXPECT_EQ(run_program("M19 R90 P1 Q2\nM2\n").text, "M19 R90 P1 Q2\nM2\n");
}

TEST(NcProgram, ResultsDoNotDependOnTheBatch) {
  const std::string text =
      "G21 F9\nO1 repeat [50]\nG91 G1 X1 Y.5\nG90 G92 X[#5420]\nG2 X[#5420+2] I1 (c)\nG4 P1\nG55\nG0 Z1\nG54\nO1 "
      "endrepeat\nM2\n";
  const std::string whole = run_program(text).text;
  for (const std::size_t batch : {1U, 2U, 7U}) {
    NcProgramOptions options = options_at_zero();
    options.batch = batch;
    EXPECT_EQ(run_program(text, options).text, whole);
  }
}

}  // namespace
}  // namespace abbe
