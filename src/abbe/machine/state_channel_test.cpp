#include "abbe/machine/state_channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/machine/first_order_lag.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

StateChannel channel_of(std::vector<double> time_s, std::vector<double> value) {
  return {"log.csv", std::move(time_s), std::move(value)};
}

TEST(FirstOrderLag, OneLongStepIsAsGoodAsManyShortOnes) {
  FirstOrderLag once(600, 20, 18), often(600, 20, 18);
  for (int k = 1; k <= 1000; ++k) often.advance(3.6, 20 + 5.0 * k / 1000);
  EXPECT_NEAR(once.advance(3600, 25), often.value(), 1e-11);
  EXPECT_EQ(once.input(), 25);
  EXPECT_EQ(once.after(0, 99), once.value()) << "a jump leaves the value where it is";
  EXPECT_EQ(once.after(-1, 99), once.value());
}

TEST(FirstOrderLag, StaysANumberForStepsOfAnyLength) {
  const FirstOrderLag lag(1e3, 20, 10);
  for (const double step : {5e-324, 1e-300, 1e-12, 1e12, 1e308}) {
    const double value = lag.after(step, 30);
    EXPECT_TRUE(std::isfinite(value)) << step;
    EXPECT_NEAR(value, step < 1 ? 10 : 30, 1e-7) << step;
  }
}

TEST(StateChannel, TakesStraightLinesAndExtrapolatesNothing) {
  const StateChannel channel = channel_of({10, 20, 50}, {1, 3, 0});
  EXPECT_EQ(channel_value(channel, 10).value, 1) << "the first sample";
  EXPECT_EQ(channel_value(channel, 20).value, 3);
  EXPECT_EQ(channel_value(channel, 50).value, 0) << "the last sample";
  EXPECT_DOUBLE_EQ(channel_value(channel, 15).value, 2);
  EXPECT_DOUBLE_EQ(channel_value(channel, 30).value, 2);
  EXPECT_EQ(channel_value(channel, 9.99).status, ChannelStatus::before);
  const ChannelValue late = channel_value(channel, 50.01);
  EXPECT_EQ(late.status, ChannelStatus::after);
  EXPECT_EQ(late.from, 10);
  EXPECT_EQ(late.to, 50);
  EXPECT_EQ(channel_value(channel, kNaN).status, ChannelStatus::no_samples);
  EXPECT_EQ(channel_value(channel, std::numeric_limits<double>::infinity()).status, ChannelStatus::no_samples);
  // 0.2 h less a rounding error is the sample at 720 s.
  const StateChannel hours = channel_of({0.7 * 3600, 0.8 * 3600}, {5, 6});
  EXPECT_EQ(channel_value(hours, std::nextafter(0.7 * 3600, 0)).value, 5);
  EXPECT_EQ(channel_value(hours, std::nextafter(0.8 * 3600, 1e9)).value, 6);
}

TEST(StateChannel, OfOneSampleOrNoneIsKnownThereOrNowhere) {
  const StateChannel none, one = channel_of({7}, {21});
  EXPECT_EQ(channel_value(none, 0).status, ChannelStatus::no_samples);
  EXPECT_EQ(LaggedChannel(none, 100).at(0).status, ChannelStatus::no_samples);
  EXPECT_EQ(channel_value(one, 7).value, 21);
  EXPECT_EQ(channel_value(one, 8).status, ChannelStatus::after);
  EXPECT_EQ(LaggedChannel(one, 100).at(7).value, 21);
  EXPECT_EQ(LaggedChannel(one, 100, 19.5).at(7).value, 19.5);
  EXPECT_EQ(LaggedChannel(one, 100).at(6).status, ChannelStatus::before);
}

