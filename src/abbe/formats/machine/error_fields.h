#pragma once

// Internal to formats: fields that errors files and studies share.
#include <string>

#include "abbe/errors/error_set.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/machine/machine.h"

namespace abbe {

inline constexpr int kLargestOrder = 1000;

inline Quantity error_quantity(Component component) {
  return is_rotation(component) ? Quantity::angle : Quantity::length;
}
inline Quantity axis_quantity(const Axis& axis) {
  return axis.kind == AxisKind::linear ? Quantity::length : Quantity::angle;
}
inline bool is_table(BasisKind kind) { return kind == BasisKind::table_linear || kind == BasisKind::table_monotone; }

/// "C, X, Z"
std::string axis_names(const Machine& machine);

/// Keys `basis` and `periodic`.
Basis read_basis_kind(TomlTable& table);
/// Smallest sensible order of a basis; of a table to be identified the smallest number of intervals.
int smallest_order(const Basis& basis);
/// Keys `from`, `to`, `period`; the travel of the axis and a whole turn if they are not there.
void read_basis_range(TomlTable& table, const Machine& machine, std::size_t axis, Basis& basis);

/// Basis of a motion in TOML, from `basis` to `period`, without nodes.
std::string basis_text(const Basis& basis, const Axis& axis);

}  // namespace abbe
