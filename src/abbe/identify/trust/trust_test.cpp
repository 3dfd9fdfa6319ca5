#include "abbe/identify/trust/trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "abbe/errors/random_stream.h"
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

/// Kind of what is found, or nothing.
std::optional<DistrustKind> kind_of(const HeldOutErrors& errors) {
  const auto found = distrust_of_held_out(errors);
  return found ? std::optional(found->kind) : std::nullopt;
}

TEST(Trust, ATrueErrorThatTheCorrectionMakesLargerIsDistrusted) {
  HeldOutErrors errors{.before = std::vector<double>(100, 0.1),
                       .after = std::vector<double>(100, 0.02),
                       .predicted_square = 100 * 0.005 * 0.005,
                       .readings = false,
                       .numbers = 300};
  EXPECT_FALSE(distrust_of_held_out(errors));
  errors.after.assign(100, 0.11);
  const auto found = distrust_of_held_out(errors);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, DistrustKind::worse_held_out);
  EXPECT_THAT(found->text, HasSubstr("the root mean square error is 110 um after the correction and 100 um before"));
  // Chance may explain it if the identified errors are said to be known no better.
  errors.predicted_square = 100 * 0.05 * 0.05;
  EXPECT_EQ(kind_of(errors), DistrustKind::no_improvement);
  EXPECT_THAT(distrust_of_held_out(errors)->text, HasSubstr("shows no improvement"));
  // Four points to which a station was fitted before: half of the error went into the station.
  HeldOutErrors few{.before = std::vector<double>(4, 0.1),
                    .after = std::vector<double>(4, 0.13),
                    .readings = false,
                    .numbers = 12,
                    .fitted_before = 6};
  EXPECT_EQ(kind_of(few), DistrustKind::no_improvement);
  few.after.assign(4, 0.15);
  EXPECT_EQ(kind_of(few), DistrustKind::worse_held_out);
  few.numbers = 6;
  EXPECT_EQ(kind_of(few), DistrustKind::no_improvement);
  few.after.assign(4, 0.1);
  EXPECT_EQ(kind_of(few), std::nullopt) << "as large as before";
}

/// A linear machine: parameters from readings with noise, then residuals of other readings of it.
class HeldOutCampaigns {
 public:
  static constexpr Eigen::Index kParameters = 12, kUsed = 150, kHeldOut = 50, kFitted = 6;

  /// @param errors   true parameters in units of what noise makes of them
  /// @param changed  the machine that is held out has its errors so many times
  HeldOutErrors errors(std::uint64_t seed, double size, double changed, bool readings, bool station) const {
    RandomStream random(seed, 3);
    const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
      Eigen::MatrixXd result(rows, columns);
      for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] = random.normal();
      return result;
    };
    const Eigen::MatrixXd used = matrix(3 * kUsed, kParameters), other = matrix(3 * kHeldOut, kParameters);
    const Eigen::VectorXd truth = size * matrix(kParameters, 1);
    const Eigen::MatrixXd normal = used.transpose() * used;
    const Eigen::VectorXd found = normal.ldlt().solve(used.transpose() * (used * truth + matrix(3 * kUsed, 1)));
    Eigen::VectorXd before = changed * other * truth;
    if (readings) before += matrix(3 * kHeldOut, 1);
    const Eigen::VectorXd after = before - other * found;
    if (station) {
      const Eigen::MatrixXd moved = matrix(3 * kHeldOut, kFitted);
      before -= moved * (moved.transpose() * moved).ldlt().solve(moved.transpose() * before);
    }
    HeldOutErrors result;
    result.readings = readings;
    result.numbers = 3.0 * kHeldOut;
    result.fitted_before = station ? static_cast<double>(kFitted) : 0.0;
    for (Eigen::Index k = 0; k < kHeldOut; ++k) {
      result.before.push_back(before.segment<3>(3 * k).norm());
      result.after.push_back(after.segment<3>(3 * k).norm());
    }
    result.predicted_square = (other * normal.ldlt().solve(other.transpose())).trace();
    return result;
  }

  /// How many of 200 campaigns are worse, not by chance and in all.
  std::pair<int, int> distrusted(double size, double changed, bool readings, bool station) const {
    std::pair<int, int> counts{0, 0};
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const HeldOutErrors campaign = errors(seed, size, changed, readings, station);
      const auto kind = kind_of(campaign);
      counts.first += kind == DistrustKind::worse_held_out ? 1 : 0;
      counts.second += kind ? 1 : 0;
    }
    return counts;
  }
};

