#include "abbe/verify/evaluations/conformity.h"

#include <gtest/gtest.h>

#include <random>

namespace abbe {
namespace {

TEST(Conformity, IsProvenUpToTheGuardBandBelowTheLimit) {
  // u = 1, g = 1.65: binary fractions, so that the boundary is exact.
  EXPECT_EQ(conformity(8.25, 1, 8.25 + kGuardFactor), Conformity::proven) << "equal is proven";
  EXPECT_EQ(conformity(8.26, 1, 8.25 + kGuardFactor), Conformity::not_proven);
  EXPECT_EQ(conformity(10, 1, 10), Conformity::not_proven);
}

TEST(Conformity, NonconformityIsProvenOnlyBeyondTheGuardBandAboveTheLimit) {
  EXPECT_EQ(conformity(10 + kGuardFactor, 1, 10), Conformity::not_proven) << "equal is not proven";
  EXPECT_EQ(conformity(11.66, 1, 10), Conformity::nonconformity_proven);
}

TEST(Conformity, TheSignOfTheValueDoesNotMatter) {
  for (const double value : {0.0, 3.0, 8.34, 8.36, 11.64, 11.66}) {
    EXPECT_EQ(conformity(value, 1, 10), conformity(-value, 1, 10)) << value;
  }
}

TEST(Conformity, WithoutUncertaintyTheValuesThemselvesDecide) {
  EXPECT_EQ(conformity(10, 0, 10), Conformity::proven);
  EXPECT_EQ(conformity(10.001, 0, 10), Conformity::nonconformity_proven);
}

TEST(Conformity, BothLimitsCountWhereTheToleranceIsSmallAgainstTheUncertainty) {
  // Between +-1.7 u lie 91 % of a normal distribution, between +-1.96 u lie 95 %.
  EXPECT_NEAR(conformance_probability(0, 1, 1.7), 0.9109, 1e-4);
  EXPECT_EQ(conformity(0, 1, 1.7), Conformity::not_proven);
  EXPECT_EQ(conformity(0, 1, 1.97), Conformity::proven);
}

TEST(Conformity, ProbabilityIsThatOfJcgm106) {
  // JCGM 106:2012, 7.3, table 1: z = (limit - value) / u and the probability below the limit.
  EXPECT_NEAR(conformance_probability(10 - 1.64, 1, 10), 0.95, 6e-4);
  EXPECT_NEAR(conformance_probability(10 - 2.33, 1, 10), 0.99, 6e-4);
  EXPECT_NEAR(conformance_probability(10, 1, 10), 0.5, 1e-12);
}

TEST(Conformity, FalseStatementsStayBelowFivePercent) {
  std::mt19937_64 generator(14253);
  std::normal_distribution<double> noise(0, 1);
  constexpr int kTrials = 20000;
  int false_acceptances = 0, false_rejections = 0;
  for (int i = 0; i < kTrials; ++i) {
    // True values just beyond and just at the limit: the worst cases.
    false_acceptances += conformity(10.0001 + noise(generator), 1, 10) == Conformity::proven ? 1 : 0;
    false_rejections += conformity(10 + noise(generator), 1, 10) == Conformity::nonconformity_proven ? 1 : 0;
  }
  // 4.95 % are expected; four standard deviations of the count are 0.61 %.
  EXPECT_NEAR(false_acceptances / double{kTrials}, 0.0495, 0.0061);
  EXPECT_NEAR(false_rejections / double{kTrials}, 0.0495, 0.0061);
}

}  // namespace
}  // namespace abbe
