#include "bindings/history/trends.h"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/history/machine_trends.h"
#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/report.h"
#include "bindings/history/dates.h"

namespace abbe::python {
namespace {

/// An error over the campaigns, with the days of its values.
struct DatedTrend {
  ErrorTrend error;
  std::vector<Date> dates;  ///< [values]
};

DatedTrend dated_trend(const MachineTrends& trends, const ErrorTrend& error) {
  DatedTrend result{error, {}};
  for (const std::size_t campaign : error.campaigns) result.dates.push_back(trends.dates[campaign]);
  return result;
}

/// What there is only for an error with a trend.
template <class Value>
std::optional<Value> if_followed(const DatedTrend& trend, const Value& value) {
  if (trend.error.not_followed) return std::nullopt;
  return value;
}

nb::object date_or_none(const std::optional<Date>& date) { return date ? python_date(*date) : nb::none(); }

/// [m] value of the line and its expanded uncertainty with the scatter, at some days.
nb::tuple predicted(const DatedTrend& trend, const DaysArgument& arguments) {
  const std::vector<Date> dates = days_of(arguments, "dates");
  if (trend.error.not_followed) {
    throw InputError({.field = "dates"},
                     fmt::format("{} has no trend: {}", trend.error.name, *trend.error.not_followed),
                     "an error that is followed");
  }
  const Trend& line = trend.error.trend;
  std::vector<double> values, expanded;
  for (const Date date : dates) {
    const auto days = static_cast<double>((date - trend.dates.back()).count());
    values.push_back(line.at(days));
    expanded.push_back(line.expanded_at(days));
  }
  const std::size_t count = dates.size();
  return nb::make_tuple(array_of(std::move(values), {count}), array_of(std::move(expanded), {count}));
}

void add_values(nb::class_<DatedTrend>& bound) {
  bound
      .def_prop_ro(
          "campaigns",
          [](const DatedTrend& t) { return ints_of_each(t.error.campaigns, [](std::size_t index) { return index; }); },
          nb::sig("def campaigns(self) -> numpy.ndarray"),
          "[n] campaigns that know the error, as indices into HistoryTrends.names.")
      .def_prop_ro(
          "dates", [](const DatedTrend& t) { return array_of_days(t.dates); },
          nb::sig("def dates(self) -> numpy.ndarray"), "[n] days of these campaigns, datetime64[D].")
      .def_prop_ro(
          "changes_mm_rad", [](const DatedTrend& t) { return numbers_of_each(t.error.values, &TimedValue::value); },
          nb::sig("def changes_mm_rad(self) -> numpy.ndarray"),
          "[n] change since the first of these campaigns, whose own change is 0.")
      .def_prop_ro(
          "standard_uncertainties_mm_rad",
          [](const DatedTrend& t) { return numbers_of_each(t.error.values, &TimedValue::uncertainty); },
          nb::sig("def standard_uncertainties_mm_rad(self) -> numpy.ndarray"),
          "[n] of the error in each campaign by itself; that of a difference comes from both.");
}

void add_line(nb::class_<DatedTrend>& bound) {
  bound
      .def_prop_ro(
          "drifts", [](const DatedTrend& t) { return t.error.drifts; },
          "Whether the drift is larger than its expanded uncertainty.")
      .def_prop_ro(
          "drift_mm_rad_per_year", [](const DatedTrend& t) { return if_followed(t, t.error.per_year); },
          "Slope of the line; None: the error is not followed.")
      .def_prop_ro(
          "drift_expanded_uncertainty_mm_rad_per_year",
          [](const DatedTrend& t) { return if_followed(t, t.error.expanded_per_year); },
          "Of the slope, at 95.45 %; None: the error is not followed.")
      .def_prop_ro(
          "scatter_mm_rad", [](const DatedTrend& t) { return t.error.trend.scatter; },
          "Standard deviation from campaign to campaign that the uncertainties do not explain; None: two campaigns "
          "are\n"
          "always on a line, or the error is not followed.")
      .def_prop_ro(
          "coverage_factor", [](const DatedTrend& t) { return if_followed(t, t.error.trend.coverage_factor); },
          "Of the trend's expanded uncertainties: Student's t with n - 2 degrees of freedom if there is a scatter,\n"
          "else 2.")
      .def_prop_ro(
          "probability", [](const DatedTrend& t) { return t.error.trend.probability; },
          "Of so large a slope without a drift; None: it is not known.")
      .def("predict", &predicted, nb::arg("dates"),
           nb::sig("def predict(self, dates: collections.abc.Sequence[datetime.date | numpy.datetime64 | str] | "
                   "numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]"),
           "The line at these days, [m] change since the first campaign, and [m] its expanded uncertainty with the\n"
           "scatter; mm or rad. Raises InputError for what is no day, and if the error is not followed.");
}

void add_expectation(nb::class_<DatedTrend>& bound) {
  bound
      .def_prop_ro(
          "expected_mm_rad",
          [](const DatedTrend& t) -> std::optional<double> {
            if (!t.error.expected) return std::nullopt;
            return t.error.expected->value;
          },
          "Last change as the earlier campaigns predict it; None: the error is not followed.")
      .def_prop_ro(
          "expected_expanded_uncertainty_mm_rad",
          [](const DatedTrend& t) -> std::optional<double> {
            if (!t.error.expected) return std::nullopt;
            return t.error.expected->expanded;
          },
          "Of the difference between the last change and its prediction.")
      .def_prop_ro(
          "limits_mm_rad",
          [](const DatedTrend& t) -> std::optional<std::pair<double, double>> {
            if (!t.error.expected) return std::nullopt;
            const Expected& expected = *t.error.expected;
            return std::pair(expected.value - expected.expanded, expected.value + expected.expanded);
          },
          "Control limits of the last change, (lower, upper); None: the error is not followed.")
      .def_prop_ro(
          "last_is_expected",
          [](const DatedTrend& t) -> std::optional<bool> {
            if (!t.error.expected) return std::nullopt;
            return t.error.expected->is_within;
          },
          "Whether the last change is within these limits; None: the error is not followed.")
      .def_prop_ro(
          "tool_mm_per_mm_rad", [](const DatedTrend& t) { return if_followed(t, t.error.at_tool); },
          "Displacement of the functional point per mm or rad of the error, mm; None: the error is not followed.")
      .def_prop_ro(
          "due", [](const DatedTrend& t) { return date_or_none(t.error.due); },
          nb::sig("def due(self) -> datetime.date | None"),
          "Day on which the error may have moved the tool by limit_um since the last campaign; None: not in 20 years,\n"
          "or no limit was given.");
}

void bind_dated_trend(nb::module_& module) {
  nb::class_<DatedTrend> bound(module, "ErrorTrend",
                               "One error of a machine over its campaigns; mm or rad.\n\n"
                               "An error motion is followed at one position of its axis, where its change to the last "
                               "campaign is largest.");
  bound
      .def_prop_ro(
          "name", [](const DatedTrend& t) { return t.error.name; }, "'EXX', 'EC0Y', 'reversal_X'.")
      .def_prop_ro(
          "words", [](const DatedTrend& t) { return t.error.words; }, "Such as 'positioning error motion of X'.")
      .def_prop_ro(
          "is_angle", [](const DatedTrend& t) { return t.error.is_angle; }, "Whether numbers are in rad; else in mm.")
      .def_prop_ro(
          "per", [](const DatedTrend& t) { return t.error.per; },
          "Of a coefficient with a state, 'EXX*ambient': unit of the factor of its state, 'K', per which all numbers\n"
          "are; else ''.")
      .def_prop_ro(
          "extrapolated",
          [](const DatedTrend& t) {
            nb::list values;
            for (const std::uint8_t is : t.error.extrapolated) values.append(is != 0);
            return values;
          },
          nb::sig("def extrapolated(self) -> list[bool]"),
          "[n] whether the readings of a campaign did not cover HistoryTrends.at_state; empty without states.")
      .def_prop_ro(
          "at_mm_rad", [](const DatedTrend& t) { return t.error.at; },
          "Position on its axis, mm or rad; None: the error is no function.")
      .def_prop_ro(
          "not_followed", [](const DatedTrend& t) { return t.error.not_followed; },
          "Why there is no trend, in words; None: there is one.");
  add_values(bound);
  add_line(bound);
  add_expectation(bound);
  bound
      .def(
          "__len__", [](const DatedTrend& t) { return t.error.values.size(); }, "Number of values.")
      .def("__repr__", [](const DatedTrend& t) {
        const ErrorTrend& error = t.error;
        if (error.not_followed) return fmt::format("<abbe.ErrorTrend {}: not followed>", error.name);
        return fmt::format("<abbe.ErrorTrend {}: {} values, {}{}>", error.name, error.values.size(),
                           error.drifts ? "drifts" : "no drift proven",
                           error.expected->is_within ? "" : ", last value unexpected");
      });
}

}  // namespace

void bind_trends(nb::module_& module) {
  bind_dated_trend(module);
  nb::class_<MachineTrends> bound(
      module, "HistoryTrends",
      "The errors of a machine over its campaigns. Made by History.trends().\n\n"
      "errors has the trends as numbers and arrays; text(), json_text(), page_html() and write() give what\n"
      "`abbe history trends` writes.");
  add_report(
      bound, &MachineTrends::report, +[](const MachineTrends&) { return ResultFiles{}; });
  bound.def_ro("names", &MachineTrends::names, "Of the campaigns that took part, in the order of time.")
      .def_prop_ro(
          "dates", [](const MachineTrends& t) { return array_of_days(t.dates); },
          nb::sig("def dates(self) -> numpy.ndarray"), "[campaigns] days of the measurements, datetime64[D].")
      .def_prop_ro(
          "errors",
          [](const MachineTrends& t) {
            nb::dict errors;
            for (const ErrorTrend& error : t.errors) errors[error.name.c_str()] = nb::cast(dated_trend(t, error));
            return errors;
          },
          nb::sig("def errors(self) -> dict[str, ErrorTrend]"), "All errors by name.")
      .def_prop_ro(
          "next_date", [](const MachineTrends& t) { return date_or_none(t.next); },
          nb::sig("def next_date(self) -> datetime.date | None"),
          "When to measure again at the latest; None: not in 20 years, or no limit was given.")
      .def_prop_ro(
          "at_state",
          [](const MachineTrends& t) { return std::map<std::string, double>(t.at_state.begin(), t.at_state.end()); },
          "State at which errors are followed, {'ambient_degC': 20.0}; empty: none depends on a state.")
      .def_prop_ro(
          "outside", [](const MachineTrends& t) { return t.at_state.outside; },
          "Where campaigns are extrapolated to this state, a sentence each.")
      .def_ro("next_error", &MachineTrends::next_error, "Name of the error that decides it, or ''.")
      .def_prop_ro("in_control", &MachineTrends::is_in_control,
                   "Whether no error is outside what its earlier values predict.")
      .def(
          "errors_to_dataframe",
          [](nb::handle_t<MachineTrends> self) {
            return nb::module_::import_("abbe._tables").attr("trends_frame")(self);
          },
          nb::sig("def errors_to_dataframe(self) -> pandas.DataFrame"),
          "A row for each error that is followed, in um or urad. Needs pandas.")
      .def("__repr__", [](const MachineTrends& t) {
        return fmt::format("<abbe.HistoryTrends: {} errors over {} campaigns{}>", t.errors.size(), t.names.size(),
                           t.is_in_control() ? "" : ", not in control");
      });
}

}  // namespace abbe::python
