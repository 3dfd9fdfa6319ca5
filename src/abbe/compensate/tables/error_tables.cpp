#include "abbe/compensate/tables/error_tables.h"

#include <algorithm>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/table_nodes.h"

namespace abbe {

ErrorSet errors_of(const ErrorTables& tables) {
  ErrorSet errors;
  for (const ErrorTable& table : tables.tables) {
    for (std::size_t c = 0; c < table.components.size(); ++c) {
      ErrorMotion motion;
      motion.axis = table.axis;
      motion.component = table.components[c];
      motion.basis.from = table.positions.front();
      motion.basis.to = table.positions.back();
      if (table.positions.size() == 1) {
        motion.basis.kind = BasisKind::monomial;
        motion.basis.order = 0;
        motion.basis.to = motion.basis.from + 1;
      } else {
        motion.basis.kind = BasisKind::table_linear;
        motion.basis.nodes = table.positions;
      }
      motion.coefficients = table.values[c];
      errors.motions.push_back(std::move(motion));
    }
  }
  errors.locations = tables.locations;
  return errors;
}

BuiltErrorTables build_error_tables(const Machine& machine, const ErrorSet& errors, const ErrorTableOptions& options) {
  BuiltErrorTables built;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!options.axes.empty() && !options.axes[i]) continue;
    ErrorTable table;
    table.axis = i;
    for (int c = 0; c < kComponentCount; ++c) {
      const auto component = static_cast<Component>(c);
      const bool there = std::any_of(errors.motions.begin(), errors.motions.end(), [&](const ErrorMotion& motion) {
        return motion.axis == i && motion.component == component;
      });
      if (there) table.components.push_back(component);
    }
    if (table.components.empty()) continue;
    const KnownTravel travel = known_travel(machine, errors, i);
    NodeSpacing spacing;
    spacing.from = travel.from;
    spacing.to = travel.to;
    spacing.most = options.most_nodes;
    spacing.step_multiple =
        machine.axes[i].kind == AxisKind::rotary ? options.step_multiple_rad : options.step_multiple_mm;
    spacing.kinks = kinks_of(errors, i);
    for (const Component component : table.components) {
      spacing.tolerance.push_back(is_rotation(component) ? options.tolerance_rad : options.tolerance_mm);
    }
    const TableNodes nodes = choose_nodes(
        [&](std::span<const double> positions, std::vector<std::vector<double>>& values) {
          values.assign(table.components.size(), std::vector<double>(positions.size()));
          for (std::size_t k = 0; k < positions.size(); ++k) {
            const auto all = errors.evaluate(i, positions[k]);
            for (std::size_t c = 0; c < table.components.size(); ++c) {
              values[c][k] = all[static_cast<std::size_t>(table.components[c])];
            }
          }
        },
        spacing);
    table.positions = nodes.positions;
    table.values = nodes.values;
    built.tables.tables.push_back(std::move(table));
    built.interpolation_error.push_back(nodes.error);
  }
  built.tables.locations = errors.locations;
  for (LocationError& location : built.tables.locations) location.standard_uncertainty = 0;
  return built;
}

}  // namespace abbe
