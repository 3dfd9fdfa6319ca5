#include "abbe/errors/stated_uncertainty.h"

namespace abbe {

std::vector<double> stated_uncertainties(const ErrorSet& errors) {
  std::vector<double> uncertainty;
  uncertainty.reserve(errors.parameter_count());
  for (const ErrorMotion& motion : errors.motions) {
    for (std::size_t i = 0; i < motion.coefficients.size(); ++i) {
      uncertainty.push_back(motion.standard_uncertainty.empty() ? 0.0 : motion.standard_uncertainty[i]);
    }
  }
  for (const LocationError& location : errors.locations) uncertainty.push_back(location.standard_uncertainty);
  for (const Reversal& reversal : errors.reversals) uncertainty.push_back(reversal.standard_uncertainty);
  uncertainty.resize(errors.parameter_count(), 0.0);
  return uncertainty;
}

}  // namespace abbe
