#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/verify/evaluations/evaluated_figure.h"

namespace abbe {

/// From which side a target position was approached; the standard writes arrows up and down.
enum class ApproachDirection : std::uint8_t { positive = 0, negative = 1 };

/// One approach to a target position.
struct PositioningReading {
  double target = 0;     ///< commanded position; mm or rad
  double deviation = 0;  ///< actual minus target; mm or rad
  ApproachDirection direction = ApproachDirection::positive;
};

/// Results at one target position; the index of pairs is the direction of approach.
struct PositioningTarget {
  double position = 0;                           ///< mm or rad
  std::array<std::size_t, 2> runs{};             ///< n: readings from each side
  std::array<double, 2> mean{};                  ///< mean unidirectional positioning deviation; with runs > 0
  std::array<double, 2> deviation{};             ///< s, estimator of the standard uncertainty of it; with runs > 1
  std::array<EvaluatedFigure, 2> repeatability;  ///< R+, R- = 4 s
  EvaluatedFigure reversal;                      ///< B = mean+ - mean-, with its sign
  EvaluatedFigure mean_bidirectional;            ///< (mean+ + mean-) / 2
  EvaluatedFigure bidirectional_repeatability;   ///< R = max(2 s+ + 2 s- + |B|, R+, R-)
};

/// The figures of ISO 230-2 of one axis, mm or rad. A span over the travel that comes from two positions says which, by
/// index into `targets`, so that it can be drawn.
struct PositioningEvaluation {
  struct Span {
    EvaluatedFigure figure;
    std::size_t low_at = 0, high_at = 0;  ///< targets of the smallest and of the largest value
    double low = 0, high = 0;             ///< figure.value = high - low
  };
  std::vector<PositioningTarget> targets;  ///< ascending

  Span accuracy;                                  ///< A
  std::array<Span, 2> unidirectional_accuracy;    ///< A+, A-
  Span systematic;                                ///< E: over both directions
  std::array<Span, 2> unidirectional_systematic;  ///< E+, E-
  Span mean_bidirectional;                        ///< M
  Span repeatability;                             ///< R: at one target, from mean - 2 s to mean + 2 s of its sides
  std::array<EvaluatedFigure, 2> unidirectional_repeatability;  ///< R+, R-
  EvaluatedFigure reversal;                                     ///< B = max |B_i|
  std::size_t reversal_at = 0;
  EvaluatedFigure mean_reversal;  ///< mean of B_i, with its sign

  std::size_t fewest_runs = 0, most_runs = 0;  ///< n over all targets and directions that were read
  /// Largest minus smallest target, mm or rad.
  double span() const { return targets.empty() ? 0 : targets.back().position - targets.front().position; }
};

/// Evaluates positioning readings of a linear or rotary axis; targets are the same position if they are equal.
///
/// A figure is given only if every target position has what it needs: s needs two readings, B and the bidirectional
/// figures both directions, spans two positions. Else its status says what is lacking. The numbers of readings may
/// differ between positions; the standard asks for the same everywhere (`fewest_runs`, `most_runs` tell).
/// @param readings  in any order, finite
/// @throws nothing
/// Source: ISO 230-2:2014, terms and definitions; docs/evaluate.md.
PositioningEvaluation evaluate_positioning(const std::vector<PositioningReading>& readings);

}  // namespace abbe
