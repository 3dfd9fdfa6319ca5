#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/history/machine_trends.h"
#include "abbe/history/sqlite_database.h"
#include "abbe/report/pages/evaluation_files.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/comparison/campaigns_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

constexpr double kDaysOfAYear = 365.2425;
constexpr double kNoise = 1e-3;                                                          // mm
constexpr double kScale = 4e-3, kDriftPerYear = 6e-3, kScalePerK = 1.5e-3;               // mm at the ends of the travel
constexpr double kMeanTemperature[] = {20, 17, 19, 24, 26, 22, 18, 16, 20, 25, 27, 29};  // degC, of each campaign

/// Coefficients of s and (T - reference) s, their covariance, and the range of the temperatures.
struct LineFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;
  double coolest = 0, warmest = 0;
};

/// Readings of EXX of the machine that drifts and grows warm, 60 of a campaign within 2 K of a mean temperature, and
/// their least squares: without the temperature for one column.
LineFit measured_campaign(std::size_t campaign, Eigen::Index columns, double reference) {
  RandomStream random(77, campaign);
  const double years = 91 * static_cast<double>(campaign) / kDaysOfAYear;
  Eigen::MatrixXd design(60, columns);
  Eigen::VectorXd readings(60);
  LineFit fit{.coefficients = {}, .covariance = {}, .coolest = 1e3, .warmest = -1e3};
  for (Eigen::Index i = 0; i < 60; ++i) {
    const double s = -1 + 2.0 * static_cast<double>(i % 20) / 19;
    const double temperature = kMeanTemperature[campaign] + 2 * std::sin(0.3 * static_cast<double>(i));
    design(i, 0) = s;
    if (columns > 1) design(i, 1) = s * (temperature - reference);
    readings[i] = s * (kScale + kDriftPerYear * years + kScalePerK * (temperature - 20)) + kNoise * random.normal();
    fit.coolest = std::min(fit.coolest, temperature);
    fit.warmest = std::max(fit.warmest, temperature);
  }
  const Eigen::MatrixXd inverse = (design.transpose() * design).inverse();
  fit.coefficients = inverse * design.transpose() * readings;
  fit.covariance = kNoise * kNoise * inverse;
  return fit;
}

/// The campaign of these readings: the mill, whose EXX is the line and, with states, its growth per K.
KeptCampaign campaign_of_readings(std::size_t campaign, bool with_states) {
  KeptCampaign kept;
  kept.number = static_cast<std::int64_t>(campaign) + 1;
  kept.measured = date_of("2023-01-01") + std::chrono::days(91 * campaign);
  kept.campaign = mill_campaign("c" + std::to_string(campaign));
  Machine& machine = kept.campaign.machine;
  machine.states = {{.name = "ambient", .unit = "degC", .reference = 20}};
  ErrorsFile& file = kept.campaign.errors;
  file.errors = {};
  const std::size_t x = machine.find_axis("X");
  const Axis& axis = machine.axes[x];
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = axis.travel_min, .to = axis.travel_max};
  const LineFit fit = measured_campaign(campaign, with_states ? 2 : 1, 20);
  file.errors.motions.push_back({x, Component::X, line, {0, fit.coefficients[0]}, {}});
  if (with_states) file.errors.motions.push_back({x, Component::X, line, {0, fit.coefficients[1]}, {}, 0});
  const auto count = static_cast<Eigen::Index>(file.errors.parameter_count());
  file.covariance.setZero(count, count);
  for (Eigen::Index a = 0; a < fit.coefficients.size(); ++a) {
    for (Eigen::Index b = 0; b < fit.coefficients.size(); ++b)
      file.covariance(2 * a + 1, 2 * b + 1) = fit.covariance(a, b);
  }
  if (with_states) file.covered = {{"ambient_degC", fit.coolest, fit.warmest}};
  return kept;
}

TrendRequest twelve_campaigns(bool with_states) {
  TrendRequest request;
  for (std::size_t k = 0; k < std::size(kMeanTemperature); ++k) {
    request.campaigns.push_back(campaign_of_readings(k, with_states));
  }
  return request;
}

const ErrorTrend& trend_of_state(const MachineTrends& trends, const std::string& name) {
  const auto found =
      std::find_if(trends.errors.begin(), trends.errors.end(), [&](const ErrorTrend& one) { return one.name == name; });
  EXPECT_NE(found, trends.errors.end()) << name;
  return *found;
}

