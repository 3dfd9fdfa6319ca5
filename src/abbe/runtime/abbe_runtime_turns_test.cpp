// Axes that turn on and on, and long ones: no digit of a correction may depend on how far they have gone.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/runtime/frozen_for_test.h"

namespace abbe {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kMostTurns = 100000;
/// Of a call, unless poses near singularities take more in turn 0 as well.
constexpr int kMostEvaluations = 8;

/// An angle less its whole turns, by the 64 bits of the compiler's long double.
double in_turn_zero(double angle) {
  const long double turn = 2 * std::numbers::pi_v<long double>;
  return static_cast<double>(std::remainder(static_cast<long double>(angle), turn));
}

Machine with_endless_axes(Machine machine) {
  for (Axis& axis : machine.axes) axis.endless = axis.endless || axis.kind == AxisKind::rotary;
  return machine;
}

/// Every turn at first, then one in 101.
int next_turn(int turn) { return turn < 300 ? turn + 1 : std::min(turn + 101, std::max(turn + 1, kMostTurns)); }

struct Called {
  int result = 0;
  abbe_runtime_state state{};
  std::vector<double> values;
};

Called correct(const abbe_runtime* runtime, const abbe_runtime_state& start, const std::vector<double>& nominal) {
  Called called{0, start, nominal};
  called.result = abbe_runtime_correct(runtime, &called.state, nominal.data(), nullptr, 1, called.values.data());
  return called;
}

Called uncorrect(const abbe_runtime* runtime, const abbe_runtime_state& start, const std::vector<double>& joints) {
  Called called{0, start, joints};
  called.result = abbe_runtime_uncorrect(runtime, &called.state, joints.data(), nullptr, 1, called.values.data());
  return called;
}

TEST(RuntimeTurns, AHundredThousandTurnsOfEveryRotaryAxisConvergeAsTurnZeroDoes) {
  for (const test::NamedMachine& named : test::all_machines()) {
    const Machine machine = with_endless_axes(named.machine);
    const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 3));
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> somewhere(-std::numbers::pi, std::numbers::pi);
    int worst = 0, calls = 0, worst_in_turn_zero = 0;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      if (machine.axes[axis].kind != AxisKind::rotary) continue;
      SCOPED_TRACE(named.name + " " + machine.axes[axis].name);
      std::vector<double> pose = test::inner_commands(machine, generator);
      abbe_runtime_state warm;
      abbe_runtime_start(&warm);
      for (int turn = 0; turn <= kMostTurns; turn = next_turn(turn)) {
        for (const double sign : {1.0, -1.0}) {
          pose[axis] = somewhere(generator) + sign * kTurn * turn;
          std::vector<double> zero = pose;
          zero[axis] = in_turn_zero(pose[axis]);
          const Called expected = correct(runtime.get(), {}, zero);
          const Called back_expected = uncorrect(runtime.get(), {}, zero);
          worst_in_turn_zero =
              std::max({worst_in_turn_zero, expected.state.iterations, back_expected.state.iterations});
          // Warm: from the last pose, and from the solution of this one, where there is only rounding left to see.
          for (const abbe_runtime_state& start : {abbe_runtime_state{}, warm, expected.state}) {
            const Called there = correct(runtime.get(), start, pose), back = uncorrect(runtime.get(), start, pose);
            ASSERT_EQ(there.result, expected.result) << turn;
            ASSERT_EQ(back.result, back_expected.result) << turn;
            worst = std::max({worst, there.state.iterations, back.state.iterations});
            calls += 2;
            // Near singularities a turn is known as well as the pose divided by the small singular value.
            if (expected.result != ABBE_OK) continue;
            for (std::size_t i = 0; i < pose.size(); ++i) {
              const double spare = 1e-11 + 1e-8 * std::abs(expected.state.correction[i]);
              ASSERT_NEAR(there.state.correction[i], expected.state.correction[i], spare) << turn << " " << i;
              ASSERT_NEAR(back.state.correction[i], back_expected.state.correction[i], spare) << turn << " " << i;
              // What is given out is rounded once, as a sum.
              ASSERT_EQ(there.values[i], pose[i] + there.state.correction[i]) << turn << " " << i;
            }
            warm = there.state;
          }
        }
      }
    }
    if (calls == 0) continue;
    RecordProperty(named.name, worst);
    EXPECT_LE(worst, std::max(kMostEvaluations, worst_in_turn_zero)) << named.name;
  }
}

