#pragma once

#include <cstddef>
#include <vector>

#include "abbe/errors/factored_columns.h"

namespace abbe {

/// Carriers and basis functions whose products are columns of a Jacobian. Some of the products may not be columns.
struct CarrierGroup {
  std::vector<std::size_t> carriers;  ///< ascending; FactoredColumns::carriers(): the residuals
  std::vector<std::size_t> bases;     ///< ascending; FactoredColumns::bases(): the basis function 1
};

/// Groups of all columns and of the residuals, joined so that all products together take the fewest operations.
std::vector<CarrierGroup> carrier_groups(const FactoredColumns& form, std::size_t rows);

/// Operations per reading that all products of columns in these groups take, with what their evaluation writes.
double operations_of_groups(const FactoredColumns& form, const std::vector<CarrierGroup>& groups, std::size_t rows);

/// The same for whole columns.
double operations_of_columns(std::size_t columns, std::size_t rows);

}  // namespace abbe