TEST(TrendsAtAState, HaveTheDriftAndNoAlarmFromTemperature) {
  const MachineTrends trends = find_trends(twelve_campaigns(true));
  const ErrorTrend& error = trend_of_state(trends, "EXX");
  EXPECT_TRUE(error.drifts);
  EXPECT_NEAR(std::abs(error.per_year), kDriftPerYear, error.expanded_per_year);
  EXPECT_LT(error.expanded_per_year, 0.2 * kDriftPerYear);
  EXPECT_TRUE(trends.is_in_control());
  EXPECT_LT(*error.trend.scatter, kNoise);
  const ErrorTrend& coefficient = trend_of_state(trends, "EXX*ambient");
  EXPECT_EQ(coefficient.per, "K");
  EXPECT_FALSE(coefficient.drifts);
  EXPECT_TRUE(coefficient.expected->is_within);
}

TEST(TrendsAtAState, WithoutStatesTemperatureIsTakenForTheMachine) {
  const MachineTrends naive = find_trends(twelve_campaigns(false));
  const ErrorTrend& error = trend_of_state(naive, "EXX");
  // The campaigns differ by up to 13 K, 20 um.
  EXPECT_GT(*error.trend.scatter, 5 * kNoise);
  EXPECT_GT(error.expanded_per_year, 0.5 * kDriftPerYear);
  // The hot summer after a mild year: an alarm of the last campaign.
  TrendRequest year = twelve_campaigns(false);
  year.campaigns.erase(year.campaigns.begin() + 4, year.campaigns.begin() + 11);
  year.campaigns.erase(year.campaigns.begin() + 1);
  year.campaigns.erase(year.campaigns.begin() + 2);
  EXPECT_FALSE(find_trends(year).is_in_control());
  TrendRequest with = twelve_campaigns(true);
  with.campaigns.erase(with.campaigns.begin() + 4, with.campaigns.begin() + 11);
  with.campaigns.erase(with.campaigns.begin() + 1);
  with.campaigns.erase(with.campaigns.begin() + 2);
  EXPECT_TRUE(find_trends(with).is_in_control());
  EXPECT_TRUE(naive.at_state.empty());
  EXPECT_TRUE(error.extrapolated.empty());
}

TEST(TrendsAtAState, ValuesAndUncertaintiesAreThoseOfAFitAboutThatState) {
  TrendRequest request = twelve_campaigns(true);
  request.states = {"ambient_degC=25.5"};
  const MachineTrends trends = find_trends(request);
  ASSERT_EQ(trends.at_state.size(), 1U);
  EXPECT_EQ(trends.at_state[0].second, 25.5);
  const ErrorTrend& error = trend_of_state(trends, "EXX");
  const LineFit first = measured_campaign(0, 2, 25.5);
  const Axis& x = request.campaigns[0].campaign.machine.axes[request.campaigns[0].campaign.machine.find_axis("X")];
  const double sign = *error.at < 0.5 * (x.travel_min + x.travel_max) ? -1 : 1;  // at an end of the travel
  ASSERT_EQ(error.values.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) {
    const LineFit fit = measured_campaign(k, 2, 25.5);
    EXPECT_NEAR(error.values[k].value, sign * (fit.coefficients[0] - first.coefficients[0]), 1e-9);
    EXPECT_NEAR(error.values[k].uncertainty, std::sqrt(fit.covariance(0, 0)), 1e-9);
    const bool is_outside = fit.coolest > 25.5 || fit.warmest < 25.5;
    EXPECT_EQ(error.extrapolated[k], is_outside ? 1 : 0) << k;
  }
  // Far from the measured temperatures the uncertainty is many times as large: 17 degC against 26 degC.
  EXPECT_GT(error.values[1].uncertainty, 4 * error.values[4].uncertainty);
}

TEST(TrendsAtAState, CampaignsThatDoNotCoverItAreSaid) {
  const MachineTrends trends = find_trends(twelve_campaigns(true));
  const ErrorTrend& error = trend_of_state(trends, "EXX");
  ASSERT_EQ(error.extrapolated.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(error.extrapolated[k], std::abs(kMeanTemperature[k] - 20) >= 2 ? 1 : 0) << k;
  }
  EXPECT_EQ(trends.at_state.outside.size(), 9U);
  EXPECT_THAT(trends.at_state.outside.back(), HasSubstr("c11: ambient_degC = 20 lies outside the 27"));
  const std::string text = evaluation_text(trends.report);
  EXPECT_THAT(text, HasSubstr("ambient_degC = 20"));
  EXPECT_THAT(text, HasSubstr("extrapolated in some campaigns"));
  const nlohmann::ordered_json json = evaluation_json(trends.report);
  EXPECT_EQ(json.dump().find("\"at_state\":{\"ambient_degC\":20.0}") != std::string::npos, true);
  EXPECT_THAT(json.dump(), HasSubstr("\"extrapolated\":[false,true"));
  // The coefficient itself is not extrapolated.
  for (const std::uint8_t is : trend_of_state(trends, "EXX*ambient").extrapolated) EXPECT_EQ(is, 0);
}

