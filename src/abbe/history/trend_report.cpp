#include "abbe/history/trend_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/state_option.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

constexpr std::size_t kMostPlots = 40;

double shown(const ErrorTrend& trend, double value) { return value * (trend.is_angle ? 1e6 : 1e3); }

/// With one decimal, and no minus before a zero.
std::string tenths(double value) { return fmt::format("{:.1f}", std::round(10 * value) / 10 + 0.0); }
/// Coefficients with a state are small numbers.
std::string digits(const ErrorTrend& trend, double value) {
  return trend.per.empty() ? tenths(value) : fmt::format("{:.3f}", std::round(1e3 * value) / 1e3 + 0.0);
}

/// In keys.
const char* unit_of(const ErrorTrend& trend) { return trend.is_angle ? "urad" : "um"; }
/// For people.
std::string symbol_of(const ErrorTrend& trend) {
  return unit_symbol(unit_of(trend)) + (trend.per.empty() || trend.per == "1" ? std::string() : " / " + trend.per);
}

bool any_extrapolated(const ErrorTrend& trend) {
  return std::find(trend.extrapolated.begin(), trend.extrapolated.end(), 1) != trend.extrapolated.end();
}

/// "-3.2 \u00b1 1.1", rounded as in tables.
std::string with_uncertainty(const ErrorTrend& trend, double value, double expanded) {
  return digits(trend, shown(trend, value)) + " \xC2\xB1 " + digits(trend, shown(trend, expanded));
}

std::string place_of(const ErrorTrend& trend) {
  if (!trend.at) return "";
  return trend.at_is_angle ? fmt::format("{:.1f} deg", *trend.at / kDegree) : fmt::format("{:.1f} mm", *trend.at);
}

std::string due_words(const ErrorTrend& trend, double limit_mm) {
  if (!(limit_mm > 0)) return "";
  if (!(trend.at_tool > 0)) return "no effect at the tool";
  return trend.due ? date_text(*trend.due) : "not in 20 years";
}

std::string verdict_words(const ErrorTrend& trend) {
  std::string words = trend.drifts ? "drifts" : "no drift proven";
  if (trend.expected && !trend.expected->is_within) words += "; last value unexpected";
  if (any_extrapolated(trend)) words += "; extrapolated in some campaigns";
  return words;
}

/// The values of an error with k = 2, and the control limits of all but the first.
Sparkline course_of(const ErrorTrend& trend) {
  Sparkline course;
  for (std::size_t k = 0; k < trend.values.size(); ++k) {
    const TimedValue& one = trend.values[k];
    course.days.push_back(one.time);
    course.value.push_back(shown(trend, one.value));
    course.expanded.push_back(shown(trend, 2 * one.uncertainty));
    course.low.emplace_back();
    course.high.emplace_back();
    if (k == 0) continue;
    const Expected& expected = trend.predicted[k - 1];
    course.low.back() = shown(trend, expected.value - expected.expanded);
    course.high.back() = shown(trend, expected.value + expected.expanded);
  }
  return course;
}

EvaluationTable trend_table(const MachineTrends& trends, double limit_mm) {
  EvaluationTable table{
      .caption = "Errors over the campaigns, largest drift at the tool first",
      .headers = {"error", "at", "unit", "change since first", "drift per year", "scatter", "verdict"},
      .rows = {},
      .with_figures = true,
      .in_text = true,
      .note =
          "Course: change since the first campaign, with its expanded uncertainty (band, k = 2) and its control "
          "limits (dashed), which are what the earlier campaigns predict. Each row has a scale of its own."};
  if (limit_mm > 0) table.headers.emplace_back("limit reached");
  std::vector<const ErrorTrend*> order;
  for (const ErrorTrend& one : trends.errors) {
    if (!one.not_followed) order.push_back(&one);
  }
  std::stable_sort(order.begin(), order.end(), [](const ErrorTrend* a, const ErrorTrend* b) {
    return std::abs(a->per_year) * a->at_tool > std::abs(b->per_year) * b->at_tool;
  });
  for (const ErrorTrend* const one : order) {
    const TimedValue& last = one->values.back();
    const double u = std::hypot(last.uncertainty, one->values.front().uncertainty);
    table.rows.push_back({one->name, place_of(*one), symbol_of(*one), with_uncertainty(*one, last.value, 2 * u),
                          with_uncertainty(*one, one->per_year, one->expanded_per_year),
                          one->trend.scatter ? digits(*one, shown(*one, *one->trend.scatter)) : "not known",
                          verdict_words(*one)});
    if (limit_mm > 0) table.rows.back().push_back(due_words(*one, limit_mm));
    table.sparklines.push_back(course_of(*one));
  }
  return table;
}

