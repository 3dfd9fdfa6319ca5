#include "abbe/verify/thermal/length_temperature.h"

#include <cmath>

namespace abbe {

LengthUncertainty length_uncertainty(const LengthTemperatureInput& input) {
  LengthUncertainty result;
  double squares = 0;
  const auto add = [&](const char* name, double standard) {
    if (standard == 0) return;
    result.contributions.push_back({name, standard});
    squares += standard * standard;
  };
  const double workpiece = input.workpiece_temperature - kReferenceTemperature;
  const double scale = input.scale_temperature - kReferenceTemperature;
  result.differential_expansion =
      input.length * (input.workpiece_expansion * workpiece - input.scale_expansion * scale);
  add("expansion of the workpiece", input.length * input.workpiece_expansion_uncertainty *
                                        std::hypot(workpiece, input.workpiece_temperature_uncertainty));
  add("temperature of the workpiece",
      input.length * std::abs(input.workpiece_expansion) * input.workpiece_temperature_uncertainty);
  add("expansion of the scale",
      input.length * input.scale_expansion_uncertainty * std::hypot(scale, input.scale_temperature_uncertainty));
  add("temperature of the scale", input.length * std::abs(input.scale_expansion) * input.scale_temperature_uncertainty);
  result.differential_uncertainty = std::sqrt(squares);
  add("environment (ETVE)", input.environmental_variation / std::sqrt(12.0));
  result.combined = std::sqrt(squares);
  return result;
}

}  // namespace abbe
