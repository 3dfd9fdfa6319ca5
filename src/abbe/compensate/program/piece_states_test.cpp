// Bounds between corrected poses where errors depend on states that follow from the commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/compensate/program/errors_with_states_for_test.h"
#include "abbe/compensate/program/factor_bounds.h"
#include "abbe/compensate/program/random_moves_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TEST(PieceStates, NoSampleOfAnyPieceExceedsItsBound) {
  std::mt19937_64 generator(17);
  int sampled = 0;
  std::vector<double> ratios;
  for (const Machine& plain :
       {test::trunnion_mill(), test::swivel_head_mill(), test::head_table_mill(), test::nutating_head_mill(),
        test::gantry_fork_head(), test::three_axis_mill(), test::moving_table_cmm(), test::three_axis_head()}) {
    SCOPED_TRACE(plain.name);
    for (int set = 0; set < 8; ++set) {
      const Machine machine = test::with_states(plain, generator);
      const WordAxes words = test::words_of(machine);
      const ErrorSet errors = test::errors_with_states(machine, words, generator);
      NodeCorrection correction(machine, errors, words, {}, {});
      const PieceBounder bounder(machine, errors, {words.axis[0], words.axis[1], words.axis[2]});
      const test::ControlledMachine control(machine, errors, words);
      for (int n = 0; n < 40; ++n) {
        const ProgramCoordinates coordinates =
            n % 2 == 0 || !bounder.has_tool_centre() ? ProgramCoordinates::axes : ProgramCoordinates::tool_centre;
        const std::optional<test::SampledMove> move =
            test::sample_random_move(machine, correction, bounder, control, coordinates, generator);
        if (!move) continue;
        ASSERT_LE(move->point, move->bound.position + 2e-9) << "move " << n << " of set " << set;
        ASSERT_LE(move->direction, move->bound.orientation + move->ends + 1e-10) << "move " << n << " of set " << set;
        ++sampled;
        if (move->point > 1e-6 && !move->is_arc) ratios.push_back(move->bound.position / move->point);
      }
    }
  }
  EXPECT_GE(sampled, 1500);
  ASSERT_GE(ratios.size(), 300U);
  std::sort(ratios.begin(), ratios.end());
  RecordProperty("lines", std::to_string(ratios[ratios.size() / 2]));
  EXPECT_LE(ratios[ratios.size() / 2], 30);
}

TEST(PieceStates, BoundsOfFactorsHoldAlongStraightMotions) {
  std::mt19937_64 generator(3);
  for (const Machine& plain : {test::trunnion_mill(), test::swivel_head_mill(), test::head_table_mill()}) {
    SCOPED_TRACE(plain.name);
    const Machine machine = test::with_states(plain, generator);
    const WordAxes words = test::words_of(machine);
    const std::size_t n = machine.axes.size();
    ErrorSet errors;
    for (std::size_t j = 0; j < machine.states.size(); ++j) {
      Basis constant;
      constant.kind = BasisKind::legendre;
      constant.order = 0;
      errors.motions.push_back(
          {.axis = 0, .basis = constant, .coefficients = {1e-6}, .standard_uncertainty = {}, .state = j});
    }
    const FactorBounds bounds(machine, errors);
    for (int move = 0; move < 50; ++move) {
      const auto place = [&] {
        return test::commanded_axes(machine, words, ProgramCoordinates::axes,
                                    test::random_axis_words(machine, words, generator));
      };
      const std::vector<double> a = place(), b = place();
      CommandsAlong commands;
      for (std::size_t i = 0; i < n; ++i) {
        commands.lowest[i] = std::min(a[i], b[i]);
        commands.highest[i] = std::max(a[i], b[i]);
        commands.speed[i] = std::abs(b[i] - a[i]);
        commands.lag[i] = 1e-3;
      }
      std::array<BoundAlong, kMaxStates> factors;
      bounds.along(commands, factors);
      for (std::size_t j = 0; j < machine.states.size(); ++j) {
        constexpr double kStep = 1e-3;
        std::vector<double> by_positions;
        const auto factor = [&](double s) {
          std::vector<double> at(n);
          for (std::size_t i = 0; i < n; ++i) at[i] = a[i] + s * (b[i] - a[i]);
          return state_factor(machine, j, at, {}, &by_positions);
        };
        for (double s = 0.1; s < 1; s += 0.2) {
          const double before = factor(s - kStep), after = factor(s + kStep), here = factor(s);
          double lag = 0;
          for (const double slope : by_positions) lag += 1e-3 * std::abs(slope);
          const double rounding = 1e-12 * factors[j].value / (kStep * kStep);
          EXPECT_LE(std::abs(here), factors[j].value * (1 + 1e-12)) << machine.states[j].name;
          EXPECT_LE(std::abs(after - before) / (2 * kStep), factors[j].rate + rounding) << machine.states[j].name;
          EXPECT_LE(std::abs(after - 2 * here + before) / (kStep * kStep), factors[j].second + rounding)
              << machine.states[j].name;
          EXPECT_LE(lag, factors[j].lag * (1 + 1e-12)) << machine.states[j].name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace abbe