EvaluationTable campaign_table(const MachineTrends& trends) {
  EvaluationTable table{.caption = "Campaigns", .headers = {"day", "campaign"}, .rows = {}, .with_figures = true};
  for (std::size_t k = 0; k < trends.names.size(); ++k) {
    table.rows.push_back({date_text(trends.dates[k]), trends.names[k]});
  }
  return table;
}

EvaluationPlot trend_plot(const MachineTrends& trends, const ErrorTrend& trend) {
  XyPlot plot(fmt::format("{}: {}", trend.name, trend.words),
              fmt::format("years since {}", date_text(trends.dates.front())),
              fmt::format("change of {} in {}", trend.name, symbol_of(trend)));
  const double last = trend.values.back().time, first = trend.values.front().time;
  const double until = last + 0.25 * (last - first);
  std::vector<double> x, low, high;
  std::vector<PlotPoint> line;
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = first + (until - first) * i / kSteps;
    const double value = trend.trend.at(t - last), expanded = trend.trend.expanded_at(t - last);
    x.push_back(t / kDaysPerYear);
    low.push_back(shown(trend, value - expanded));
    high.push_back(shown(trend, value + expanded));
    line.push_back({t / kDaysPerYear, shown(trend, value)});
  }
  plot.band(x, low, high, {PlotColour::first, 1, false, 0.2}, "trend with its expanded uncertainty and the scatter");
  plot.line(line, {PlotColour::first, 1.5, false, 1});
  std::vector<PlotPoint> points, lower, upper;
  for (const TimedValue& one : trend.values) {
    const double t = one.time / kDaysPerYear;
    points.push_back({t, shown(trend, one.value)});
    plot.line({{t, shown(trend, one.value - 2 * one.uncertainty)}, {t, shown(trend, one.value + 2 * one.uncertainty)}},
              {PlotColour::second, 1, false, 1});
  }
  const Sparkline course = course_of(trend);
  for (std::size_t k = 1; k < points.size(); ++k) {
    lower.push_back({points[k].x, *course.low[k]});
    upper.push_back({points[k].x, *course.high[k]});
  }
  const PlotStyle limit{PlotColour::limit, 1, true, 1};
  plot.line(lower, limit, "control limits: what the earlier campaigns predict");
  plot.line(upper, limit);
  plot.points(points, Marker::circle, {PlotColour::second, 1, false, 1}, "campaigns, k = 2");
  return {.name = "trend-" + trend.name,
          .caption = trend.at ? fmt::format("Change since the first campaign at {}", place_of(trend))
                              : "Change since the first campaign",
          .picture = plot.picture(),
          .in_page = false,
          .beside = true};
}

void add_notes(const MachineTrends& trends, double limit_mm, EvaluationReport& report) {
  for (const std::string& sentence : trends.at_state.outside) report.notes.push_back(sentence + ".");
  if (trends.names.size() == 2) {
    report.notes.emplace_back(
        "Two campaigns always lie on a line, so the scatter from campaign to campaign is not known, and what is "
        "called a drift may be such scatter.");
  }
  for (const ErrorTrend& one : trends.errors) {
    if (one.not_followed) report.notes.push_back(fmt::format("{} is not followed: {}.", one.name, *one.not_followed));
    if (!one.expected || one.expected->is_within) continue;
    report.notes.push_back(
        fmt::format("{} has changed by {} {} up to the last campaign; the earlier campaigns predict {} {}.", one.name,
                    digits(one, shown(one, one.values.back().value)), symbol_of(one),
                    with_uncertainty(one, one.expected->value, one.expected->expanded), symbol_of(one)));
  }
  if (limit_mm > 0 && trends.next) {
    report.notes.push_back(
        fmt::format("Measure again by {}: by then {} alone may have moved the tool by {:g} {} since the last campaign.",
                    date_text(*trends.next), trends.next_error, 1e3 * limit_mm, unit_symbol("um")));
  }
}