TEST(Trust, OfAnExactMachineItIsSaidThatNothingImproves) {
  const HeldOutCampaigns campaigns;
  for (const bool station : {false, true}) {
    const auto [no_chance, all] = campaigns.distrusted(0, 1, true, station);
    EXPECT_EQ(no_chance, 0);
    EXPECT_GT(all, 150) << "most are worse";
  }
  EXPECT_EQ(campaigns.distrusted(0, 1, false, false), std::pair(0, 200));
  // Errors as large as what noise makes of them: a correction may help or not.
  EXPECT_EQ(campaigns.distrusted(0.05, 1, true, true).first, 0);
}

TEST(Trust, HeldOutErrorsAreStatedAsTheRootMeanSquareThatIsJudged) {
  // Smaller on average, but not in the sum of squares: one pose has become far worse.
  HeldOutErrors errors{.before = std::vector<double>(100, 0.01),
                       .after = std::vector<double>(100, 0.005),
                       .readings = false,
                       .numbers = 300};
  errors.after[7] = 0.3;
  const auto found = distrust_of_held_out(errors);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->numbers[0].first, "rms_before_um");
  EXPECT_NEAR(found->numbers[0].second, 10, 1e-9);
  EXPECT_EQ(found->numbers[1].first, "rms_after_um");
  EXPECT_NEAR(found->numbers[1].second, 1e3 * std::sqrt((99 * 0.005 * 0.005 + 0.3 * 0.3) / 100), 1e-9);
  errors.predicted_square = 0.1;
  EXPECT_EQ(kind_of(errors), DistrustKind::no_improvement);
  EXPECT_THAT(distrust_of_held_out(errors)->text, HasSubstr("the root mean square error is 30.41 um after"));
}

TEST(Trust, RoundingIsNoError) {
  HeldOutErrors errors{
      .before = std::vector<double>(50, 1e-11), .after = std::vector<double>(50, 1e-7), .numbers = 150};
  for (const bool readings : {false, true}) {
    errors.readings = readings;
    EXPECT_FALSE(distrust_of_held_out(errors));
  }
  errors.after.assign(50, 2e-6);
  EXPECT_TRUE(distrust_of_held_out(errors));
}

TEST(Trust, AStationFittedToFewReadingsHidesMoreThanOneFittedToMany) {
  // Per point what the station took up, and nothing else: the limits are f F(f, n - f), 1855 for 4 points and 46.3 for
  // 50, times the variance.
  for (const std::pair<double, double>& known : {std::pair(4.0, 1855.0), std::pair(50.0, 46.3)}) {
    const double points = known.first, limit = known.second;
    const auto count = static_cast<std::size_t>(points);
    const double numbers = 3 * points, variance = 1e-4;
    HeldOutErrors errors{.before = std::vector<double>(count, std::sqrt(variance * (numbers - 6) / points)),
                         .after = {},
                         .numbers = numbers,
                         .fitted_before = 6};
    const auto with_excess = [&](double excess) {
      errors.after.assign(count, std::sqrt((variance * (numbers - 6 + excess)) / points));
      return kind_of(errors) == DistrustKind::worse_held_out;
    };
    EXPECT_FALSE(with_excess(0.999 * limit)) << points;
    EXPECT_TRUE(with_excess(1.001 * limit)) << points;
  }
}

TEST(Trust, AMachineThatIsNotTheOneMeasuredIsDistrusted) {
  const HeldOutCampaigns campaigns;
  for (const bool station : {false, true}) {
    // Sign of an axis the other way, errors as large as the noise each; a machine that has none any more.
    EXPECT_GE(campaigns.distrusted(1, -1, true, station).first, 190);
    EXPECT_GE(campaigns.distrusted(4, 0, true, station).first, 190);
  }
  EXPECT_EQ(campaigns.distrusted(0.5, -1, false, false).first, 200);
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
