#pragma once

// Internal to history: trends as people and programs read them.
#include "abbe/history/machine_trends.h"

namespace abbe {

inline constexpr double kDaysPerYear = 365.2425;  // of the calendar, on average

EvaluationReport trend_report(const MachineTrends& trends, const TrendRequest& request);

}  // namespace abbe
