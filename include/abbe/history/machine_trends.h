#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/history/machine_history.h"
#include "abbe/history/trend.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/study/job_options.h"

namespace abbe {

/// Campaigns whose errors are to be followed.
///
/// Messages name a field by the option of `abbe history trends` that sets it, given below.
struct TrendRequest {
  std::vector<KeptCampaign> campaigns;  ///< of read_history(): two or more
  double limit_mm = 0;                  ///< --limit-um: tolerated change at the tool since the last campaign; 0: none
  std::size_t last = 26;                ///< --last: the newest campaigns only, 2 to 26
  bool page = false;                    ///< the report is to have plots, for its page
  /// --state: "ambient_degC=26.5", where errors with states are followed; else at the references of the newest campaign
  std::vector<std::string> states{};
};

/// One error over the campaigns; mm or rad.
///
/// An error without a state in its name ("EXX") is followed as it is at the state of the trends, a coefficient with one
/// ("EXX*ambient") per unit of the factor of its state.
struct ErrorTrend {
  std::string name, words;  ///< "EXX", "positioning error motion of X"
  std::string per{};        ///< of a coefficient with a state: unit of its factor, "K"
  bool is_angle = false;
  std::optional<double> at;            ///< where on its axis, mm or rad: of a motion
  bool at_is_angle = false;            ///< of `at`
  std::vector<std::size_t> campaigns;  ///< which of them know it, indices
  std::vector<TimedValue> values;      ///< change since the first of them; days since the first campaign
  /// [values] whether the readings of the campaign did not cover the state; empty: nothing depends on states
  std::vector<std::uint8_t> extrapolated{};
  std::optional<std::string> not_followed;  ///< why there is no trend, in words
  Trend trend;
  bool drifts = false;
  double per_year = 0, expanded_per_year = 0;  ///< slope and its expanded uncertainty
  std::vector<Expected> predicted;             ///< [values - 1] what the values before each later one predict for it
  std::optional<Expected> expected;            ///< the last of these: of the last value
  double at_tool = 0;                          ///< displacement of the functional point per unit of the error, mm
  std::optional<Date> due;                     ///< when the limit may be reached; none: not in 20 years
};

struct MachineTrends {
  std::vector<std::string> names;  ///< of the campaigns that took part, in the order of time
  std::vector<Date> dates;
  StateValues at_state{};  ///< where errors with states are followed, and what is extrapolated there; empty: none has
  std::vector<ErrorTrend> errors;
  std::optional<Date> next;  ///< with a limit: when to measure again at the latest; none: not in 20 years
  std::string next_error;    ///< which error decides it
  EvaluationReport report;

  /// Whether no error is outside what its earlier values predict.
  bool is_in_control() const;
};

/// Follows the errors of a machine over its campaigns. Opens no file and prints nothing.
/// @throws InputError for fewer than two campaigns at different dates, a state that no campaign has, and as
///   compare_campaigns()
/// @throws Stopped
MachineTrends find_trends(const TrendRequest& request, const JobOptions& options = {});

}  // namespace abbe
