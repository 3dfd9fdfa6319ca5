#include "abbe/compensate/program/move_splitting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/compensate/machine_with_play_for_test.h"
#include "abbe/compensate/program/random_moves_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

struct Ratios {
  std::vector<double> all;  ///< bound / largest sample
  double median() {
    std::sort(all.begin(), all.end());
    return all.empty() ? 0 : all[all.size() / 2];
  }
};

TEST(MoveSplitting, NoSampleOfAnyPieceExceedsItsBound) {
  std::mt19937_64 generator(11);
  int sampled = 0;
  Ratios lines, arcs, directions;
  for (const Machine& machine :
       {test::trunnion_mill(), test::swivel_head_mill(), test::head_table_mill(), test::nutating_head_mill(),
        test::gantry_fork_head(), test::three_axis_mill(), test::moving_table_cmm(), test::lathe(),
        test::three_axis_head(), test::redundant_gantry()}) {
    SCOPED_TRACE(machine.name);
    const WordAxes words = test::words_of(machine);
    for (int set = 0; set < 12; ++set) {
      const ErrorSet errors = test::mixed_errors(machine, generator());
      NodeCorrection correction(machine, errors, words, {}, {});
      const PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
      const test::ControlledMachine control(machine, errors, words);
      for (int n = 0; n < 40; ++n) {
        const ProgramCoordinates coordinates =
            n % 2 == 0 || !bounder.has_tool_centre() ? ProgramCoordinates::axes : ProgramCoordinates::tool_centre;
        const std::optional<test::SampledMove> move =
            test::sample_random_move(machine, correction, bounder, control, coordinates, generator);
        if (!move) continue;
        // Where the ends miss the direction, between them it is missed by no more than the greater of both, besides.
        ASSERT_LE(move->point, move->bound.position + 2e-9) << "move " << n << " of set " << set;
        ASSERT_LE(move->direction, move->bound.orientation + move->ends + 1e-10) << "move " << n << " of set " << set;
        ++sampled;
        if (move->point > 1e-6) (move->is_arc ? arcs : lines).all.push_back(move->bound.position / move->point);
        if (move->direction > 1e-9 && move->ends < 1e-10) {
          directions.all.push_back(move->bound.orientation / move->direction);
        }
      }
    }
  }
  EXPECT_GE(sampled, 3000);
  // Not absurdly loose either. Pieces are the square root of it more than needed.
  RecordProperty("lines", std::to_string(lines.median()));
  RecordProperty("arcs", std::to_string(arcs.median()));
  RecordProperty("directions", std::to_string(directions.median()));
  EXPECT_GE(lines.all.size(), 500U);
  EXPECT_LE(lines.median(), 8);
  EXPECT_GE(arcs.all.size(), 500U);
  EXPECT_LE(arcs.median(), 2);
  EXPECT_LE(directions.median(), 12);
}

