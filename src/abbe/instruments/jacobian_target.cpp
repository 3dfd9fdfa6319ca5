#include "abbe/instruments/jacobian_target.h"

namespace abbe {
namespace {

void spread_column(const double* from, std::span<const std::uint16_t> at, double* to) {
  for (std::size_t k = 0; k < at.size(); ++k) to[at[k]] = from[k];
}

}  // namespace

void differentiate_readings(const ChainPlan& plan, const PositionArrays& positions, const ConstPointArrays& start,
                            const ConstPointArrays& seen, std::span<const RowArrays> rows,
                            std::span<const std::size_t> parameters, const JacobianTarget& target,
                            const PointArrays* by_start, double* by_position, const ReversalShift& reversal,
                            const PoseList& poses, const BlockMembers& members) {
  if (target.form == nullptr) {
    plan.differentiate(positions, start, seen, rows, parameters, target.columns, target.stride, by_start, by_position);
  } else {
    plan.differentiate_factored(positions, seen, rows, parameters, *target.form, target.columns, target.stride,
                                target.bases, target.basis_stride, by_start, by_position);
  }
  if (by_position == nullptr) return;
  const std::size_t n = members.at.size();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const std::size_t axis = reversal.axis_of(parameters[j]);
    if (axis == ReversalShift::npos) continue;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (std::size_t k = 0; k < n; ++k) {
        const double half_approach = 0.5 * poses.approach[axis][members.first + members.at[k]];
        target.column(j)[row * n + k] = half_approach * by_position[(axis * rows.size() + row) * n + k];
      }
    }
  }
}

void spread_derivatives(const JacobianTarget& compact, std::size_t columns, std::size_t rows,
                        const BlockMembers& members, const JacobianTarget& wide) {
  const std::size_t n = members.at.size();
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      spread_column(compact.columns + column * compact.stride + row * n, members.at,
                    wide.columns + column * wide.stride + row * members.count);
    }
  }
  for (std::size_t basis = 0; basis < compact.bases_written(); ++basis) {
    spread_column(compact.bases + basis * compact.basis_stride, members.at, wide.bases + basis * wide.basis_stride);
  }
}

FactoredColumns factors_with_setup(const ErrorSet& errors, std::span<const std::size_t> machine_parameters,
                                   std::span<const std::size_t> setup_parameters) {
  FactoredColumns form = factored_columns(errors, machine_parameters);
  for (std::size_t i = 0; i < setup_parameters.size(); ++i) form.add_whole_column();
  return form;
}

}  // namespace abbe
