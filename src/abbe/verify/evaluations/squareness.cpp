#include "abbe/verify/evaluations/squareness.h"

#include <cmath>

namespace abbe {

Squareness squareness(const SquarenessLine& first, const SquarenessLine& second, const SquarenessOptions& options) {
  Squareness result;
  result.lines[0] = straightness(first.positions, first.deviations, options.reference, options.reading_uncertainty);
  result.lines[1] = straightness(second.positions, second.deviations, options.reference, options.reading_uncertainty);
  for (const Straightness& line : result.lines) {
    result.status = line.status;
    if (line.status != StraightnessStatus::done) return result;
  }
  // The arctangents make it exact for lines that are far from square; they cost nothing.
  result.value = options.artefact - std::atan(result.lines[0].line.slope) - std::atan(result.lines[1].line.slope);
  result.uncertainty =
      std::hypot(result.lines[0].slope_uncertainty, result.lines[1].slope_uncertainty, options.artefact_uncertainty);
  return result;
}

}  // namespace abbe
