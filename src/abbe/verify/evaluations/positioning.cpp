#include "abbe/verify/evaluations/positioning.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

using Span = PositioningEvaluation::Span;

/// Keeps the smallest and the largest of values at targets.
class Extremes {
 public:
  void add(double low, double high, std::size_t target) {
    if (!any_ || low < span_.low) {
      span_.low = low;
      span_.low_at = target;
    }
    if (!any_ || high > span_.high) {
      span_.high = high;
      span_.high_at = target;
    }
    any_ = true;
  }
  Span span() const {
    Span span = span_;
    span.figure = EvaluatedFigure::of(span.high - span.low);
    return span;
  }

 private:
  Span span_;
  bool any_ = false;
};

Span missing(FigureStatus status) {
  Span span;
  span.figure = EvaluatedFigure::without(status);
  return span;
}

/// Fills one direction of a target from its readings. @param values  deviations, not empty
void evaluate_direction(const std::vector<double>& values, std::size_t k, PositioningTarget& target) {
  const double n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  target.runs[k] = values.size();
  target.mean[k] = sum / n;
  if (values.size() < 2) {
    target.repeatability[k] = EvaluatedFigure::without(FigureStatus::needs_two_runs);
    return;
  }
  for (const double value : values) squares += (value - target.mean[k]) * (value - target.mean[k]);
  target.deviation[k] = std::sqrt(squares / (n - 1));
  target.repeatability[k] = EvaluatedFigure::of(4 * target.deviation[k]);
}

void evaluate_target(const std::array<std::vector<double>, 2>& values, PositioningTarget& target) {
  for (const std::size_t k : {0U, 1U}) {
    if (values[k].empty()) {
      target.repeatability[k] = EvaluatedFigure::without(FigureStatus::needs_this_direction);
    } else {
      evaluate_direction(values[k], k, target);
    }
  }
  if (values[0].empty() || values[1].empty()) {
    const auto none = EvaluatedFigure::without(FigureStatus::needs_both_directions);
    target.reversal = target.mean_bidirectional = target.bidirectional_repeatability = none;
    return;
  }
  const double reversal = target.mean[0] - target.mean[1];
  target.reversal = EvaluatedFigure::of(reversal);
  target.mean_bidirectional = EvaluatedFigure::of((target.mean[0] + target.mean[1]) / 2);
  if (values[0].size() < 2 || values[1].size() < 2) {
    target.bidirectional_repeatability = EvaluatedFigure::without(FigureStatus::needs_two_runs);
    return;
  }
  target.bidirectional_repeatability =
      EvaluatedFigure::of(std::max({2 * target.deviation[0] + 2 * target.deviation[1] + std::abs(reversal),
                                    target.repeatability[0].value, target.repeatability[1].value}));
}

/// What the targets lack for a figure, or `evaluated`.
FigureStatus status_of(const std::vector<PositioningTarget>& targets, bool positive, bool negative, bool needs_runs,
                       bool needs_positions) {
  if (targets.empty()) return FigureStatus::no_readings;
  bool all_directions = true, all_repeated = true;
  for (const PositioningTarget& target : targets) {
    for (const std::size_t k : {0U, 1U}) {
      if (!(k == 0 ? positive : negative)) continue;
      all_directions = all_directions && target.runs[k] > 0;
      all_repeated = all_repeated && target.runs[k] > 1;
    }
  }
  if (!all_directions) {
    return positive && negative ? FigureStatus::needs_both_directions : FigureStatus::needs_this_direction;
  }
  if (needs_runs && !all_repeated) return FigureStatus::needs_two_runs;
  if (needs_positions && targets.size() < 2) return FigureStatus::needs_two_positions;
  return FigureStatus::evaluated;
}

/// Span of mean +- width standard deviations over the directions asked for.
Span span_of(const std::vector<PositioningTarget>& targets, bool positive, bool negative, double width) {
  const FigureStatus status = status_of(targets, positive, negative, width > 0, true);
  if (status != FigureStatus::evaluated) return missing(status);
  Extremes extremes;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    for (const std::size_t k : {0U, 1U}) {
      if (!(k == 0 ? positive : negative)) continue;
      const double reach = width * targets[i].deviation[k];
      extremes.add(targets[i].mean[k] - reach, targets[i].mean[k] + reach, i);
    }
  }
  return extremes.span();
}