/// tau dy/dt + y = u by the classical Runge-Kutta method.
double integrated_lag(const StateChannel& channel, double tau, double start, double until) {
  double value = start, time = channel.time_s.front();
  for (std::size_t k = 1; k < channel.time_s.size() && time < until; ++k) {
    const double end = std::min(until, channel.time_s[k]);
    const int steps = 400;
    const double h = (end - time) / steps;
    const auto slope = [&](double at, double y) { return (channel_value(channel, at).value - y) / tau; };
    for (int s = 0; s < steps; ++s) {
      const double at = time + s * h;
      const double k1 = slope(at, value), k2 = slope(at + h / 2, value + h / 2 * k1);
      const double k3 = slope(at + h / 2, value + h / 2 * k2), k4 = slope(std::min(at + h, end), value + h * k3);
      value += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    time = end;
  }
  return value;
}

TEST(LaggedChannel, IsTheSolutionOfItsDifferentialEquationBetweenTheSamplesToo) {
  const StateChannel channel = channel_of({0, 100, 130, 700, 2000}, {20, 24, 19, 23, 23});
  for (const std::optional<double> start : {std::optional<double>(), std::optional<double>(17)}) {
    const LaggedChannel lag(channel, 240, start);
    for (const double time : {0.0, 50.0, 100.0, 117.0, 130.0, 400.0, 1999.0, 2000.0}) {
      const ChannelValue value = lag.at(time);
      ASSERT_EQ(value.status, ChannelStatus::known) << time;
      EXPECT_NEAR(value.value, integrated_lag(channel, 240, start.value_or(20), time), 1e-9) << time;
    }
    EXPECT_EQ(lag.at(2001).status, ChannelStatus::after);
  }
}

TEST(LaggedChannel, FollowsADailyCycleWithTheKnownAmplitudeAndPhase) {
  // 100,000 samples of a sine over ten days; a lag of 40 min, long after the start.
  const double day = 86400, omega = 2 * std::numbers::pi / day, tau = 2400;
  StateChannel channel;
  const std::size_t count = 100000;
  for (std::size_t k = 0; k < count; ++k) {
    const double time = 10 * day * static_cast<double>(k) / static_cast<double>(count - 1);
    channel.time_s.push_back(time);
    channel.value.push_back(22 + 4 * std::sin(omega * time));
  }
  const LaggedChannel lag(channel, tau);
  const double phase = std::atan(omega * tau), size = 4 * std::cos(phase);
  for (std::size_t k = 0; k < count; ++k) {
    const double time = 2 * day + 7.9 * day * static_cast<double>(k) / static_cast<double>(count);
    const ChannelValue value = lag.at(time);
    ASSERT_EQ(value.status, ChannelStatus::known);
    ASSERT_NEAR(value.value, 22 + size * std::sin(omega * time - phase), 2e-7) << time;
  }
  // At the samples it is what lagged() makes of them.
  const std::vector<double> all = lagged(channel.time_s, channel.value, tau);
  for (std::size_t k = 0; k < count; k += 997) EXPECT_EQ(lag.at(channel.time_s[k]).value, all[k]);
}

TEST(StateChannel, IsNotBridgedWhereValuesAreMissingUnlessTheGapIsAllowed) {
  const std::vector<double> time = {0, 10, 20, 30, 40, 50};
  const std::vector<double> value = {1, 2, kNaN, 4, 5, kNaN};
  const StateChannel strict = make_channel("log.csv", time, value, std::nullopt);
  EXPECT_EQ(strict.time_s, (std::vector<double>{0, 10, 30, 40}));
  EXPECT_EQ(channel_value(strict, 10).value, 2) << "the samples beside the gap are known";
  EXPECT_EQ(channel_value(strict, 30).value, 4);
  const ChannelValue inside = channel_value(strict, 20);
  EXPECT_EQ(inside.status, ChannelStatus::in_gap);
  EXPECT_EQ(inside.from, 10);
  EXPECT_EQ(inside.to, 30);
  EXPECT_EQ(channel_value(strict, 45).status, ChannelStatus::after);
  EXPECT_EQ(channel_value(make_channel("log.csv", time, value, 20), 20).value, 3);
  EXPECT_EQ(channel_value(make_channel("log.csv", time, value, 19), 20).status, ChannelStatus::in_gap);
  EXPECT_TRUE(make_channel("log.csv", time, std::vector<double>(6, kNaN), 20).time_s.empty());
}

TEST(StateChannel, ARecordThatStopsIsAGapToo) {
  std::vector<double> time = {0, 10, 20, 30, 131, 141};
  const std::vector<double> value(6, 20.0);
  EXPECT_EQ(channel_value(make_channel("log.csv", time, value, std::nullopt), 80).status, ChannelStatus::in_gap);
  EXPECT_EQ(channel_value(make_channel("log.csv", time, value, 101), 80).status, ChannelStatus::known);
  time[4] = 130;
  EXPECT_EQ(channel_value(make_channel("log.csv", time, value, std::nullopt), 80).status, ChannelStatus::known);
  // Two samples have no usual distance.
  EXPECT_EQ(channel_value(make_channel("log.csv", {0, 1e6}, {20, 21}, std::nullopt), 5e5).value, 20.5);
}

TEST(LaggedChannel, KnowsNothingInAGapAndShortlyBehindIt) {
  StateChannel channel = channel_of({0, 100, 5000, 6000}, {20, 20, 25, 25});
  channel.gap_after = {0, 1, 0};
  const LaggedChannel lag(channel, 100);
  EXPECT_EQ(lag.at(100).status, ChannelStatus::known);
  EXPECT_EQ(lag.at(101).status, ChannelStatus::in_gap);
  EXPECT_EQ(lag.at(5000).status, ChannelStatus::after_gap);
  const ChannelValue early = lag.at(5299);
  EXPECT_EQ(early.status, ChannelStatus::after_gap);
  EXPECT_EQ(early.from, 100);
  EXPECT_EQ(early.to, 5000);
  EXPECT_EQ(lag.at(5300).status, ChannelStatus::known);
  EXPECT_EQ(lag.at(6000).status, ChannelStatus::known);
}

}  // namespace
}  // namespace abbe