TEST(MoveSplitting, PiecesOfSplitMovesStayWithinTheTolerance) {
  std::mt19937_64 generator(23);
  const PathTolerance tolerance{5e-4, 5e-6};
  std::size_t most = 0;
  for (const Machine& machine : {test::trunnion_mill(), test::nutating_head_mill(), test::three_axis_mill()}) {
    SCOPED_TRACE(machine.name);
    const WordAxes words = test::words_of(machine);
    const ErrorSet errors = test::mixed_errors(machine, 3);
    NodeCorrection correction(machine, errors, words, {}, {});
    const PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
    const test::ControlledMachine control(machine, errors, words);
    MoveSplitter splitter(correction, bounder, machine.axes.size(), 20000);
    const bool turns = machine.axes.size() > 3;
    for (int n = 0; n < 12; ++n) {
      const ProgramMove move =
          test::random_move(machine, correction.kinematics(),
                            n % 2 == 0 ? ProgramCoordinates::axes : ProgramCoordinates::tool_centre, generator);
      const std::size_t tool = correction.tool(move.tool_length);
      std::array<CorrectedNode, 2> nodes;
      nodes[0].words = move.start;
      nodes[1].words = move.end;
      correction.correct(move.coordinates, tool, nodes);
      if (!nodes[0].point_reached() || !nodes[1].point_reached()) continue;
      const PathTolerance wanted{tolerance.position, turns ? tolerance.orientation : 1.0};
      ASSERT_TRUE(splitter.split(move, tool, wanted, nodes[0], nodes[1]));
      const std::vector<CorrectedNode>& ends = splitter.nodes();
      ASSERT_EQ(ends.size(), splitter.shares().size());
      most = std::max(most, ends.size() - 1);
      const std::size_t step = std::max<std::size_t>(1, ends.size() / 40);
      for (std::size_t k = 1; k < ends.size(); k += step) {
        double point = 0, direction = 0;
        test::sample_piece(control, move, ends[k - 1], ends[k], splitter.shares()[k - 1], splitter.shares()[k], point,
                           direction);
        EXPECT_LE(point, tolerance.position);
        if (turns) {
          const double left = std::max(ends[k - 1].orientation_left, ends[k].orientation_left);
          EXPECT_LE(direction, tolerance.orientation + left + 1e-10);
        }
      }
    }
  }
  EXPECT_GE(most, 20U);
}

TEST(MoveSplitting, ABoundOfSeveralPiecesIsABoundOfEach) {
  std::mt19937_64 generator(5);
  const Machine machine = test::trunnion_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 9);
  NodeCorrection correction(machine, errors, words, {}, {});
  const PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
  const std::size_t tool = correction.tool({});
  for (const ProgramCoordinates coordinates : {ProgramCoordinates::axes, ProgramCoordinates::tool_centre}) {
    std::array<CorrectedNode, 9> nodes;
    for (CorrectedNode& node : nodes) {
      node.words = test::random_axis_words(machine, words, generator);
      for (std::size_t i = 0; i < 3; ++i) node.words[i] *= 0.1;
    }
    correction.correct(coordinates, tool, nodes);
    std::vector<MovePiece> pieces;
    for (std::size_t k = 1; k < nodes.size(); ++k) pieces.push_back({&nodes[k - 1], &nodes[k], nullptr, 1});
    const Eigen::Vector3d& point = correction.tool_point(tool);
    const PieceBound all = bound_pieces(bounder, machine.axes.size(), coordinates, point, pieces);
    for (const MovePiece& piece : pieces) {
      const PieceBound one = bound_pieces(bounder, machine.axes.size(), coordinates, point, {&piece, 1});
      EXPECT_LE(one.position, all.position);
      EXPECT_LE(one.orientation, all.orientation);
      EXPECT_GT(one.position, 0);
    }
  }
}

TEST(MoveSplitting, TooManyPiecesAreSaidToBe) {
  std::mt19937_64 generator(5);
  const Machine machine = test::three_axis_mill();
  const WordAxes words = test::words_of(machine);
  const ErrorSet errors = test::mixed_errors(machine, 9);
  NodeCorrection correction(machine, errors, words, {}, {});
  const PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
  MoveSplitter splitter(correction, bounder, machine.axes.size(), 10);
  ProgramMove move;
  move.start = test::random_axis_words(machine, words, generator);
  move.end = test::random_axis_words(machine, words, generator);
  std::array<CorrectedNode, 2> nodes;
  nodes[0].words = move.start;
  nodes[1].words = move.end;
  const std::size_t tool = correction.tool({});
  correction.correct(ProgramCoordinates::axes, tool, nodes);
  EXPECT_FALSE(splitter.split(move, tool, {1e-6, 1}, nodes[0], nodes[1]));
}