void evaluate_reversal(PositioningEvaluation& result) {
  const FigureStatus status = status_of(result.targets, true, true, false, false);
  if (status != FigureStatus::evaluated) {
    result.reversal = result.mean_reversal = EvaluatedFigure::without(status);
    result.mean_bidirectional = missing(status);
    return;
  }
  double sum = 0;
  Extremes means;
  result.reversal = EvaluatedFigure::of(-1);
  for (std::size_t i = 0; i < result.targets.size(); ++i) {
    const PositioningTarget& target = result.targets[i];
    sum += target.reversal.value;
    means.add(target.mean_bidirectional.value, target.mean_bidirectional.value, i);
    if (std::abs(target.reversal.value) <= result.reversal.value) continue;
    result.reversal.value = std::abs(target.reversal.value);
    result.reversal_at = i;
  }
  result.mean_reversal = EvaluatedFigure::of(sum / static_cast<double>(result.targets.size()));
  result.mean_bidirectional = result.targets.size() < 2 ? missing(FigureStatus::needs_two_positions) : means.span();
}

/// R of a target and from where to where it reaches: over both sides, or over the one that is wider than that.
Span repeatability_span(const PositioningTarget& target, std::size_t at) {
  Span span;
  span.figure = target.bidirectional_repeatability;
  span.low_at = span.high_at = at;
  const auto reach = [&](std::size_t low, std::size_t high) {
    span.low = target.mean[low] - 2 * target.deviation[low];
    span.high = target.mean[high] + 2 * target.deviation[high];
  };
  const std::size_t lower = target.mean[0] < target.mean[1] ? 0 : 1;
  const std::size_t wider = target.deviation[0] > target.deviation[1] ? 0 : 1;
  if (span.figure.value > target.repeatability[wider].value) {
    reach(lower, 1 - lower);
  } else {
    reach(wider, wider);
  }
  return span;
}

void evaluate_repeatability(PositioningEvaluation& result) {
  for (const std::size_t k : {0U, 1U}) {
    const FigureStatus status = status_of(result.targets, k == 0, k == 1, true, false);
    EvaluatedFigure& figure = result.unidirectional_repeatability[k];
    figure = EvaluatedFigure::without(status);
    if (!figure.is_evaluated()) continue;
    for (const PositioningTarget& target : result.targets) {
      figure.value = std::max(figure.value, target.repeatability[k].value);
    }
  }
  const FigureStatus status = status_of(result.targets, true, true, true, false);
  result.repeatability = missing(status);
  if (status != FigureStatus::evaluated) return;
  std::size_t largest = 0;
  for (std::size_t i = 1; i < result.targets.size(); ++i) {
    if (result.targets[i].bidirectional_repeatability.value > result.targets[largest].bidirectional_repeatability.value)
      largest = i;
  }
  result.repeatability = repeatability_span(result.targets[largest], largest);
}

}  // namespace

std::string_view figure_status_words(FigureStatus status) {
  switch (status) {
    case FigureStatus::not_evaluated:
      return "nothing was computed";
    case FigureStatus::evaluated:
      return "evaluated";
    case FigureStatus::no_readings:
      return "there are no readings";
    case FigureStatus::needs_two_runs:
      return "a position was read only once from a side: no standard deviation";
    case FigureStatus::needs_both_directions:
      return "a position was not approached from both sides: no reversal";
    case FigureStatus::needs_this_direction:
      return "a position was not approached from this side";
    case FigureStatus::needs_two_positions:
      return "only one position was read";
  }
  return "";
}

PositioningEvaluation evaluate_positioning(const std::vector<PositioningReading>& readings) {
  std::vector<PositioningReading> sorted = readings;
  // Stable: the sums do not depend on how equal targets are ordered.
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const PositioningReading& a, const PositioningReading& b) { return a.target < b.target; });
  PositioningEvaluation result;
  std::array<std::vector<double>, 2> values;
  for (std::size_t i = 0; i < sorted.size();) {
    PositioningTarget target;
    target.position = sorted[i].target;
    values[0].clear();
    values[1].clear();
    for (; i < sorted.size() && sorted[i].target == target.position; ++i) {
      values[static_cast<std::size_t>(sorted[i].direction)].push_back(sorted[i].deviation);
    }
    evaluate_target(values, target);
    for (const std::size_t runs : target.runs) {
      if (runs == 0) continue;
      result.fewest_runs = result.fewest_runs == 0 ? runs : std::min(result.fewest_runs, runs);
      result.most_runs = std::max(result.most_runs, runs);
    }
    result.targets.push_back(target);
  }
  result.accuracy = span_of(result.targets, true, true, 2);
  result.systematic = span_of(result.targets, true, true, 0);
  for (const std::size_t k : {0U, 1U}) {
    result.unidirectional_accuracy[k] = span_of(result.targets, k == 0, k == 1, 2);
    result.unidirectional_systematic[k] = span_of(result.targets, k == 0, k == 1, 0);
  }
  evaluate_reversal(result);
  evaluate_repeatability(result);
  return result;
}

}  // namespace abbe
