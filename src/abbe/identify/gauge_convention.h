#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// A linear functional of the estimates that a convention sets to a value.
struct GaugeCandidate {
  std::string words;           ///< the equation: "EXZ is zero at its reference position 0 mm"
  std::string quantity;        ///< the quantity: "constant of EXZ"
  Eigen::VectorXd functional;  ///< [p]
  double value = 0;            ///< mm or rad
  bool exchangeable = false;   ///< of location errors, the tool offset and the set-up: see GaugeOrder
  bool of_location = false;    ///< of location errors: waits where another of them fixes the same direction better
};

/// Candidates in the order in which they are to be used:
///  1. linear axes: every error motion is zero at its reference position (0 if in range, else the nearest end);
///  2. rotary axes: ECC-like (about the own axis) zero at the reference position, the five others zero in the mean over
///  the turn;
///  3. rotary axes: the once-per-turn parts of radial and tilt motion that turn with the axis, and those that turn
///     against it, are zero (axis average line; ISO 230-7:2015, 3.2);
///  4. linear axes: the slopes of straightness, of positioning and of angular motions along the axis are zero
///  (reference
///     straight line by least squares; ISO 230-1:2012, 3.4);
///  5. location errors, in chain order;
///  6. the tool offset error;
///  7. set-up unknowns keep their start values.
/// Functionals of error motions are integrals over the range of the axis, exact for polynomials and Fourier terms.
/// @param start  [p]
std::vector<GaugeCandidate> gauge_candidates(const Problem& problem, const Eigen::VectorXd& start);

}  // namespace abbe
