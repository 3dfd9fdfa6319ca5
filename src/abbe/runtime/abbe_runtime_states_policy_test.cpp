#include <array>
#include <cmath>
#include <limits>

#include "abbe/errors/actual_pose.h"
#include "abbe/runtime/frozen_states_for_test.h"

namespace abbe {
namespace {

constexpr double kDead = std::numeric_limits<double>::quiet_NaN();
constexpr double kCycle = 0.001;  // s

/// A mill with an ambient channel and its lag, and a policy.
class WarmMill {
 public:
  WarmMill() : WarmMill({.hold_s = 2, .ramp_per_s = 0.02, .rate_mm_per_s = 0.01, .longest_pause_s = 0.005}) {}
  explicit WarmMill(const abbe_runtime_policy& policy)
      : runtime_(test::loaded(test::frozen_warm_mill().bytes)), states_(test::states_of(runtime_.get(), &policy)) {}

  void advance(double ambient, double seconds = kCycle) {
    ASSERT_EQ(abbe_runtime_states_advance(states_.get(), &ambient, seconds), ABBE_OK);
    abbe_runtime_states_get(states_.get(), &used, &lag, &flags, &behind);
  }
  /// For so long, cycle by cycle.
  void advance_for(double ambient, double seconds, double cycle = kCycle) {
    for (int k = 0; k < std::lround(seconds / cycle); ++k) advance(ambient, cycle);
  }
  std::vector<double> joints(const std::vector<double>& nominal) const {
    std::vector<double> joints(nominal);
    EXPECT_GE(
        abbe_runtime_correct(abbe_runtime_at_states(states_.get()), nullptr, nominal.data(), nullptr, 1, joints.data()),
        0);
    return joints;
  }
  abbe_runtime_states* states() const { return states_.get(); }
  const abbe_runtime* runtime() const { return runtime_.get(); }

  double used = 0, lag = 0, behind = 0;
  int flags = 0;

