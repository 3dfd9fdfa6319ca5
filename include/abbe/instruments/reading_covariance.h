#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "abbe/instruments/instrument.h"

namespace abbe {

/// Place of an element in InstrumentReadings::covariance: variances first, then the elements above the diagonal, row by
/// row.
inline std::size_t covariance_place(std::size_t components, std::size_t row, std::size_t column) {
  if (row == column) return row;
  if (row > column) return covariance_place(components, column, row);
  return components + row * components - row * (row + 1) / 2 + column - row - 1;
}

/// Covariance of one reading whose data state it, [components, components].
Eigen::MatrixXd covariance_of(const InstrumentReadings& readings, std::size_t components, std::size_t reading);

/// Lower triangular W with W'W = inverse of the covariance. Nothing if a variance is not above zero or the Cholesky
/// factor of the correlation matrix has a pivot below 1e-7: scaled, so that mm^2 beside rad^2 do not decide.
std::optional<Eigen::MatrixXd> inverse_covariance_factor(const Eigen::MatrixXd& covariance);

}  // namespace abbe
