#include "abbe/instruments/reading_weights.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <optional>
#include <stdexcept>

#include "abbe/instruments/reading_covariance.h"

namespace abbe {

ReadingWeights::ReadingWeights(const Instrument& instrument, const InstrumentReadings& readings)
    : rows_(instrument.components().size()) {
  if (readings.covariance.empty()) {
    take_uncertainties(instrument, readings);
  } else {
    take_covariances(readings);
  }
}

void ReadingWeights::take_uncertainties(const Instrument& instrument, const InstrumentReadings& readings) {
  weight_.assign(rows_, std::vector<double>(readings.count()));
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const double u = readings.uncertainty.empty() ? instrument.standard_uncertainty(readings, k, row)
                                                    : readings.uncertainty[row][k];
      if (!(u > 0)) throw std::invalid_argument(instrument.name() + ": standard uncertainty not above 0");
      weight_[row][k] = 1 / u;
    }
  }
}

void ReadingWeights::take_covariances(const InstrumentReadings& readings) {
  whitening_.assign(rows_ * (rows_ + 1) / 2, std::vector<double>(readings.count()));
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const std::optional<Eigen::MatrixXd> factor = inverse_covariance_factor(covariance_of(readings, rows_, k));
    if (!factor) {
      throw std::invalid_argument(fmt::format("reading {}: its covariance is not positive definite", k));
    }
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column <= row; ++column) {
        whitening_[lower(row, column)][k] =
            (*factor)(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      }
    }
  }
}

void ReadingWeights::unweight(std::size_t reading, double* components) const {
  for (std::size_t row = 0; row < rows_; ++row) {
    if (whitening_.empty()) {
      components[row] /= weight_[row][reading];
      continue;
    }
    for (std::size_t column = 0; column < row; ++column) {
      components[row] -= whitening_[lower(row, column)][reading] * components[column];
    }
    components[row] /= whitening_[lower(row, row)][reading];
  }
}

}  // namespace abbe
