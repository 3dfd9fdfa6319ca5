#pragma once

#include <cstddef>
#include <vector>

#include "abbe/instruments/instrument.h"

namespace abbe {

/// From measured - modelled of a reading to residuals of variance 1 and back.
class ReadingWeights {
 public:
  ReadingWeights() = default;
  /// From the covariances of the readings where they have some, else from the standard uncertainties that they state,
  /// else from those of the instrument.
  /// @throws std::invalid_argument if an uncertainty is not above 0, or a covariance not positive definite
  ReadingWeights(const Instrument& instrument, const InstrumentReadings& readings);

  /// Row of W times the components of a reading, value(component).
  template <typename Value>
  double weighted(std::size_t row, std::size_t reading, const Value& value) const {
    if (whitening_.empty()) return weight_[row][reading] * value(row);
    double sum = 0;
    for (std::size_t column = 0; column <= row; ++column) {
      sum += whitening_[lower(row, column)][reading] * value(column);
    }
    return sum;
  }
  /// From residuals of one reading to its deviations, mm or rad.
  void unweight(std::size_t reading, double* components) const;

 private:
  static std::size_t lower(std::size_t row, std::size_t column) { return row * (row + 1) / 2 + column; }
  void take_uncertainties(const Instrument& instrument, const InstrumentReadings& readings);
  void take_covariances(const InstrumentReadings& readings);

  std::size_t rows_ = 0;
  std::vector<std::vector<double>> weight_;  ///< [rows][count] 1 / standard uncertainty; none with covariances
  /// [rows (rows + 1) / 2][count] or empty: lower triangle, row by row, of W with W'W the inverse of the covariance.
  std::vector<std::vector<double>> whitening_;
};

}  // namespace abbe
