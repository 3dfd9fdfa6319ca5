#include "abbe/study/evaluations/circular_correction.h"

#include <cmath>

#include "abbe/errors/expansion.h"

namespace abbe {
namespace {

/// Standard uncertainty of the correction of a radius, mm.
double radius_uncertainty(const StatedExpansion& stated, double radius) {
  const std::vector<PositioningReading> at_radius = {{radius, 0, ApproachDirection::positive}};
  double squares = 0;
  for (const ExpansionContribution& one : expansion_contributions(at_radius, stated.expansion, {stated.at})) {
    squares += one.standard[0] * one.standard[0];
  }
  return std::sqrt(squares);
}

}  // namespace

std::optional<CorrectedCircle> corrected_circle(const CircularTest& test) {
  const std::optional<StatedExpansion> stated = stated_expansion(test.expansion);
  if (!stated) return std::nullopt;
  const DifferentialExpansion& expansion = stated->expansion;
  CorrectedCircle result;
  CircularCorrection& correction = result.correction;
  correction.expansion = expansion;
  correction.has_machine = stated->has_machine;
  correction.has_instrument = stated->has_instrument;
  correction.at = stated->at;
  correction.uncertainty = radius_uncertainty(*stated, test.nominal_radius);
  // The machine drives a circle that is too large, and the instrument reads too little of it.
  const double driven = 1 + expansion.machine.coefficient * (stated->at.machine - kReferenceTemperature);
  const double read = 1 + expansion.instrument.coefficient * (stated->at.instrument - kReferenceTemperature);
  correction.factor = read / driven;
  result.paths = test.readings.paths;
  for (CircularReadings& path : result.paths) {
    for (double& radius : path.radius) radius *= correction.factor;
  }
  return result;
}

}  // namespace abbe
