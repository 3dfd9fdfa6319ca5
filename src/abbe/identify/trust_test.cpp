#include "abbe/identify/trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/distributions.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

FitStatistics fit_with(double chi_square, double degrees_of_freedom) {
  FitStatistics fit;
  fit.chi_square = chi_square;
  fit.degrees_of_freedom = degrees_of_freedom;
  fit.p_value = chi_square_exceedance(chi_square, degrees_of_freedom);
  fit.variance_factor = chi_square / degrees_of_freedom;
  return fit;
}

TEST(Trust, AChiSquareBeyondItsQuantileIsDistrusted) {
  for (const double degrees : {3.0, 100.0, 20000.0}) {
    const double limit = chi_square_quantile(kNoChance, degrees);
    EXPECT_FALSE(distrust_of_fit(fit_with(0.999 * limit, degrees)));
    const auto found = distrust_of_fit(fit_with(1.001 * limit, degrees));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->kind, DistrustKind::misfit);
    EXPECT_EQ(found->numbers[0].second, 1.001 * limit);
  }
  EXPECT_FALSE(distrust_of_fit(FitStatistics{})) << "nothing to judge without degrees of freedom";
}

TEST(Trust, OverstatedNoiseIsTold) {
  EXPECT_THAT(warning_of_overstated_noise(fit_with(250, 1000)), HasSubstr("only 0.5 times"));
  EXPECT_EQ(warning_of_overstated_noise(fit_with(950, 1000)), "");
  // Beyond chance, but the outliers that a robust loss leaves out of chi-square do this much.
  EXPECT_EQ(warning_of_overstated_noise(fit_with(980000, 1000000)), "");
  EXPECT_EQ(warning_of_overstated_noise(FitStatistics{}), "");
}

TEST(Trust, ALargerErrorAtHeldOutPosesIsDistrusted) {
  EXPECT_FALSE(distrust_of_held_out({.mean_before = 0.1, .mean_after = 0.02, .count = 300}));
  const auto found = distrust_of_held_out({.mean_before = 0.1, .mean_after = 0.11, .count = 300});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, DistrustKind::worse_held_out);
  EXPECT_THAT(found->text, HasSubstr("110 um after the correction and 100 um before"));
  // Four points to which a station was fitted before: half of the error went into the station.
  EXPECT_FALSE(distrust_of_held_out({.mean_before = 0.1, .mean_after = 0.13, .count = 12, .fitted_before = 6}));
  EXPECT_TRUE(distrust_of_held_out({.mean_before = 0.1, .mean_after = 0.15, .count = 12, .fitted_before = 6}));
  EXPECT_FALSE(distrust_of_held_out({.mean_before = 0, .mean_after = 0.1, .count = 6, .fitted_before = 6}));
}

TEST(Trust, ImplausibleSizesAreDistrusted) {
  const Machine machine = test::aguado_table();
  const std::size_t c = machine.find_axis("C"), x = machine.find_axis("X");
  ErrorSet errors;
  // What a bad machine has: 2 mm off, 1 degree tilted, 0.3 % of scale.
  ErrorMotion scale{x, Component::X, Basis{.kind = BasisKind::legendre, .order = 1}, {0, 2}, {}};
  scale.basis.from = 0;
  scale.basis.to = 1400;
  errors.motions.push_back(scale);
  errors.locations = {{c, Component::X, 2, 0}, {c, Component::A, 1 * kDegree, 0}};
  errors.reversals = {{x, -0.3, 0}};
  errors.tool_offset_error = {0, 0, 2};
  EXPECT_TRUE(distrust_of_sizes(machine, errors).empty());

  errors.motions[0].coefficients = {0, 16};
  errors.locations[0].value = -700;
  errors.locations[1].value = 3 * kDegree;
  errors.reversals[0].value = -1.5;
  errors.tool_offset_error = {0, 0, 70};
  const std::vector<Distrust> found = distrust_of_sizes(machine, errors);
  ASSERT_EQ(found.size(), 5U);
  EXPECT_THAT(found[0].text, HasSubstr("EXX varies about its mean by 16 mm, beyond the 14 mm"));
  EXPECT_THAT(found[1].text, HasSubstr("EX0C is -700 mm"));
  EXPECT_THAT(found[2].text, HasSubstr("EA0C is 3 deg, beyond the 2 deg"));
  EXPECT_THAT(found[3].text, HasSubstr("reversal_X is -1.5 mm"));
  EXPECT_THAT(found[4].text, HasSubstr("the tool offset error is 70 mm"));
  for (const Distrust& reason : found) EXPECT_EQ(reason.kind, DistrustKind::implausible_size);
}

TEST(Trust, TheMeanOfAMotionIsJudgedAsALocation) {
  const Machine machine = test::aguado_table();
  const std::size_t x = machine.find_axis("X"), c = machine.find_axis("C");
  ErrorSet errors;
  ErrorMotion motion{x, Component::Z, Basis{.kind = BasisKind::legendre, .order = 0}, {12}, {}};
  motion.basis.to = 1400;
  errors.motions.push_back(motion);
  EXPECT_TRUE(distrust_of_sizes(machine, errors).empty());
  errors.motions[0].coefficients = {20};
  ASSERT_EQ(distrust_of_sizes(machine, errors).size(), 1U);
  EXPECT_THAT(distrust_of_sizes(machine, errors)[0].text, HasSubstr("EZX is on average 20 mm"));
  // Round a turn: a whole period is looked at, wherever it begins.
  ErrorMotion wobble{c, Component::A, Basis{.kind = BasisKind::fourier, .order = 1}, {0, 0, 0.05}, {}};
  wobble.basis.period = kTurn;
  errors.motions = {wobble};
  ASSERT_EQ(distrust_of_sizes(machine, errors).size(), 1U);
  EXPECT_THAT(distrust_of_sizes(machine, errors)[0].text, HasSubstr("EAC varies about its mean by 2.86"));
}

}  // namespace
}  // namespace abbe
