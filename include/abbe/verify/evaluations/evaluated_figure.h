#pragma once

#include <string_view>

namespace abbe {

/// Whether the readings suffice for a figure of an evaluation, and what they lack.
enum class FigureStatus {
  not_evaluated,          ///< nothing was computed
  evaluated,              ///< the value is there
  no_readings,            ///< there is nothing to evaluate
  needs_two_runs,         ///< at least one position was read once only: no standard deviation
  needs_both_directions,  ///< at least one position was approached from one side only: no reversal
  needs_this_direction,   ///< at least one position was not approached from that side
  needs_two_positions,    ///< a span over the travel needs two positions
};

/// A figure of an evaluation with its status; the value counts only if the status is `evaluated`.
struct EvaluatedFigure {
  double value = 0;
  FigureStatus status = FigureStatus::not_evaluated;

  bool is_evaluated() const { return status == FigureStatus::evaluated; }
  static EvaluatedFigure of(double value) { return {value, FigureStatus::evaluated}; }
  static EvaluatedFigure without(FigureStatus status) { return {0, status}; }
};

/// In words, for people: "a position was read once only: no standard deviation".
std::string_view figure_status_words(FigureStatus status);

}  // namespace abbe
