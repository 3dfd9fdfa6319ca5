#include "abbe/history/machine_trends.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/message_of.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/comparison/campaigns_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

constexpr double kYear = 365.2425;

/// Campaigns every quarter of a year of a mill whose EXX grows by `per_year` mm over its range (a Legendre term of
/// first order) and jumps by `jump` mm in the last one.
std::vector<KeptCampaign> quarterly(std::size_t count, double per_year, double jump, std::uint64_t seed) {
  const IdentifiedCampaign truth = mill_campaign("mill");
  const std::size_t scale = first_parameter(truth.errors.errors, truth.machine.find_axis("X"), Component::X) + 1;
  std::vector<KeptCampaign> campaigns;
  for (std::size_t k = 0; k < count; ++k) {
    KeptCampaign one;
    one.number = static_cast<std::int64_t>(k) + 1;
    one.measured = date_of("2024-01-01") + std::chrono::days(91 * k);
    one.campaign = drawn(truth, seed, k);
    one.campaign.name = "c" + std::to_string(k);
    std::vector<double> parameters = one.campaign.errors.errors.parameters();
    parameters[scale] += per_year * 91 * static_cast<double>(k) / kYear + (k + 1 == count ? jump : 0);
    one.campaign.errors.errors.set_parameters(parameters);
    campaigns.push_back(std::move(one));
  }
  return campaigns;
}

const ErrorTrend& trend_named(const MachineTrends& trends, const std::string& name) {
  const auto found =
      std::find_if(trends.errors.begin(), trends.errors.end(), [&](const ErrorTrend& one) { return one.name == name; });
  EXPECT_NE(found, trends.errors.end()) << name;
  return *found;
}

TEST(MachineTrends, FindTheDriftThatWasPutIn) {
  TrendRequest request;
  request.campaigns = quarterly(9, 20e-3, 0, 4);
  request.limit_mm = 30e-3;
  const MachineTrends trends = find_trends(request);
  const ErrorTrend& drifting = trend_named(trends, "EXX");
  EXPECT_TRUE(drifting.drifts);
  // Largest at an end of the range, where the term is 1 or -1.
  EXPECT_NEAR(std::abs(drifting.per_year), 20e-3, drifting.expanded_per_year);
  EXPECT_LT(drifting.expanded_per_year, 5e-3);
  ASSERT_EQ(drifting.values.size(), 9U);
  EXPECT_EQ(drifting.values[0].value, 0);
  EXPECT_EQ(drifting.values[4].time, 364);
  ASSERT_TRUE(trends.next);
  EXPECT_EQ(trends.next_error, "EXX");
  const double days = static_cast<double>((*trends.next - trends.dates.back()).count());
  EXPECT_GT(days, 200);  // 30 um at 20 um a year less what is uncertain
  EXPECT_LT(days, 1.5 * kYear);
  const std::string text = evaluation_text(trends.report);
  EXPECT_THAT(text, HasSubstr("Measure again by " + date_text(*trends.next)));
}

TEST(MachineTrends, ErrorsThatStandStillDriftAtTheStatedRateOnly) {
  std::size_t followed = 0, drifting = 0, unexpected = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    TrendRequest request;
    request.campaigns = quarterly(6, 0, 0, 100 + seed);
    for (const ErrorTrend& one : find_trends(request).errors) {
      if (one.not_followed) continue;
      ++followed;
      drifting += one.drifts ? 1U : 0U;
      unexpected += one.expected->is_within ? 0U : 1U;
    }
  }
  ASSERT_GT(followed, 300U);
  // At the place of the largest change of the last campaign, which is more than 4.6 % at a fixed place.
  EXPECT_LT(static_cast<double>(drifting) / static_cast<double>(followed), 0.1);
  EXPECT_LT(static_cast<double>(unexpected) / static_cast<double>(followed), 0.1);
}

TEST(MachineTrends, AJumpIsNoDriftAndIsSaid) {
  TrendRequest request;
  request.campaigns = quarterly(7, 0, 60e-3, 9);
  const MachineTrends trends = find_trends(request);
  EXPECT_FALSE(trends.is_in_control());
  const ErrorTrend& jumped = trend_named(trends, "EXX");
  EXPECT_FALSE(jumped.expected->is_within);
  EXPECT_GT(*jumped.trend.scatter, 5e-3);
  EXPECT_THAT(
      evaluation_text(trends.report),
      HasSubstr(
          "EXX has changed by -59.8 \xC2\xB5m up to the last campaign; the earlier campaigns predict 1.3 \xC2\xB1 2.2 "
          "\xC2\xB5m."));
}

