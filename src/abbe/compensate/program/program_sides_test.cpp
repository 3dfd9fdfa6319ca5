// Programs corrected for errors that depend on the side from which axes come.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/compensate/program/errors_with_states_for_test.h"
#include "abbe/compensate/program/program_correction.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr double kReached = 1e-6;  // mm
constexpr double kShort = 0.2;     // mm; take-ups are shorter, pieces of the moves below are longer

double length(const WordValues& from, const WordValues& to) {
  double square = 0;
  for (std::size_t i = 0; i < kAxisWords; ++i) square += (to[i] - from[i]) * (to[i] - from[i]);
  return std::sqrt(square);
}

/// Where the tool of a machine with errors is at words of axes that came from these sides.
class SidedMachine {
 public:
  SidedMachine(const Machine& machine, const ErrorSet& errors, const WordAxes& words)
      : machine_(machine), errors_(errors), words_(words), sides_(machine.axes.size(), 0) {}

  void come_from(std::size_t axis, double way) {
    if (way != 0) sides_[axis] = way > 0 ? 1 : -1;
  }
  Eigen::Vector3d nominal(const WordValues& words) const {
    return nominal_workpiece_from_tool(machine_, axes(words)).translation;
  }
  Eigen::Vector3d actual(const WordValues& words) const {
    std::vector<double> given;
    for (const MachineState& state : machine_.states)
      given.push_back(state.kind == StateKind::approach ? sides_[state.axis] : NAN);
    return actual_workpiece_from_tool(machine_, errors_, axes(words), given).translation;
  }

 private:
  std::vector<double> axes(const WordValues& words) const {
    return test::commanded_axes(machine_, words_, ProgramCoordinates::axes, words);
  }
  Machine machine_;
  ErrorSet errors_;
  WordAxes words_;
  std::vector<double> sides_;
};

TEST(ProgramSides, EveryMoveEndsWhereItShouldAndStaysNearItsLine) {
  std::mt19937_64 generator(41);
  for (const Machine& plain : {test::trunnion_mill(), test::three_axis_mill(), test::moving_table_cmm()}) {
    SCOPED_TRACE(plain.name);
    Machine machine = test::with_sides(test::with_states(plain, generator));
    const WordAxes words = test::words_of(machine);
    const ErrorSet errors = test::errors_with_states(machine, words, generator);
    ProgramCorrectionOptions options;
    options.tolerance = {5e-3, 5e-5};
    ProgramCorrection correction(machine, errors, words, options);
    ASSERT_EQ(correction.problem(), "");
    EXPECT_EQ(correction.reversals().size(), 3U);
    std::vector<ProgramMove> moves;
    WordValues at = test::random_axis_words(machine, words, generator);
    const WordValues fixed = at;
    for (int n = 0; n < 24; ++n) {
      ProgramMove& move = moves.emplace_back();
      move.kind = MoveKind::straight;
      move.line = moves.size();
      move.feed = 500;
      move.start = at;
      at = test::between(fixed, test::random_axis_words(machine, words, generator), 0.3);
      move.end = at;
    }
    SidedMachine tool(machine, errors, words);
    CorrectedPieces corrected;
    std::size_t take_ups = 0, checked = 0;
    WordValues from = moves[0].start;
    for (std::size_t batch = 0; batch < moves.size(); batch += 8) {
      correction.correct({&moves[batch], 8}, corrected);
      for (std::size_t m = 0; m < 8; ++m) {
        const ProgramMove& move = moves[batch + m];
        for (std::size_t i = 0; i < kAxisWords; ++i) {
          if (words.axis[i] != Machine::npos) tool.come_from(words.axis[i], move.end[i] - move.start[i]);
        }
        for (std::size_t k = corrected.first[m]; k < corrected.first[m + 1]; ++k) {
          const WordValues to = corrected.pieces[k].end;
          if (length(from, to) < kShort) {
            ++take_ups;
          } else if (batch + m > 0) {
            // On the way the commanded place is somewhere on the line; its nearest place is no further.
            for (double s = 0.1; s < 0.95; s += 0.2) {
              const Eigen::Vector3d actual = tool.actual(test::between(from, to, s));
              double nearest = 1;
              double low = 0, high = 1;
              const auto missed = [&](double share) {
                return (actual - tool.nominal(test::between(move.start, move.end, share))).norm();
              };
              for (int step = 0; step < 80; ++step) {
                const double a = low + (high - low) / 3, b = high - (high - low) / 3;
                (missed(a) < missed(b) ? high : low) = missed(a) < missed(b) ? b : a;
              }
              nearest = missed(0.5 * (low + high));
              EXPECT_LE(nearest, options.tolerance.position + kReached) << "move " << batch + m;
              ++checked;
            }
          }
          from = to;
        }
        EXPECT_LE((tool.actual(from) - tool.nominal(move.end)).norm(), kReached) << "move " << batch + m;
      }
    }
    EXPECT_GE(take_ups, 10U);
    EXPECT_GE(checked, 100U);
    EXPECT_EQ(correction.report().not_proven.count, 0U);
  }
}