 private:
  test::RuntimePointer runtime_;
  test::StatesPointer states_;
};

/// Corners of the travel and its middle.
std::vector<std::vector<double>> some_places(const Machine& machine) {
  std::vector<std::vector<double>> places;
  for (int corner = 0; corner < 8; ++corner) {
    std::vector<double> place;
    for (std::size_t i = 0; i < 3; ++i) {
      const Axis& axis = machine.axes[i];
      const double end = (corner >> i & 1) != 0 ? axis.travel_max : axis.travel_min;
      place.push_back(0.5 * (axis.travel_min + axis.travel_max) +
                      0.49 * (end - 0.5 * (axis.travel_min + axis.travel_max)) * 2);
    }
    places.push_back(place);
  }
  return places;
}

TEST(RuntimeStatesPolicy, LagsAreExactForAnySteps) {
  WarmMill mill;
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> times{0}, values{22};
  mill.advance(values[0], 0);
  EXPECT_EQ(mill.lag, 22) << "in equilibrium with the first value";
  for (int k = 0; k < 2000; ++k) {
    const double step = k % 7 == 0 ? 400 * uniform(generator) : k % 5 == 0 ? 0 : 0.002 * uniform(generator);
    times.push_back(times.back() + step);
    values.push_back(16 + 13 * uniform(generator));
    mill.advance(values.back(), step);
    ASSERT_EQ(mill.used, values.back());
  }
  EXPECT_NEAR(mill.lag, lagged(times, values, 900).back(), 1e-9);
  EXPECT_GT(std::abs(mill.lag - values.back()), 0.1);
}

TEST(RuntimeStatesPolicy, ADayOfServoCyclesLosesNothing) {
  WarmMill mill;
  mill.advance(20, 0);
  const int cycles = 4000000;  // more than an hour
  for (int k = 1; k <= cycles; ++k) {
    const double value = 20 + 8.0 * k / cycles;
    abbe_runtime_states_advance(mill.states(), &value, kCycle);
  }
  double lag = 0;
  abbe_runtime_states_get(mill.states(), nullptr, &lag, nullptr, nullptr);
  const double seconds = cycles * kCycle, slope = 8 / seconds;
  EXPECT_NEAR(lag, 28 - slope * 900 * (1 - std::exp(-seconds / 900)), 1e-8);
}

TEST(RuntimeStatesPolicy, ADeadSensorIsHeldThenLeftThenTakenUpAgain) {
  WarmMill mill;
  EXPECT_EQ(mill.flags, 0);
  mill.advance(kDead);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_AT_REFERENCE) << "no value has come yet";
  EXPECT_TRUE(std::isnan(mill.used));
  EXPECT_TRUE(std::isnan(mill.lag));
  mill.advance(26);
  EXPECT_EQ(mill.flags, 0);
  mill.advance_for(kDead, 1.9);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_HELD);
  EXPECT_EQ(mill.used, 26);
  mill.advance(27);
  EXPECT_EQ(mill.flags, 0);
  EXPECT_EQ(mill.used, 27);
  // 0.02 of 15 K per second: 7 K take 23.3 s.
  mill.advance_for(kDead, 2.5);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_RAMPING);
  double before = mill.used;
  int cycles = 0;
  for (; (mill.flags & ABBE_CHANNEL_AT_REFERENCE) == 0 && cycles < 100000; ++cycles) {
    mill.advance(kDead);
    ASSERT_LE(std::abs(mill.used - before), 0.3 * kCycle * (1 + 1e-9));
    before = mill.used;
  }
  EXPECT_NEAR(cycles * kCycle, 7 / 0.3 - 0.5, 0.1);
  EXPECT_EQ(mill.used, 20);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_AT_REFERENCE);
  mill.advance_for(kDead, 10);
  EXPECT_EQ(mill.used, 20);
  // Back to good: not at once either.
  mill.advance(25);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_RAMPING);
  EXPECT_NEAR(mill.used, 20 + 0.3 * kCycle, 1e-12);
  mill.advance_for(25, 17);
  EXPECT_EQ(mill.flags, 0);
  EXPECT_EQ(mill.used, 25);
  mill.advance(24);
  EXPECT_EQ(mill.used, 24) << "follows again at once";
  for (const double wrong : {std::numeric_limits<double>::infinity(), -1e300, 1.1e6}) {
    mill.advance(wrong);
    EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_HELD);
    EXPECT_EQ(mill.used, 24);
  }
}

TEST(RuntimeStatesPolicy, OutOfRangeTheLimitIsHeldThenLeft) {
  WarmMill mill;
  mill.advance(29);
  mill.advance(34);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_OUT_OF_RANGE | ABBE_CHANNEL_HELD);
  EXPECT_EQ(mill.used, 30);
  mill.advance(12);
  EXPECT_EQ(mill.used, 15);
  mill.advance(kDead);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_HELD);
  EXPECT_EQ(mill.used, 15) << "the last limit";
  mill.advance(30);
  EXPECT_EQ(mill.flags, 0) << "the limit belongs to the range";
  mill.advance_for(40, 2.5);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_OUT_OF_RANGE | ABBE_CHANNEL_RAMPING);
  mill.advance_for(40, 40);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_OUT_OF_RANGE | ABBE_CHANNEL_AT_REFERENCE);
  EXPECT_EQ(mill.used, 20);
  // Turned round on the way back.
  mill.advance_for(28, 5);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_RAMPING);
  mill.advance_for(kDead, 2.5);
  EXPECT_EQ(mill.flags & ABBE_CHANNEL_RAMPING, ABBE_CHANNEL_RAMPING);
  mill.advance_for(kDead, 60);
  EXPECT_EQ(mill.flags, ABBE_CHANNEL_DEAD | ABBE_CHANNEL_AT_REFERENCE);
}

