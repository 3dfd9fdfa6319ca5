#pragma once

#include <vector>

#include "abbe/errors/expansion.h"

namespace abbe {

/// What is known of the temperature of a measured length. Uncertainties are standard ones; 0: none.
struct LengthTemperatureInput {
  double length = 0;                                     ///< mm; above 0
  double workpiece_expansion = 0;                        ///< coefficient of thermal expansion, 1/K
  double workpiece_expansion_uncertainty = 0;            ///< 1/K
  double workpiece_temperature = kReferenceTemperature;  ///< mean, degC
  double workpiece_temperature_uncertainty = 0;          ///< K
  double scale_expansion = 0;                            ///< of the scale that measures it, 1/K
  double scale_expansion_uncertainty = 0;                ///< 1/K
  double scale_temperature = kReferenceTemperature;      ///< degC
  double scale_temperature_uncertainty = 0;              ///< K
  double environmental_variation = 0;  ///< ETVE: range of the indication over the time of a measurement, mm
};

/// A contribution to the uncertainty of a length.
struct LengthContribution {
  const char* name;
  double standard = 0;  ///< mm
};

struct LengthUncertainty {
  /// Nominal differential expansion L (a_w (T_w - 20) - a_s (T_s - 20)), mm: the workpiece at its temperature is longer
  /// by it, as read on the scale, than it would be with both at 20 degC.
  double differential_expansion = 0;
  double differential_uncertainty = 0;            ///< standard, without the environment, mm
  std::vector<LengthContribution> contributions;  ///< those that are not zero
  double combined = 0;                            ///< standard, of a length corrected for that expansion, mm
};

/// Uncertainty of a measured length by temperature.
///
/// Expansion and temperature are independent, so that the variance of a t with t = T - 20 is exactly a^2 u^2(T) +
/// t^2 u^2(a) + u^2(a) u^2(T); the last part is what remains at 20 degC. The environment is a rectangular distribution
/// of width ETVE. Source: JCGM 100:2008 (GUM), H.1; Swyt, J. Res. Natl. Inst. Stand. Technol. 99 (1994) 31; see
/// docs/evaluate-thermal.md.
LengthUncertainty length_uncertainty(const LengthTemperatureInput& input);

}  // namespace abbe
