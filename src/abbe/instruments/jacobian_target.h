#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/errors/reversal.h"
#include "abbe/instruments/observations.h"

namespace abbe {

/// Where an evaluation writes derivatives (per mm or rad): whole columns, or the factors of columns.
struct JacobianTarget {
  double* columns = nullptr;  ///< whole ones or carriers, columns[column * stride + row * count + k]; null: not wanted
  std::size_t stride = 0;
  const FactoredColumns* form = nullptr;  ///< null: whole columns
  double* bases = nullptr;                ///< bases[basis * basis_stride + k]
  std::size_t basis_stride = 0;

  bool wanted() const { return columns != nullptr; }
  /// Number of the column that holds what belongs to column j of the Jacobian.
  std::size_t place(std::size_t j) const { return form == nullptr ? j : form->columns[j].carrier; }
  double* column(std::size_t j) const { return columns + place(j) * stride; }
  /// Number of columns that are written for a Jacobian of that many columns.
  std::size_t written(std::size_t jacobian_columns) const {
    return form == nullptr ? jacobian_columns : form->carriers();
  }
  std::size_t bases_written() const { return form == nullptr ? 0 : form->bases(); }

  static JacobianTarget of(double* jacobian, std::size_t stride) { return {jacobian, stride, nullptr, nullptr, 0}; }
  static JacobianTarget of(const JacobianFactors& factors) {
    return {factors.carriers, factors.stride, &factors.form, factors.bases, factors.basis_stride};
  }
};

/// Readings of a block that are evaluated together.
struct BlockMembers {
  std::size_t first = 0;              ///< first reading of the block
  std::size_t count = 0;              ///< readings of the block
  std::span<const std::uint16_t> at;  ///< their places in the block
};

/// Derivatives of these readings by machine parameters, those by reversal errors included.
/// @param target       of these readings alone
/// @param by_start     as ChainPlan::differentiate()
/// @param by_position  [axes * rows * members] memory; null where no reversal acts
void differentiate_readings(const ChainPlan& plan, const PositionArrays& positions, const ConstPointArrays& start,
                            const ConstPointArrays& seen, std::span<const RowArrays> rows,
                            std::span<const std::size_t> parameters, const JacobianTarget& target,
                            const PointArrays* by_start, double* by_position, const ReversalShift& reversal,
                            const PoseList& poses, const BlockMembers& members);

/// Copies derivatives of some readings of a block to their places in the block.
/// @param columns  of `compact`, from the first one
void spread_derivatives(const JacobianTarget& compact, std::size_t columns, std::size_t rows,
                        const BlockMembers& members, const JacobianTarget& wide);

/// Factors of the columns of machine parameters, then those of unknowns of a set-up, which have none.
FactoredColumns factors_with_setup(const ErrorSet& errors, std::span<const std::size_t> machine_parameters,
                                   std::span<const std::size_t> setup_parameters);

}  // namespace abbe