TEST(MoveSplitting, BoundsHoldWithReversalValuesInAnyDirections) {
  std::mt19937_64 generator(29);
  int sampled = 0, by_play = 0;
  for (const Machine& machine : {test::trunnion_mill(), test::swivel_head_mill(), test::head_table_mill(),
                                 test::nutating_head_mill(), test::gantry_fork_head(), test::three_axis_head()}) {
    SCOPED_TRACE(machine.name);
    const WordAxes words = test::words_of(machine);
    // Without errors reversal is all there is; a bound that forgot it would be zero for lines.
    const ErrorSet errors = generator() % 2 == 0 ? ErrorSet{} : test::mixed_errors(machine, generator());
    NodeCorrection correction(machine, errors, words, {}, {});
    PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
    if (!bounder.has_tool_centre()) continue;
    // Much larger than any, so that they are most of what the bounds are about.
    PlayBounds play;
    play.any = true;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      if (generator() % 4 == 0) continue;
      play.offset[i] = machine.axes[i].kind == AxisKind::rotary ? 2e-3 : 0.4;
      play.lag[i] = 1e-9;
    }
    const test::MachineWithPlay control(machine, {}, words);
    for (int n = 0; n < 40; ++n) {
      const ProgramMove move =
          test::random_move(machine, correction.kinematics(), ProgramCoordinates::tool_centre, generator);
      const std::size_t tool = correction.tool(move.tool_length);
      const MovePath path(move);
      std::array<CorrectedNode, 2> nodes, commanded;
      nodes[0].words = move.start;
      nodes[1].words = move.end;
      correction.correct(move.coordinates, tool, nodes);
      if (!nodes[0].point_reached() || !nodes[1].point_reached()) continue;
      const MovePiece piece{&nodes[0], &nodes[1], path.is_arc() ? &path : nullptr, 1};
      bounder.set_play(play);
      const PieceBound bound =
          bound_pieces(bounder, machine.axes.size(), move.coordinates, correction.tool_point(tool), {&piece, 1});
      bounder.set_play({});
      const PieceBound without =
          bound_pieces(bounder, machine.axes.size(), move.coordinates, correction.tool_point(tool), {&piece, 1});
      std::array<double, kMaxAxes> added{};
      for (std::size_t i = 0; i < machine.axes.size(); ++i) added[i] = play.offset[i] * (generator() % 2 == 0 ? 1 : -1);
      for (std::size_t k = 0; k < 2; ++k) commanded[k] = correction.offset(move.coordinates, tool, nodes[k], added);
      if (!commanded[0].point_reached() || !commanded[1].point_reached()) continue;
      Machine with_tool = machine;
      with_tool.tool_offset -= Eigen::Vector3d(move.tool_length[0], move.tool_length[1], move.tool_length[2]);
      double point = 0, overshoot = 0;
      constexpr int kSamples = 12;
      for (int j = 0; j <= kSamples; ++j) {
        const double t = static_cast<double>(j) / kSamples;
        WordValues wanted;
        path.at(t, wanted);
        std::vector<double> axes =
            control.commands(move, test::between(commanded[0].corrected, commanded[1].corrected, t));
        for (std::size_t i = 0; i < axes.size(); ++i) axes[i] -= added[i];
        const Eigen::Vector3d missed =
            actual_workpiece_from_tool(with_tool, errors, axes).translation - control.nominal(move, wanted).translation;
        point = std::max(point, missed.norm());
        for (std::size_t i = 0; i < axes.size(); ++i) {
          if (!bounder.is_point_axis(i)) continue;
          const double a = nodes[0].corrected_position[i], b = nodes[1].corrected_position[i];
          const double beyond = std::max(0.0, 0.5 * bound.axis_bend - std::abs(b - a));
          overshoot = std::max(axes[i] - std::max(a, b), std::min(a, b) - axes[i]);
          const double allowed = bound.axis_bend > 0 ? beyond * beyond / (2 * bound.axis_bend) : 0;
          ASSERT_LE(overshoot, allowed + 1e-8) << "move " << n;
        }
      }
      ASSERT_LE(point, bound.position + 2e-8) << "move " << n;
      ++sampled;
      if (point > 1.01 * without.position) ++by_play;
    }
  }
  EXPECT_GE(sampled, 100);
  EXPECT_GE(by_play, 20);  // the bound without play would not do
}

}  // namespace
}  // namespace abbe
