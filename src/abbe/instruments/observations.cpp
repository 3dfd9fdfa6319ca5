#include "abbe/instruments/observations.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/instruments/further_readings.h"

namespace abbe {

std::vector<FurtherReadings> Observations::further_readings(const Machine&, const ErrorSet&) const { return {}; }

std::optional<FactoredColumns> Observations::column_factors(std::span<const std::size_t>,
                                                            std::span<const std::size_t>) const {
  return std::nullopt;
}

void Observations::evaluate_factored(std::size_t, std::size_t, std::span<const std::size_t>,
                                     std::span<const std::size_t>, double*, const JacobianFactors&) const {
  throw std::logic_error(name() + ": the Jacobian has no factors");
}

void Observations::deviations(std::size_t first, std::size_t count, double* out) const {
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double> apart = deviation(first + k);
    for (std::size_t row = 0; row < apart.size(); ++row) out[row * count + k] = apart[row];
  }
}

std::optional<double> Observations::length_of_deviation(std::size_t reading) const {
  const std::vector<double> apart = deviation(reading);
  double square = -1;
  for (std::size_t row = 0; row < apart.size(); ++row) {
    if (!components()[row].is_angle) square = std::max(square, 0.0) + apart[row] * apart[row];
  }
  if (square < 0) return std::nullopt;
  return std::sqrt(square);
}

}  // namespace abbe
