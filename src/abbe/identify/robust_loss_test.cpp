#include "abbe/identify/robust_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/decay_wave_and_line_for_test.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/identify.h"

namespace abbe {
namespace {

double integral(const std::function<double(double)>& f, double from, double to) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(from + (to - from) * (i + 0.5) / kSteps);
  return sum * (to - from) / kSteps;
}

double norm_density(double d, int rows) {
  return std::pow(2.0, 1 - rows / 2.0) / std::tgamma(rows / 2.0) * std::pow(d, rows - 1) * std::exp(-d * d / 2);
}

TEST(RobustLoss, tuning_constants_give_95_percent_efficiency) {
  for (const LossKind kind : {LossKind::huber, LossKind::cauchy, LossKind::tukey})
    for (int rows = 1; rows <= 6; ++rows) {
      const Loss loss{kind, 0, 1};
      const auto a = [&](double d) {
        const double h = 1e-6, slope = (loss.weight(d + h, rows) - loss.weight(d - h, rows)) / (2 * h);
        return norm_density(d, rows) * (loss.weight(d, rows) + d * slope / rows);
      };
      const auto b = [&](double d) { return norm_density(d, rows) * std::pow(loss.weight(d, rows) * d, 2) / rows; };
      EXPECT_NEAR(std::pow(integral(a, 1e-5, 12), 2) / integral(b, 1e-5, 12), 0.95, 2e-4) << rows;
    }
}

TEST(RobustLoss, weight_is_the_slope_of_the_cost) {
  for (const LossKind kind : {LossKind::none, LossKind::huber, LossKind::cauchy, LossKind::tukey})
    for (const double d : {0.3, 1.5, 4.0, 7.0, 30.0}) {
      const Loss loss{kind, 0, 1.7};
      const double slope = (loss.cost(d + 1e-5, 3) - loss.cost(d - 1e-5, 3)) / 2e-5;
      EXPECT_NEAR(slope, loss.weight(d, 3) * d, 1e-7) << static_cast<int>(kind) << " " << d;
    }
}

TEST(RobustLoss, median_norm_halves_the_chi_square_distribution) {
  for (int rows = 1; rows <= 6; ++rows)
    EXPECT_NEAR(chi_square_exceedance(std::pow(median_norm(rows), 2), rows), 0.5, 1e-6);
}

struct CampaignWithOutliers {
  std::vector<double> data;
  std::vector<std::uint8_t> is_outlier;
};

FunctionObservations::Complex at_60ths(std::size_t k, std::size_t row,
                                       const std::vector<FunctionObservations::Complex>& b) {
  return test::decay_wave_and_line(static_cast<double>(k) / 60, row, b);
}

CampaignWithOutliers campaign_with_outliers(double outlier_share, std::uint64_t seed) {
  RandomStream random(seed);
  CampaignWithOutliers campaign;
  const std::vector<FunctionObservations::Complex> truth(test::kDecayWaveAndLine.begin(),
                                                         test::kDecayWaveAndLine.end());
  for (std::size_t k = 0; k < 400; ++k) {
    const bool outlier = random.uniform() < outlier_share;
    campaign.is_outlier.push_back(outlier);
    for (std::size_t r = 0; r < 3; ++r)
      campaign.data.push_back(at_60ths(k, r, truth).real() + 0.01 * random.normal() +
                              (outlier ? random.uniform(0.5, 10) : 0));  // all to one side
  }
  return campaign;
}

Identification run(const CampaignWithOutliers& campaign, LossKind loss) {
  FunctionObservations observations(7, 3, campaign.data, 0.01, at_60ths);
  observations.start({2, 0.2, 0.5, 1, 1.1, 0, 0});
  Problem problem = function_problem({&observations});
  IdentifyOptions options;
  options.loss = loss;
  return identify(problem, options);
}

double largest_error(const Identification& result) {
  double largest = 0;
  for (std::size_t i = 0; i < test::kDecayWaveAndLine.size(); ++i)
    largest = std::max(largest, std::abs(result.estimates[static_cast<Eigen::Index>(i)] - test::kDecayWaveAndLine[i]));
  return largest;
}

TEST(RobustLoss, thirty_percent_gross_outliers_do_not_move_the_estimate) {
  double clean = 0, dirty = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Identification good = run(campaign_with_outliers(0, seed), LossKind::none);
    const CampaignWithOutliers campaign = campaign_with_outliers(0.3, seed);
    const Identification robust = run(campaign, LossKind::tukey);
    ASSERT_EQ(robust.status, IdentifyStatus::converged);
    clean += largest_error(good);
    dirty += largest_error(robust);
    std::size_t outliers = 0, found = 0;
    for (const std::uint8_t one : campaign.is_outlier) outliers += one;
    for (const Outlier& one : robust.outliers) found += campaign.is_outlier[one.reading] && one.weight == 0;
    EXPECT_EQ(found, outliers);
    EXPECT_LE(robust.outliers.size(), outliers + 2);
    EXPECT_GT(largest_error(run(campaign, LossKind::none)), 0.1);  // least squares does not survive
  }
  EXPECT_LT(dirty, 2 * clean);
}

TEST(RobustLoss, uncertainty_of_a_robust_estimate_on_clean_data_is_that_of_95_percent_efficiency) {
  const CampaignWithOutliers campaign = campaign_with_outliers(0, 3);
  for (const LossKind kind : {LossKind::huber, LossKind::cauchy, LossKind::tukey}) {
    const Identification robust = run(campaign, kind);
    ASSERT_EQ(robust.status, IdentifyStatus::converged);
    EXPECT_NEAR(robust.statistics.robust_factor, 1 / 0.95, 0.08);
  }
}

}  // namespace
}  // namespace abbe
