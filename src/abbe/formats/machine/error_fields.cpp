#include "abbe/formats/machine/error_fields.h"

#include <fmt/format.h>

#include <numbers>

#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

constexpr double kSmallestRange = 1e-9;  // mm or rad

std::string position_line(const char* base, double value, const Axis& axis) {
  if (axis.kind == AxisKind::rotary) return toml_angles(base, {value}, true);
  return fmt::format("{}_mm = {}\n", base, shortest_text(value));
}

}  // namespace

std::string axis_names(const Machine& machine) {
  std::string names;
  for (const Axis& axis : machine.axes) names += (names.empty() ? "" : ", ") + axis.name;
  return names;
}

Basis read_basis_kind(TomlTable& table) {
  Basis basis;
  basis.kind = static_cast<BasisKind>(table.word(
      "basis", {"monomial", "legendre", "chebyshev", "fourier", "bspline", "table-linear", "table-monotone"}));
  if (basis.kind == BasisKind::bspline || basis.kind == BasisKind::table_linear) {
    basis.periodic = table.boolean_or("periodic", false);
  }
  return basis;
}

int smallest_order(const Basis& basis) {
  if (is_table(basis.kind)) return basis.periodic ? 3 : 1;
  if (basis.kind != BasisKind::bspline) return 0;
  return basis.periodic ? 4 : 1;
}

void read_basis_range(TomlTable& table, const Machine& machine, std::size_t axis_index, Basis& basis) {
  const Axis& axis = machine.axes[axis_index];
  const Quantity quantity = axis_quantity(axis);
  if (basis.periodic || basis.kind == BasisKind::fourier) {
    if (axis.kind == AxisKind::linear) {
      basis.period = table.number("period", quantity);
    } else {
      basis.period = table.number_or("period", quantity, 2 * std::numbers::pi);
    }
    if (basis.period < kSmallestRange) {
      table.fail_quantity("period", quantity, "is not above zero", "the length of one period");
    }
  }
  if (is_table(basis.kind)) return;
  const PositionLimits travel = position_limits(machine, axis_index);
  basis.from = table.number_or("from", quantity, travel.from);
  basis.to = table.number_or("to", quantity, travel.to);
  if (basis.to - basis.from < kSmallestRange) {
    table.fail_quantity(table.has("to", quantity) ? "to" : "from", quantity, "`to` is not above `from`",
                        "the range of positions in which the errors are valid");
  }
}

std::string basis_text(const Basis& basis, const Axis& axis) {
  std::string text = fmt::format("basis = \"{}\"\n", basis_kind_name(basis.kind));
  if (basis.periodic) text += "periodic = true\n";
  if (!is_table(basis.kind)) {
    text += fmt::format("order = {}\n", basis.order);
    text += position_line("from", basis.from, axis) + position_line("to", basis.to, axis);
  }
  if (basis.periodic || basis.kind == BasisKind::fourier) text += position_line("period", basis.period, axis);
  return text;
}

}  // namespace abbe
