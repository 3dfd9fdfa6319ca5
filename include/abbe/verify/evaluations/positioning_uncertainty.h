#pragma once

#include <array>
#include <string>
#include <vector>

#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// Contributions to the uncertainty of the measurement of an axis; zero unless stated. mm, rad and K.
///
/// A "range" is the full width of the interval in which a quantity lies with equal probability: its expanded
/// uncertainty (k = 2) is range / sqrt(3), the 0.6 range of the simplified equations of ISO/TR 230-9.
struct PositioningUncertaintyInput {
  double instrument = 0;                 ///< expanded, k = 2, whatever the distance; mm or rad
  double instrument_per_length = 0;      ///< expanded, k = 2, of a linear axis: mm per mm, added to it
  double setup = 0;                      ///< expanded, k = 2: mounting, coupling of a rotary encoder; mm or rad
  double misalignment_range = 0;         ///< mm across the travel: largest offset of the beam over the measured travel
  double machine_expansion = 0;          ///< coefficient of thermal expansion, 1/K
  double machine_temperature_range = 0;  ///< of the machine's temperature reading, K
  double machine_expansion_range = 0;    ///< of the coefficient, 1/K
  double device_expansion = 0;           ///< of the scale of the instrument, 1/K; 0 for a laser in compensated air
  double device_temperature_range = 0;   ///< K
  double device_expansion_range = 0;     ///< 1/K
  double temperature_from_20_C = 0;      ///< largest difference from 20 degrees Celsius during the test, K
  double environmental_variation =
      0;  ///< E_VE: range of the indication with the axis at rest, as long as a test; mm or rad

  /// Nothing was stated: there is no uncertainty to report.
  bool is_empty() const;
};

/// Expanded uncertainties, k = 2, mm or rad; of A, E, R, ... of both and of one direction.
struct PositioningUncertainty {
  struct Contribution {
    std::string name;     ///< "misalignment"
    double expanded = 0;  ///< k = 2 over the measured travel; of the environment: of one reading
  };
  std::vector<Contribution> contributions;  ///< those that are not zero
  double accuracy = 0;                      ///< U(A), U(A+), U(A-)
  double systematic = 0;                    ///< U(E), U(E+), U(E-)
  double mean_bidirectional = 0;            ///< U(M)
  double repeatability = 0;                 ///< U(R)
  double unidirectional_repeatability = 0;  ///< U(R+), U(R-)
  double reversal = 0;                      ///< U(B), and not less than that of the mean reversal
};

/// Propagates the contributions to the figures: derived in docs/evaluate.md from the definitions of the figures. What
/// grows with the length acts over the whole span of the targets, and so on all spans of means; what varies from
/// reading to reading is averaged over the fewest runs of the evaluation and widens s.
/// @param rotary  the entries that grow with a length do not count
PositioningUncertainty positioning_uncertainty(const PositioningUncertaintyInput& input,
                                               const PositioningEvaluation& evaluation, bool rotary);

}  // namespace abbe