TEST(RuntimeStatesPolicy, AtTheReferenceOnlyWhatDependsOnNoStateIsCompensated) {
  const Machine machine = test::warm_mill();
  const ErrorSet errors = test::warm_errors(machine);
  ErrorSet geometric = errors;
  std::erase_if(geometric.motions, [](const ErrorMotion& motion) { return motion.state != kNoState; });
  WarmMill mill;
  mill.advance_for(29, 30, 0.005);
  mill.advance_for(kDead, 60000, 5);  // the lag has gone too
  for (int k = 0; k < 100000; ++k) mill.advance(kDead, 0.005);
  for (const std::vector<double>& nominal : some_places(machine)) {
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
    const RigidTransform there = actual_workpiece_from_tool(machine, geometric, mill.joints(nominal));
    EXPECT_LE((there.translation - wanted.translation).norm(), 1e-9);
  }
}

/// Largest change of the corrected tool point from one call to the next, mm.
class LargestStep {
 public:
  explicit LargestStep(const Machine& machine) : machine_(machine), places_(some_places(machine)) {}
  void take(const WarmMill& mill) {
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const std::vector<double> joints = mill.joints(places_[p]);
      const Eigen::Vector3d point = nominal_workpiece_from_tool(machine_, joints).translation;
      if (last_.size() == places_.size()) {
        step = std::max(step, (point - last_[p]).norm());
        for (std::size_t i = 0; i < 3; ++i) joint = std::max(joint, std::abs(joints[i] - joints_[p][i]));
        way = std::max(way, (point - first_[p]).norm());
      } else {
        last_.push_back(point);
        first_.push_back(point);
        joints_.push_back(joints);
        continue;
      }
      last_[p] = point;
      joints_[p] = joints;
    }
  }
  double step = 0, joint = 0, way = 0;

 private:
  const Machine& machine_;
  std::vector<std::vector<double>> places_, joints_;
  std::vector<Eigen::Vector3d> last_, first_;
};

