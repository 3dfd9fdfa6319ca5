#include "abbe/controls/line_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/line_tables.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/errors/reversal.h"
#include "abbe/formats/controls/table_linuxcnc.h"
#include "abbe/formats/controls/table_siemens.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kDecimalStep_mm = 1e-3;
constexpr double kDecimalStep_rad = 1e-3 * kDegree;

std::string table_name(const Machine& machine, const AxisTable& table) {
  const std::string& input = machine.axes[table.input].name;
  return table.input == table.output ? input : input + " for " + machine.axes[table.output].name;
}

/// Every k-th position within the travel, so that long tables are looked at in at most some forty places.
std::vector<std::size_t> some_of(const std::vector<double>& positions, const KnownTravel& travel) {
  std::vector<std::size_t> chosen;
  const std::size_t stride = positions.size() / 40 + 1;
  for (std::size_t k = 0; k < positions.size(); k += stride) {
    if (positions[k] >= travel.from - 1e-9 && positions[k] <= travel.to + 1e-9) chosen.push_back(k);
  }
  return chosen;
}

WrittenTable summary_of(const Machine& machine, const ErrorSet& known, const AxisTable& table,
                        double interpolation_error, bool within, const std::vector<double>& reference, bool cross) {
  WrittenTable summary;
  summary.name = table_name(machine, table);
  summary.nodes = table.positions.size();
  summary.step = table.positions.size() > 1 ? table.positions[1] - table.positions[0] : 0;
  summary.step_is_angle = machine.axes[table.input].kind == AxisKind::rotary;
  summary.is_angle = machine.axes[table.output].kind == AxisKind::rotary;
  summary.interpolation_error = interpolation_error;
  summary.within = within;
  for (std::size_t k = 0; k < table.positions.size(); ++k) {
    const double larger = std::max(std::abs(table.forward[k]), std::abs(table.reverse[k]));
    if (larger < summary.largest) continue;
    summary.largest = larger;
    summary.largest_at = table.positions[k];
  }
  const bool directions = table.forward != table.reverse;
  const std::vector<std::size_t> chosen = some_of(table.positions, known_travel(machine, known, table.input));
  for (const std::size_t k : chosen) {
    summary.positions.push_back(table.positions[k]);
    summary.corrections.push_back(table.forward[k]);
  }
  for (const std::size_t k : chosen) {
    if (directions) summary.corrections.push_back(table.reverse[k]);
  }
  summary.values = [&machine, reference, cross, directions, input = table.input, output = table.output,
                    positions = summary.positions](const ErrorSet& errors) {
    std::vector<double> values = line_correction(machine, errors, reference, input, output, positions, cross);
    if (!directions) return values;
    const std::size_t count = values.size();
    const double half = 0.5 * reversal_of(errors, input);
    for (std::size_t k = 0; k < count; ++k) {
      values.push_back(values[k] + half);
      values[k] -= half;
    }
    return values;
  };
  return summary;
}

}  // namespace

LineTableOptions line_options(const WriterRequest& request, const TableFormat& format) {
  LineTableOptions options;
  options.reference = request.reference;
  options.axes = request.axes;
  options.cross = format.kind == TableKind::axis_pairs;
  options.directions = format.directions;
  options.tolerance_mm = request.tolerance_mm;
  options.tolerance_rad = request.tolerance_rad;
  options.most_nodes = request.most_nodes > 0 ? std::min(request.most_nodes, format.most_nodes) : format.most_nodes;
  options.nodes = request.nodes > 0 ? std::min(request.nodes, options.most_nodes) : 0;
  options.step_multiple_mm = kDecimalStep_mm;
  options.step_multiple_rad = kDecimalStep_rad;
  // Below the last digit that is written there is nothing to correct.
  options.negligible_mm = 1e-7;
  options.negligible_rad = 1e-9;
  return options;
}

std::vector<AxisTable> wanted_tables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                     const LineTableOptions& options, WrittenTables& made) {
  const LineTables found = line_tables(machine, errors, options);
  std::vector<AxisTable> tables;
  for (std::size_t t = 0; t < found.tables.size(); ++t) {
    WrittenTable summary = summary_of(machine, errors, found.tables[t], found.interpolation_error[t], found.within[t],
                                      request.reference, options.cross);
    if (request.left_out.count(summary.name) != 0) continue;
    made.tables.push_back(std::move(summary));
    tables.push_back(found.tables[t]);
  }
  return tables;
}

std::vector<AxisTable> with_sign(std::vector<AxisTable> tables, bool negate) {
  for (AxisTable& table : tables) {
    for (double& value : table.forward) value = negate ? -value : value;
    for (double& value : table.reverse) value = negate ? -value : value;
  }
  return tables;
}

}  // namespace abbe