TEST(MachineTrends, ControlLimitsOfEachCampaignComeFromThoseBeforeIt) {
  TrendRequest request;
  request.campaigns = quarterly(7, 0, 60e-3, 9);
  const MachineTrends trends = find_trends(request);
  const ErrorTrend& error = trend_named(trends, "EXX");
  ASSERT_EQ(error.predicted.size(), 6U);
  // Of the second campaign: the first one, with the uncertainties of both.
  EXPECT_EQ(error.predicted[0].value, 0);
  EXPECT_NEAR(error.predicted[0].expanded, 2 * std::hypot(error.values[0].uncertainty, error.values[1].uncertainty),
              1e-12);
  EXPECT_EQ(error.predicted.back().expanded, error.expected->expanded);
  // The campaigns after the third do not reach back: the same limits as of a history that ends with it.
  request.campaigns.erase(request.campaigns.begin() + 3, request.campaigns.end());
  const MachineTrends first_three = find_trends(request);
  const ErrorTrend& earlier = trend_named(first_three, "EXX");
  ASSERT_EQ(earlier.at, error.at);
  EXPECT_NEAR(earlier.expected->value, error.predicted[1].value, 1e-9);
  EXPECT_NEAR(earlier.expected->expanded, error.predicted[1].expanded, 1e-9);

  const EvaluationTable& table = trends.report.tables.front();
  ASSERT_EQ(table.sparklines.size(), table.rows.size());
  const auto row = std::find_if(table.rows.begin(), table.rows.end(),
                                [](const std::vector<std::string>& cells) { return cells[0] == "EXX"; });
  const Sparkline& course = table.sparklines[static_cast<std::size_t>(row - table.rows.begin())];
  EXPECT_EQ(course.days[6], 546);
  EXPECT_NEAR(course.value[6], 1e3 * error.values[6].value, 1e-9);
  EXPECT_NEAR(course.expanded[6], 2e3 * error.values[6].uncertainty, 1e-9);
  EXPECT_FALSE(course.low[0]);
  EXPECT_NEAR(*course.high[6] - *course.low[6], 2e3 * error.expected->expanded, 1e-9);
  EXPECT_GT(*course.low[6], course.value[6]);
}

TEST(MachineTrends, TwoCampaignsSayThatTheScatterIsNotKnown) {
  TrendRequest request;
  request.campaigns = quarterly(2, 20e-3, 0, 2);
  const MachineTrends trends = find_trends(request);
  EXPECT_FALSE(trend_named(trends, "EXX").trend.scatter);
  EXPECT_THAT(trends.report.notes, testing::Contains(HasSubstr("the scatter from campaign to campaign is not known")));
}

TEST(MachineTrends, OnlyTheNewestAreFollowedWhereThatIsAsked) {
  TrendRequest request;
  request.campaigns = quarterly(9, 0, 0, 4);
  request.last = 3;
  EXPECT_EQ(find_trends(request).names, (std::vector<std::string>{"c6", "c7", "c8"}));
  request.last = 1;
  EXPECT_THAT(message_of([&] { find_trends(request); }), HasSubstr("--last: 1 campaigns; expected 2 to 26"));
}

TEST(MachineTrends, RefuseOneCampaignAndOneDay) {
  TrendRequest request;
  request.campaigns = quarterly(1, 0, 0, 4);
  EXPECT_THAT(message_of([&] { find_trends(request); }), HasSubstr("campaigns of two days or more"));
  request.campaigns = quarterly(2, 0, 0, 4);
  request.campaigns[1].measured = request.campaigns[0].measured;
  EXPECT_THAT(message_of([&] { find_trends(request); }), HasSubstr("campaigns of two days or more"));
  request.campaigns.clear();
  EXPECT_THAT(message_of([&] { find_trends(request); }), HasSubstr("campaigns of two days or more"));
}

TEST(MachineTrends, WithoutUncertaintiesNothingIsFollowed) {
  TrendRequest request;
  request.campaigns = quarterly(3, 20e-3, 0, 4);
  for (KeptCampaign& one : request.campaigns) {
    one.campaign.errors.covariance.resize(0, 0);
    for (ErrorMotion& motion : one.campaign.errors.errors.motions) motion.standard_uncertainty.clear();
    for (LocationError& location : one.campaign.errors.errors.locations) location.standard_uncertainty = 0;
  }
  const MachineTrends trends = find_trends(request);
  for (const ErrorTrend& one : trends.errors) EXPECT_TRUE(one.not_followed) << one.name;
}

}  // namespace
}  // namespace abbe
