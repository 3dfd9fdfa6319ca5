#include "abbe/verify/evaluations/diagonals.h"

namespace abbe {
namespace {

template <typename FigureOf>
LargestFigure largest(const std::vector<DiagonalEvaluation>& diagonals, FigureOf&& figure_of) {
  LargestFigure result;
  result.figure = EvaluatedFigure::without(FigureStatus::no_readings);
  for (std::size_t i = 0; i < diagonals.size(); ++i) {
    const EvaluatedFigure figure = figure_of(diagonals[i].positioning);
    if (!figure.is_evaluated()) return {figure, i};
    if (i == 0 || figure.value > result.figure.value) result = {figure, i};
  }
  return result;
}

}  // namespace

DiagonalsEvaluation evaluate_diagonals(const std::vector<DiagonalReadings>& diagonals) {
  DiagonalsEvaluation result;
  for (const DiagonalReadings& diagonal : diagonals) {
    result.diagonals.push_back({diagonal.name, evaluate_positioning(diagonal.readings)});
  }
  const auto& all = result.diagonals;
  result.systematic = largest(all, [](const PositioningEvaluation& e) { return e.systematic.figure; });
  result.reversal = largest(all, [](const PositioningEvaluation& e) { return e.reversal; });
  result.repeatability = largest(all, [](const PositioningEvaluation& e) { return e.repeatability.figure; });
  result.accuracy = largest(all, [](const PositioningEvaluation& e) { return e.accuracy.figure; });
  return result;
}

}  // namespace abbe
