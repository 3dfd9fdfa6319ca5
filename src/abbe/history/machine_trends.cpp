#include "abbe/history/machine_trends.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/history/trend_report.h"
#include "abbe/history/trend_states.h"
#include "abbe/study/comparison/compared_campaigns.h"

namespace abbe {
namespace {

constexpr std::size_t kMostFollowed = 26;  // as compare_campaigns() takes
constexpr const char* kToolOffset = "tool_offset";
constexpr double kLongestDays = 20 * kDaysPerYear;

double days_between(Date from, Date to) { return static_cast<double>((to - from).count()); }

/// A number of a curve at a position, between its points; nothing outside.
std::optional<double> value_at(const std::vector<double>& positions, const std::vector<double>& values, double at) {
  if (values.empty() || !(at >= positions.front() && at <= positions.back())) return std::nullopt;
  const auto above = std::lower_bound(positions.begin(), positions.end(), at);
  const auto k = static_cast<std::size_t>(above - positions.begin());
  if (k == 0) return values.front();
  const double share = (at - positions[k - 1]) / (positions[k] - positions[k - 1]);
  return (1 - share) * values[k - 1] + share * values[k];
}

/// Change of an error from the first to another campaign at one place, and the standard uncertainties of both.
struct ChangeAt {
  double change = 0, u_first = 0, u_second = 0;
};

std::optional<ChangeAt> change_at(const ComparedError& error, std::optional<double> at) {
  if (!is_comparable(error.verdict) || !error.expanded_uncertainty) return std::nullopt;
  if (!error.is_motion || !at) return ChangeAt{error.change, error.u_value[0], error.u_value[1]};
  const ComparedCurve& curve = error.curve;
  const std::optional<double> change = value_at(curve.position, curve.change, *at);
  const std::optional<double> first = value_at(curve.position, curve.u_first, *at);
  const std::optional<double> second = value_at(curve.position, curve.u_second, *at);
  if (!change || !first || !second) return std::nullopt;
  return ChangeAt{*change, *first, *second};
}

/// The newest campaigns, in the order of time.
std::vector<KeptCampaign> newest(const TrendRequest& request) {
  if (request.last < 2 || request.last > kMostFollowed) {
    throw InputError({.field = "--last"}, fmt::format("{} campaigns", request.last),
                     fmt::format("2 to {}", kMostFollowed));
  }
  const std::size_t count = std::min(request.last, request.campaigns.size());
  std::vector<KeptCampaign> result(request.campaigns.end() - static_cast<std::ptrdiff_t>(count),
                                   request.campaigns.end());
  if (count < 2 || result.front().measured == result.back().measured) {
    throw InputError({.field = "history"}, fmt::format("{} in it", count == 1 ? "one campaign is" : "no two days are"),
                     "campaigns of two days or more");
  }
  return result;
}

class TrendSearch {
 public:
  TrendSearch(const std::vector<KeptCampaign>& campaigns, const CampaignsAtState& there,
              const ComparedCampaigns& compared, double limit)
      : campaigns_(campaigns), there_(there), compared_(compared), limit_(limit) {}

  ErrorTrend trend_of(const ComparedError& model) const {
    ErrorTrend trend;
    trend.name = model.name;
    trend.words = model.words;
    trend.per = model.per;
    trend.is_angle = model.is_angle;
    if (model.name == kToolOffset) {
      trend.not_followed = "it is a vector, whose length has no direction";
      return trend;
    }
    const std::vector<const ComparedError*> found = against_first(model.name);
    // Where the change to the newest campaign that knows the error is largest.
    const auto newest = std::find_if(found.rbegin(), found.rend(),
                                     [](const ComparedError* one) { return one && is_comparable(one->verdict); });
    if (newest == found.rend()) {
      trend.not_followed = "a convention sets it, or the campaigns do not state its uncertainty";
      return trend;
    }
    if ((*newest)->is_motion) {
      trend.at = (*newest)->at;
      trend.at_is_angle = compared_.machine.axes[(*newest)->axis].kind == AxisKind::rotary;
    }
    const double size = std::abs((*newest)->change);
    trend.at_tool = size > 0 ? (*newest)->at_tool / size : 0;
    add_values(found, trend);
    if (trend.values.size() < 2 || trend.values.front().time == trend.values.back().time) {
      trend.not_followed = "fewer than two campaigns know it and its uncertainty";
      return trend;
    }
    trend.trend = fit_trend(trend.values);
    trend.drifts = trend.trend.drifts();
    trend.per_year = kDaysPerYear * trend.trend.slope;
    trend.expanded_per_year = kDaysPerYear * trend.trend.coverage_factor * trend.trend.u_slope;
    for (std::size_t k = 2; k <= trend.values.size(); ++k) {
      trend.predicted.push_back(
          expected_last({trend.values.begin(), trend.values.begin() + static_cast<std::ptrdiff_t>(k)},
                        wander(trend.campaigns[k - 2], trend)));
    }
    trend.expected = trend.predicted.back();
    if (limit_ > 0 && trend.at_tool > 0) {
      const std::optional<double> days =
          time_to_limit(trend.trend, trend.values.back().uncertainty, limit_ / trend.at_tool, kLongestDays,
                        wander(trend.campaigns.back(), trend));
      const Date last = campaigns_[trend.campaigns.back()].measured;
      if (days) trend.due = last + std::chrono::days(static_cast<int>(std::floor(*days)));
    }
    return trend;
  }

