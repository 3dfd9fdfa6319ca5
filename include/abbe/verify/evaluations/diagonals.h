#pragma once

#include <string>
#include <vector>

#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// Positioning along one diagonal of the working space; target positions are distances along it, mm.
struct DiagonalReadings {
  std::string name;  ///< as in the file: "+X+Y+Z", "PPN"
  std::vector<PositioningReading> readings;
};

struct DiagonalEvaluation {
  std::string name;
  PositioningEvaluation positioning;
};

/// A figure over all diagonals: the largest of theirs, and whose it is.
struct LargestFigure {
  EvaluatedFigure figure;
  std::size_t diagonal = 0;  ///< index into `diagonals`
};

/// The figures of a diagonal displacement test (ISO 230-6), mm.
struct DiagonalsEvaluation {
  std::vector<DiagonalEvaluation> diagonals;  ///< each by the definitions of ISO 230-2, in the order given
  LargestFigure systematic;                   ///< E_d: largest bidirectional systematic deviation E of a diagonal
  LargestFigure reversal;                     ///< B_d: largest reversal B
  LargestFigure repeatability;                ///< R_d: largest bidirectional repeatability R
  LargestFigure accuracy;                     ///< A_d: largest bidirectional accuracy A
};

/// Evaluates each diagonal as an axis and takes the largest of every figure. If a diagonal lacks a figure, the figure
/// over all has its status: the missing one might have been the largest.
///
/// Four body diagonals, or the two diagonals of a face, belong to one test; fewer give the largest of those measured.
/// Nothing is separated into errors of the axes: displacements along diagonals alone do not determine them.
/// Source: ISO 230-6:2002; docs/evaluate.md.
DiagonalsEvaluation evaluate_diagonals(const std::vector<DiagonalReadings>& diagonals);

}  // namespace abbe
