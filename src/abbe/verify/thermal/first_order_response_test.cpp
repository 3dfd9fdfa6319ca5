#include "abbe/verify/thermal/first_order_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace abbe {
namespace {

/// start + change (1 - exp(-t / constant)) at n times from 0 to `duration`, with noise.
TimeSeries response(double change, double constant, double duration, std::size_t n, double noise = 0,
                    unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  TimeSeries series{"Z", {}, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const double t = duration * static_cast<double>(i) / static_cast<double>(n - 1);
    series.time.push_back(100 + t);
    series.values.push_back(2 + change * (1 - std::exp(-t / constant)) + noise * normal(random));
  }
  return series;
}

FirstOrderResponse fitted(const TimeSeries& series, double u = 0) {
  return first_order_response(series, series.from(), series.to(), u);
}

TEST(FirstOrderResponse, FindsWhatWasPutIn) {
  for (const double change : {30.0, -0.004}) {
    const FirstOrderResponse found = fitted(response(change, 45, 240, 49));
    ASSERT_EQ(found.status, ResponseStatus::done);
    EXPECT_NEAR(found.time_constant, 45, 1e-4);
    EXPECT_NEAR(found.change / change, 1, 1e-6);
    EXPECT_NEAR(found.start, 2, 1e-6 * std::abs(change));
    EXPECT_NEAR(found.at(145), 2 + change * (1 - std::exp(-1.0)), 1e-6 * std::abs(change));
    EXPECT_LT(found.uncertainty, 0.01);
  }
}

/// The numbers were computed by normal equations and ternary search in double precision, apart from this library.
TEST(FirstOrderResponse, IsTheLeastSquaresFitOfAnIndependentComputation) {
  const TimeSeries series{
      "Z", {0, 5, 10, 20, 30, 40, 60, 80, 100, 120}, {0.02, 1.31, 2.29, 3.98, 5.06, 5.88, 6.91, 7.38, 7.71, 7.79}};
  const FirstOrderResponse found = fitted(series);
  ASSERT_EQ(found.status, ResponseStatus::done);
  EXPECT_NEAR(found.time_constant, 29.463858818, 1e-6);
  EXPECT_NEAR(found.start, 0.043328596, 1e-7);
  EXPECT_NEAR(found.change, 7.889639243, 1e-7);
  EXPECT_NEAR(found.residual_rms, 0.035106728, 1e-8);
  EXPECT_NEAR(found.uncertainty, 0.357154115, 1e-6);
  EXPECT_EQ(found.correlation_length, 1);
  // A stated uncertainty that is larger than the scatter takes its place.
  EXPECT_NEAR(fitted(series, 0.0702).uncertainty / found.uncertainty, 2, 0.1);
}

TEST(FirstOrderResponse, TheExpandedUncertaintyCoversTheTruth) {
  int covered = 0, done = 0;
  constexpr int kTrials = 400;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const FirstOrderResponse found = fitted(response(10, 60, 240, 49, 0.3, seed));
    if (found.status != ResponseStatus::done) continue;
    ++done;
    if (std::abs(found.time_constant - 60) <= 2 * found.uncertainty) ++covered;
  }
  EXPECT_EQ(done, kTrials);
  EXPECT_GE(covered, 0.93 * kTrials);
  EXPECT_LT(covered, kTrials) << "else it would be far too large";
}

TEST(FirstOrderResponse, ReadingsThatEndTooEarlyDoNotBoundTheTimeConstant) {
  EXPECT_EQ(fitted(response(10, 600, 60, 61, 0.02)).status, ResponseStatus::not_identified);
  TimeSeries line = response(10, 60, 240, 49);
  for (std::size_t i = 0; i < line.time.size(); ++i) line.values[i] = 0.1 * line.time[i];
  EXPECT_EQ(fitted(line).status, ResponseStatus::not_identified);
}

TEST(FirstOrderResponse, ReadingsThatAreTooFarApartDoNotBoundItEither) {
  EXPECT_EQ(fitted(response(10, 0.3, 240, 49, 0.02)).status, ResponseStatus::not_identified);
}

TEST(FirstOrderResponse, NoChangeHasNoTimeConstant) {
  TimeSeries still = response(0, 60, 240, 49);
  EXPECT_EQ(fitted(still).status, ResponseStatus::no_change);
  int found = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    if (fitted(response(0, 60, 240, 49, 0.1, seed)).status == ResponseStatus::done) ++found;
  }
  EXPECT_LE(found, 2) << "noise alone";
  EXPECT_EQ(fitted(response(0.1, 60, 240, 49), 0.2).status, ResponseStatus::no_change)
      << "less than the stated uncertainty";
}

TEST(FirstOrderResponse, AnotherShapeIsRefused) {
  TimeSeries wave = response(10, 60, 240, 97);
  for (std::size_t i = 0; i < wave.time.size(); ++i) {
    wave.values[i] += 3 * std::sin(2 * std::numbers::pi * wave.time[i] / 80);
  }
  EXPECT_EQ(fitted(wave).status, ResponseStatus::not_first_order);
  // Warming and cooling together.
  TimeSeries both = response(10, 30, 240, 97);
  for (std::size_t i = 48; i < both.time.size(); ++i) {
    both.values[i] = 2 + 10 * std::exp(-(both.time[i] - both.time[48]) / 50);
  }
  EXPECT_NE(fitted(both).status, ResponseStatus::done);
}

TEST(FirstOrderResponse, NeedsSixReadingsWithinItsTimes) {
  EXPECT_EQ(fitted(response(10, 60, 240, 5)).status, ResponseStatus::too_few_readings);
  EXPECT_EQ(fitted(response(10, 60, 240, 2)).status, ResponseStatus::too_few_readings);
  const TimeSeries series = response(10, 60, 240, 49);
  EXPECT_EQ(first_order_response(series, 100, 120).status, ResponseStatus::too_few_readings);
  EXPECT_EQ(first_order_response(series, 400, 500).status, ResponseStatus::too_few_readings);
}

TEST(FirstOrderResponse, ManyReadingsGiveTheSame) {
  const FirstOrderResponse found = fitted(response(10, 45, 240, 400'000, 0.1));
  ASSERT_EQ(found.status, ResponseStatus::done);
  EXPECT_NEAR(found.time_constant, 45, 3 * found.uncertainty);
  EXPECT_LT(found.uncertainty, 0.02);
}

}  // namespace
}  // namespace abbe