/// Errors that do not repeat themselves with the turns: known over some turns, or with another period.
TEST(RuntimeTurns, ErrorsThatDoNotRepeatWithTheTurnsAreTakenWhereTheyAre) {
  const Machine machine = with_endless_axes(test::trunnion_mill());
  const std::size_t c = machine.find_axis("C");
  const auto of = [&](const Basis& basis, std::vector<double> coefficients) {
    ErrorSet errors;
    errors.motions.push_back({c, Component::X, basis, std::move(coefficients), {}});
    return test::runtime_of(machine, errors);
  };
  // The table moves aside, and the linear axes move after it: as far as the error is large, mm.
  const auto error = [&](const test::RuntimePointer& runtime, double command, int flags) {
    std::vector<double> pose(machine.axes.size(), 10.0);
    pose[machine.find_axis("A")] = -0.7;
    pose[machine.find_axis("Z")] = -100;
    pose[c] = command;
    const Called called = uncorrect(runtime.get(), {}, pose);
    EXPECT_GE(called.result, 0) << command;
    EXPECT_EQ(called.result & (ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL), flags) << command;
    double square = 0;
    for (const char* axis : {"X", "Y", "Z"}) square += std::pow(called.state.correction[machine.find_axis(axis)], 2);
    return std::sqrt(square);
  };
  constexpr double kTo = 1e-9;
  // A gear that meets again after three turns.
  const Basis gear{.kind = BasisKind::fourier, .order = 1, .from = 0, .to = 3 * kTurn, .period = 3 * kTurn};
  const test::RuntimePointer repeats = of(gear, {0, 0.01, 0});
  for (const double turns : {0.0, 3.0, 99999.0})
    EXPECT_NEAR(error(repeats, 1 + kTurn * turns, 0), 0.01 * std::cos(1.0 / 3), kTo) << turns;
  EXPECT_NEAR(error(repeats, 1 + kTurn, 0), 0.01 * std::abs(std::cos((1 + kTurn) / 3)), kTo);
  // Measured over ten turns: beyond them nothing is known, and it is said. The polynomial goes from -1 to 1.
  const Basis ten{.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 10 * kTurn};
  const test::RuntimePointer once = of(ten, {0, 0.01});
  EXPECT_NEAR(error(once, 9.5 * kTurn, 0), 0.009, kTo);
  const double held = error(once, 10.5 * kTurn, ABBE_OUTSIDE_MAP);
  // 1 mm or 0.5 % of the range beyond the end (docs/runtime.md).
  EXPECT_NEAR(held, 0.01, 0.01 * 0.011);
  EXPECT_NEAR(error(once, 1000 * kTurn, ABBE_OUTSIDE_MAP), held, kTo);
}

/// From the last place before a turn ends to the first after it, in steps as small as commands have.
TEST(RuntimeTurns, NothingJumpsWhereATurnEnds) {
  const Machine machine = with_endless_axes(test::trunnion_mill());
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 3));
  const std::size_t c = machine.find_axis("C");
  std::vector<double> pose(machine.axes.size(), 10.0);
  pose[machine.find_axis("A")] = -0.7;
  pose[machine.find_axis("Z")] = -100;
  for (const double turns : {0.0, 1.0, 1000.0, -100000.0}) {
    for (const double part : {0.0, 0.5}) {
      double at = kTurn * (turns + part);
      const double step = std::max(1e-12, std::abs(at) * 2e-16);
      std::vector<double> before;
      for (int k = -50; k <= 50; ++k) {
        pose[c] = at + k * step;
        const Called called = correct(runtime.get(), {}, pose);
        ASSERT_EQ(called.result, ABBE_OK);
        const std::vector<double> now(called.state.correction, called.state.correction + pose.size());
        // Errors change by less than a part of them per radian; rounding comes to it.
        for (std::size_t i = 0; i < before.size(); ++i)
          ASSERT_NEAR(now[i], before[i], 2e-12 + step) << turns << " " << k;
        before = now;
      }
    }
  }
}

/// Commands as far out as the interface takes them.
TEST(RuntimeTurns, TheClaimedBoundsHold) {
  for (const test::NamedMachine& named : test::all_machines()) {
    SCOPED_TRACE(named.name);
    Machine machine = with_endless_axes(named.machine);
    const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 3));
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> far(-999999.9, 999999.9);
    int worst = 0;
    for (int k = 0; k < 2000; ++k) {
      std::vector<double> pose = test::inner_commands(machine, generator);
      for (std::size_t i = 0; i < pose.size(); ++i) {
        if (k % 3 == 0 || (machine.axes[i].kind == AxisKind::rotary) == (k % 3 == 1)) pose[i] = far(generator);
      }
      const Called there = correct(runtime.get(), {}, pose);
      ASSERT_GE(there.result, 0) << abbe_runtime_text(there.result) << " " << k;
      const Called again = correct(runtime.get(), there.state, pose);
      ASSERT_EQ(again.result, there.result);
      const Called back = uncorrect(runtime.get(), {}, there.values);
      ASSERT_GE(back.result, 0) << abbe_runtime_text(back.result) << " " << k;
      worst = std::max({worst, there.state.iterations, again.state.iterations, back.state.iterations});
    }
    EXPECT_LE(worst, 20);
  }
}

}  // namespace
}  // namespace abbe