TEST(TrendsAtAState, CampaignsMayHaveOtherReferences) {
  TrendRequest request = twelve_campaigns(true), other = request;
  other.states = {"ambient_degC=20"};
  for (KeptCampaign& kept : other.campaigns) {
    // The same errors about 23 degC.
    IdentifiedCampaign& campaign = kept.campaign;
    std::vector<ErrorMotion>& motions = campaign.errors.errors.motions;
    motions[0].coefficients[1] += 3 * motions[1].coefficients[1];
    Eigen::MatrixXd by =
        Eigen::MatrixXd::Identity(campaign.errors.covariance.rows(), campaign.errors.covariance.cols());
    by(1, 3) = 3;
    campaign.errors.covariance = (by * campaign.errors.covariance * by.transpose()).eval();
    campaign.machine.states[0].reference = 23;
  }
  const MachineTrends as_measured = find_trends(request), moved = find_trends(other);
  const ErrorTrend &a = trend_of_state(as_measured, "EXX"), &b = trend_of_state(moved, "EXX");
  EXPECT_NEAR(a.per_year, b.per_year, 1e-9);
  EXPECT_NEAR(a.expanded_per_year, b.expanded_per_year, 1e-9);
}

TEST(TrendsAtAState, RefuseAStateThatNoCampaignHas) {
  TrendRequest request = twelve_campaigns(true);
  request.states = {"spindle_degC=30"};
  EXPECT_THAT(message_of([&] { find_trends(request); }), HasSubstr("the machine has no state 'spindle_degC'"));
}

TEST(TrendsAtAState, WhatTheErrorsWanderWidensLimitsAndComesDueEarlier) {
  TrendRequest request = twelve_campaigns(true);
  request.limit_mm = 20e-3;
  const MachineTrends still = find_trends(request);
  const double per_sqrt_second = 1e-3 / std::sqrt(86400.0);  // 1 um in a day, 10 um in 91 days
  for (KeptCampaign& kept : request.campaigns) kept.campaign.errors.ageing.length = per_sqrt_second;
  const MachineTrends wandering = find_trends(request);
  const ErrorTrend &a = trend_of_state(still, "EXX"), &b = trend_of_state(wandering, "EXX");
  // Both coefficients wander, and both functions are +-1 at the end of the travel.
  const double factor = fit_trend({b.values.begin(), b.values.end() - 1}).coverage_factor;
  EXPECT_NEAR(std::pow(b.expected->expanded, 2) - std::pow(a.expected->expanded, 2), factor * factor * 2 * 91 * 1e-6,
              1e-9);
  EXPECT_GT(b.expected->expanded, 2 * a.expected->expanded);
  ASSERT_TRUE(a.due && b.due);
  EXPECT_LT(*b.due, *a.due);
}

TEST(HistoryWithStates, KeepsThemAndTellsOlderProgramsByItsForm) {
  const std::string file = (test::empty_folder("abbe_history_with_states") / "mill.history").string();
  const auto form = [&] {
    SqliteDatabase database(file, SqliteDatabase::Access::read);
    SqliteStatement statement(database, "PRAGMA user_version");
    return statement.step() ? statement.integer(0) : -1;
  };
  const auto to_keep = [](std::size_t campaign, bool with_states) {
    KeptCampaign kept = campaign_of_readings(campaign, with_states);
    return CampaignToKeep{kept.campaign, kept.measured, "memory", ""};
  };
  add_to_history(file, {to_keep(0, false)});
  EXPECT_EQ(form(), 1);  // as an abbe before states makes and reads it
  add_to_history(file, {to_keep(1, true), to_keep(4, true)});
  EXPECT_EQ(form(), 2);
  add_to_history(file, {to_keep(5, false)});
  EXPECT_EQ(form(), 2);
  const std::vector<KeptCampaign> kept = read_history(file);
  ASSERT_EQ(kept.size(), 4U);
  const IdentifiedCampaign expected = campaign_of_readings(4, true).campaign;
  EXPECT_EQ(kept[2].campaign.errors.errors.motions, expected.errors.errors.motions);
  EXPECT_TRUE(kept[2].campaign.errors.covariance == expected.errors.covariance);
  ASSERT_EQ(kept[2].campaign.errors.covered.size(), 1U);
  // The first campaign knows nothing of the state.
  TrendRequest request;
  request.campaigns = kept;
  const MachineTrends trends = find_trends(request);
  const ErrorTrend& coefficient = trend_of_state(trends, "EXX*ambient");
  ASSERT_TRUE(coefficient.not_followed);
  EXPECT_THAT(*coefficient.not_followed, HasSubstr("the first campaign does not have it"));
}

}  // namespace
}  // namespace abbe