TEST(ProgramSides, AxesOfACircleAreCorrectedForTheSideTheyComeFrom) {
  Machine machine = test::three_axis_mill();
  machine.states = {{.name = "from_x", .kind = StateKind::approach, .axis = machine.find_axis("X")},
                    {.name = "from_y", .kind = StateKind::approach, .axis = machine.find_axis("Y")}};
  const WordAxes words = test::words_of(machine);
  ErrorSet errors;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t axis = machine.states[k].axis;
    const Axis& moving = machine.axes[axis];
    Basis line;
    line.kind = BasisKind::legendre;
    line.order = 1;
    line.from = moving.travel_min;
    line.to = moving.travel_max;
    for (const Component component : {Component::X, Component::Y, Component::Z}) {
      errors.motions.push_back({.axis = axis,
                                .component = component,
                                .basis = line,
                                .coefficients = {0.002 + 0.001 * static_cast<double>(k), 0.003},
                                .standard_uncertainty = {},
                                .state = k});
    }
  }
  ProgramCorrection correction(machine, errors, words);
  ASSERT_EQ(correction.problem(), "");
  constexpr double kRadius = 40;
  WordValues centre{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = machine.axes[words.axis[i]];
    centre[i] = 0.5 * (axis.travel_min + axis.travel_max);
  }
  ProgramMove move;
  move.kind = MoveKind::arc_counterclockwise;
  move.line = 1;
  move.feed = 500;
  move.start = centre;
  move.start[0] += kRadius;
  move.end = move.start;
  move.arc_centre = {centre[0], centre[1], centre[2]};
  CorrectedPieces corrected;
  correction.correct({&move, 1}, corrected);
  EXPECT_EQ(correction.report().not_proven.count, 0U);
  const SidedMachine plain(machine, errors, words);
  const Eigen::Vector3d middle = plain.nominal(centre);
  std::size_t sure = 0;
  WordValues from = corrected.pieces.front().end;
  for (const CorrectedPiece& piece : corrected.pieces) {
    const double moved = length(from, piece.end);
    from = piece.end;
    if (moved < 0.05) continue;  // a take-up
    const double angle = std::atan2(piece.end[1] - centre[1], piece.end[0] - centre[0]);
    SidedMachine tool = plain;
    tool.come_from(words.axis[0], -std::sin(angle));
    tool.come_from(words.axis[1], std::cos(angle));
    // Where an axis has just turned round, or is about to, the rounding of the angle decides.
    if (std::min(std::abs(std::sin(angle)), std::abs(std::cos(angle))) < 0.05) continue;
    const Eigen::Vector3d missed = tool.actual(piece.end) - middle;
    EXPECT_NEAR(std::hypot(missed[0], missed[1]), kRadius, kReached) << angle;
    EXPECT_NEAR(missed[2], 0, kReached) << angle;
    ++sure;
  }
  EXPECT_GE(sure, 60U);
  EXPECT_GE(correction.report().take_ups[words.axis[0]].count, 2U);
  EXPECT_GE(correction.report().take_ups[words.axis[1]].count, 2U);
}

}  // namespace
}  // namespace abbe