nlohmann::ordered_json trend_json(const ErrorTrend& one, double limit_mm) {
  const std::string unit = unit_of(one);
  nlohmann::ordered_json json{{"name", one.name}, {"words", one.words}};
  if (one.not_followed) {
    json["not_followed"] = *one.not_followed;
    return json;
  }
  if (!one.per.empty()) json["per"] = one.per;
  if (one.at) json[one.at_is_angle ? "at_deg" : "at_mm"] = one.at_is_angle ? *one.at / kDegree : *one.at;
  for (const TimedValue& value : one.values) {
    json["days"].push_back(value.time);
    json["change_" + unit].push_back(shown(one, value.value));
    json["standard_uncertainty_" + unit].push_back(shown(one, value.uncertainty));
  }
  for (const std::uint8_t is : one.extrapolated) json["extrapolated"].push_back(is != 0);
  // Nothing predicts the first value.
  json["control_low_" + unit] = json["control_high_" + unit] = nlohmann::ordered_json::array({nullptr});
  for (const Expected& expected : one.predicted) {
    json["control_low_" + unit].push_back(shown(one, expected.value - expected.expanded));
    json["control_high_" + unit].push_back(shown(one, expected.value + expected.expanded));
  }
  json["drift_" + unit + "_per_year"] = shown(one, one.per_year);
  json["drift_expanded_uncertainty_" + unit + "_per_year"] = shown(one, one.expanded_per_year);
  json["coverage_factor"] = one.trend.coverage_factor;
  json["scatter_" + unit] = one.trend.scatter ? nlohmann::ordered_json(shown(one, *one.trend.scatter)) : nullptr;
  json["drifts"] = one.drifts;
  json["expected_" + unit] = shown(one, one.expected->value);
  json["expected_expanded_uncertainty_" + unit] = shown(one, one.expected->expanded);
  json["last_is_expected"] = one.expected->is_within;
  if (limit_mm > 0) json["limit_reached"] = one.due ? nlohmann::ordered_json(date_text(*one.due)) : nullptr;
  return json;
}

}  // namespace

EvaluationReport trend_report(const MachineTrends& trends, const TrendRequest& request) {
  EvaluationReport report;
  report.kind = "history";
  report.title = "Errors of a machine over its campaigns";
  const auto add_count = [&](const char* symbol, const char* name, std::size_t count) {
    EvaluationFigure figure;
    figure.symbol = symbol;
    figure.name = name;
    figure.quantity = Quantity::dimensionless;
    figure.unit = "";
    figure.decimals = 0;
    figure.value = static_cast<double>(count);
    report.figures.push_back(std::move(figure));
  };
  std::size_t followed = 0, drifting = 0, unexpected = 0;
  for (const ErrorTrend& one : trends.errors) {
    followed += one.not_followed ? 0U : 1U;
    drifting += one.drifts ? 1U : 0U;
    unexpected += one.expected && !one.expected->is_within ? 1U : 0U;
  }
  add_count("followed", "errors that could be followed", followed);
  add_count("drifting", "of these, with a significant drift (95 %)", drifting);
  add_count("unexpected", "of these, with a last value outside what the earlier ones predict", unexpected);
  report.facts = {{"campaigns", fmt::format("{}, {} to {}", trends.names.size(), date_text(trends.dates.front()),
                                            date_text(trends.dates.back()))}};
  if (!trends.at_state.empty()) report.facts.emplace_back("errors at the state", state_words(trends.at_state));
  if (request.limit_mm > 0) {
    report.facts.emplace_back(
        "limit", fmt::format("{:g} {} at the tool, for each error", 1e3 * request.limit_mm, unit_symbol("um")));
    report.facts.emplace_back("measure again by", trends.next ? date_text(*trends.next) : "not in 20 years");
  }
  report.tables = {trend_table(trends, request.limit_mm), campaign_table(trends)};
  add_notes(trends, request.limit_mm, report);
  for (std::size_t k = 0; k < trends.names.size(); ++k) {
    report.details["campaigns"].push_back({{"name", trends.names[k]}, {"day", date_text(trends.dates[k])}});
  }
  for (const auto& [column, value] : trends.at_state) report.details["at_state"][column] = value;
  for (const std::string& one : trends.at_state.outside) report.details["states_outside_measured"].push_back(one);
  if (request.limit_mm > 0) {
    report.details["limit_um"] = 1e3 * request.limit_mm;
    report.details["measure_again_by"] = trends.next ? nlohmann::ordered_json(date_text(*trends.next)) : nullptr;
  }
  for (const ErrorTrend& one : trends.errors) report.details["errors"].push_back(trend_json(one, request.limit_mm));
  if (request.page) {
    for (const ErrorTrend& one : trends.errors) {
      if (!one.not_followed && report.plots.size() < kMostPlots) report.plots.push_back(trend_plot(trends, one));
    }
    if (followed > kMostPlots) {
      report.notes.push_back(fmt::format("Of {} errors, the first {} have a plot.", followed, kMostPlots));
    }
  }
  return report;
}

}  // namespace abbe