 private:
  /// [campaigns] the error in the comparison with the first campaign; null where there is none.
  std::vector<const ComparedError*> against_first(const std::string& name) const {
    std::vector<const ComparedError*> result(campaigns_.size(), nullptr);
    for (const ComparedPair& pair : compared_.pairs) {
      if (pair.first != 0) continue;
      for (const ComparedError& error : pair.errors) {
        if (error.name == name) result[pair.second] = &error;
      }
    }
    return result;
  }

  void add_values(const std::vector<const ComparedError*>& found, ErrorTrend& trend) const {
    std::vector<TimedValue> later;
    double u_first = 0;
    for (std::size_t k = 1; k < found.size(); ++k) {
      const std::optional<ChangeAt> change = found[k] != nullptr ? change_at(*found[k], trend.at) : std::nullopt;
      if (!change || !(change->u_first > 0) || !(change->u_second > 0)) continue;
      // The same first campaign in every pair; with other conventions its uncertainty may differ, and the largest
      // counts.
      u_first = std::max(u_first, change->u_first);
      later.push_back({days_between(campaigns_[0].measured, campaigns_[k].measured), change->change, change->u_second});
      trend.campaigns.push_back(k);
    }
    if (later.empty()) return;
    trend.values.push_back({0, 0, u_first});
    trend.campaigns.insert(trend.campaigns.begin(), 0);
    trend.values.insert(trend.values.end(), later.begin(), later.end());
    if (there_.extrapolated.empty()) return;
    for (const std::size_t k : trend.campaigns) {
      const std::vector<std::string>& names = there_.extrapolated[k];
      trend.extrapolated.push_back(std::find(names.begin(), names.end(), trend.name) != names.end() ? 1 : 0);
    }
  }

  double wander(std::size_t campaign, const ErrorTrend& trend) const {
    return wander_per_day(there_.campaigns[campaign], trend.name, trend.at);
  }

  const std::vector<KeptCampaign>& campaigns_;
  const CampaignsAtState& there_;
  const ComparedCampaigns& compared_;
  double limit_;
};

/// Coefficients with states that later campaigns have and the first one does not: there is nothing to follow them from.
void add_missing_in_first(const ComparedCampaigns& compared, std::vector<std::string>& known, MachineTrends& trends) {
  for (const ComparedPair& pair : compared.pairs) {
    if (pair.first != 0) continue;
    for (const std::string& name : pair.only_second) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      known.push_back(name);
      ErrorTrend& trend = trends.errors.emplace_back();
      trend.name = trend.words = name;
      trend.not_followed = "the first campaign does not have it";
    }
  }
}

}  // namespace

bool MachineTrends::is_in_control() const {
  return std::all_of(errors.begin(), errors.end(),
                     [](const ErrorTrend& one) { return !one.expected || one.expected->is_within; });
}

MachineTrends find_trends(const TrendRequest& request, const JobOptions& options) {
  if (!(request.limit_mm >= 0) || !std::isfinite(request.limit_mm)) {
    throw InputError({.field = "--limit-um"}, "is not a length", "a length of 0 um or more");
  }
  const std::vector<KeptCampaign> campaigns = newest(request);
  CompareRequest compare;
  compare.curves = true;
  std::vector<std::string> sources;
  for (const KeptCampaign& one : campaigns) {
    compare.campaigns.push_back(one.campaign);
    sources.push_back(date_text(one.measured));
  }
  make_names_different(compare.campaigns, sources);
  const CampaignsAtState there = campaigns_at_state(std::move(compare.campaigns), request.states);
  compare.campaigns = there.campaigns;
  const ComparedCampaigns compared = compare_campaigns(compare, options);

  MachineTrends trends;
  trends.names = compared.names;
  trends.at_state = there.at_state;
  for (const KeptCampaign& one : campaigns) trends.dates.push_back(one.measured);
  const TrendSearch search(campaigns, there, compared, request.limit_mm);
  std::vector<std::string> known;
  for (const ComparedPair& pair : compared.pairs) {
    for (const ComparedError& error : pair.errors) {
      if (pair.first != 0 || std::find(known.begin(), known.end(), error.name) != known.end()) continue;
      known.push_back(error.name);
      trends.errors.push_back(search.trend_of(error));
    }
  }
  if (!there.at_state.empty()) add_missing_in_first(compared, known, trends);
  for (const ErrorTrend& one : trends.errors) {
    if (!one.due || (trends.next && *trends.next <= *one.due)) continue;
    trends.next = one.due;
    trends.next_error = one.name;
  }
  trends.report = trend_report(trends, request);
  return trends;
}

}  // namespace abbe