TEST(RuntimeStatesPolicy, NoSensorMakesTheCorrectionJump) {
  const Machine machine = test::warm_mill();
  WarmMill mill;
  LargestStep largest(machine);
  mill.advance(20);
  largest.take(mill);
  std::mt19937_64 generator(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  double value = 20;
  for (int k = 0; k < 60000; ++k) {
    // Jumps within the range and out of it, losses of every length, noise.
    if (uniform(generator) < 0.001) value = 10 + 25 * uniform(generator);
    if (uniform(generator) < 0.0005) value = kDead;
    mill.advance(value, k % 100 == 0 ? 0.02 : kCycle);  // now and then the thread pauses
    if (k % 3 == 0) continue;
    mill.advance(value, 0);
    largest.take(mill);
  }
  // At most two advances between what is compared, of which one may have been a pause.
  EXPECT_LE(largest.step, 0.01 * (0.005 + 0.001) * (1 + 1e-6));
  EXPECT_LE(largest.joint, 0.01 * (0.005 + 0.001) * (1 + 1e-6));
  EXPECT_GT(largest.step, 0.005 * 0.001);
  EXPECT_GT(largest.way, 0.01) << "what does not move cannot jump";
}

TEST(RuntimeStatesPolicy, TheCorrectionArrivesWhereTheStatesAre) {
  const Machine machine = test::warm_mill();
  const ErrorSet errors = test::warm_errors(machine);
  WarmMill mill;
  mill.advance(20);
  mill.advance(28);
  EXPECT_GT(mill.behind, 0.01);
  const double at_first = mill.behind;
  int cycles = 0;
  while (mill.behind > 0 && cycles < 100000) {
    mill.advance(28);
    ++cycles;
  }
  EXPECT_GE(cycles * kCycle, 0.9 * at_first / 0.01);
  EXPECT_LE(cycles * kCycle, 1.2 * at_first / 0.01 + 1);
  const std::vector<double> given{28, mill.lag};
  for (const std::vector<double>& nominal : some_places(machine)) {
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
    const RigidTransform there = actual_workpiece_from_tool(machine, errors, mill.joints(nominal), given);
    EXPECT_LE((there.translation - wanted.translation).norm(), 2e-12);
  }
}

TEST(RuntimeStatesPolicy, TheStatedLargestPerUnitHolds) {
  // The bound of the rate rests on it: mm per K over the whole travel, with every tool that was tried.
  const Machine machine = test::warm_mill();
  const FrozenCompensation frozen = test::frozen_warm_mill();
  WarmMill mill({.hold_s = 2, .ramp_per_s = 1, .rate_mm_per_s = 0.01, .longest_pause_s = 1e-9});
  const std::array<double, 1> cold{20}, lags{20};
  abbe_runtime_states_set(mill.states(), cold.data(), lags.data());
  double largest = 0;
  const std::array<double, 3> tool{0, 0, -300};
  for (const std::vector<double>& nominal : some_places(machine)) {
    std::vector<double> a(nominal), b(nominal);
    abbe_runtime_states_set(mill.states(), cold.data(), lags.data());
    abbe_runtime_correct(abbe_runtime_at_states(mill.states()), nullptr, nominal.data(), tool.data(), 1, a.data());
    const std::array<double, 1> warm{30};
    abbe_runtime_states_set(mill.states(), warm.data(), warm.data());
    abbe_runtime_correct(abbe_runtime_at_states(mill.states()), nullptr, nominal.data(), tool.data(), 1, b.data());
    largest = std::max(largest, std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
  }
  ASSERT_EQ(frozen.channels.size(), 1U);
  EXPECT_LE(largest, 1.01 * frozen.channels[0].largest);
  EXPECT_GT(largest, 0.5 * frozen.channels[0].largest);
}

TEST(RuntimeStatesPolicy, WhatCannotBeIsRefusedAndChangesNothing) {
  WarmMill mill;
  mill.advance(25);
  const double value = 26;
  for (const double seconds : {-1e-9, kDead, 2e9}) {
    EXPECT_EQ(abbe_runtime_states_advance(mill.states(), &value, seconds), ABBE_NOT_FINITE);
  }
  abbe_runtime_states_get(mill.states(), &mill.used, nullptr, nullptr, nullptr);
  EXPECT_EQ(mill.used, 25);
  EXPECT_EQ(abbe_runtime_states_set(mill.states(), &kDead, nullptr), ABBE_NOT_FINITE);
  EXPECT_EQ(abbe_runtime_states_set(mill.states(), &value, &kDead), ABBE_NOT_FINITE);
  EXPECT_EQ(abbe_runtime_states_restore(mill.states(), &value, &kDead, 1), ABBE_NOT_FINITE);
  EXPECT_EQ(abbe_runtime_states_restore(mill.states(), &value, &value, -1), ABBE_NOT_FINITE);
  abbe_runtime_policy policy;
  abbe_runtime_default_policy(&policy);
  for (double abbe_runtime_policy::*field :
       {&abbe_runtime_policy::hold_s, &abbe_runtime_policy::ramp_per_s, &abbe_runtime_policy::rate_mm_per_s,
        &abbe_runtime_policy::longest_pause_s}) {
    abbe_runtime_policy wrong = policy;
    wrong.*field = -1;
    EXPECT_EQ(abbe_runtime_states_set_policy(mill.states(), &wrong), ABBE_NOT_FINITE);
    wrong.*field = kDead;
    abbe_runtime_states* made = nullptr;
    EXPECT_EQ(abbe_runtime_states_make(mill.runtime(), &wrong, &made), ABBE_NOT_FINITE);
    EXPECT_EQ(made, nullptr);
  }
  EXPECT_EQ(abbe_runtime_states_make(nullptr, nullptr, nullptr), ABBE_NULL);
  EXPECT_EQ(abbe_runtime_at_states(nullptr), nullptr);
  EXPECT_EQ(abbe_runtime_states_advance(nullptr, &value, 1), ABBE_NULL);
}

}  // namespace
}  // namespace abbe
