#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

/// Columns of a Jacobian of readings as products of two factors, many fewer than columns.
///
/// The derivative of a reading by a coefficient of an error motion is that by the component of the motion (EX .. EC of
/// the axis) times the basis function of the coefficient. The first is the carrier: one value per row and reading. The
/// second is the same for all rows of a reading and for all components of the axis. So
///
///     column(row, reading) = carrier(row, reading) * basis(reading)
///
/// All other columns are carriers of their own with the basis function 1.
struct FactoredColumns {
  static constexpr std::size_t kOne = static_cast<std::size_t>(-1);  ///< the basis function 1, which has no number

  struct Column {
    std::size_t carrier = 0;
    std::size_t basis = kOne;
    bool operator==(const Column&) const = default;
  };
  std::vector<Column> columns;
  std::vector<std::size_t> carrier_first;  ///< per carrier: the first column that has it
  std::vector<std::size_t> basis_first;    ///< per basis function: the first column that has it

  std::size_t carriers() const { return carrier_first.size(); }
  std::size_t bases() const { return basis_first.size(); }
  /// Appends a column that is its own carrier.
  void add_whole_column();
};

/// Factors of the columns of some parameters of the errors.
///
/// Equal functions of one axis and one state are one basis function, whatever the number of functions of the motions;
/// those of table_monotone are of one motion each, because they depend on its coefficients. The factor of a state
/// belongs to the basis function.
/// @param parameters  indices into ErrorSet::parameters(), in any order
FactoredColumns factored_columns(const ErrorSet& errors, std::span<const std::size_t> parameters);

}  // namespace abbe
