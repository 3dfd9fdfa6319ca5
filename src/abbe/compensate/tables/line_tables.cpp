#include "abbe/compensate/tables/line_tables.h"

#include <algorithm>
#include <cmath>

#include "abbe/compensate/point_correction.h"
#include "abbe/errors/reversal.h"

namespace abbe {
namespace {

/// Corrections of chosen axes along the line on which one axis moves, minus constants.
struct Line {
  const Machine& machine;
  const ErrorSet& errors;
  const PointCorrection& correction;
  std::vector<double> reference;
  std::size_t input;
  std::vector<std::size_t> outputs;
  std::vector<double> subtracted;

  void operator()(std::span<const double> positions, std::vector<std::vector<double>>& values) const {
    PoseList commands, found;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      commands.axis.emplace_back(positions.size(), reference[i]);
    }
    commands.axis[input].assign(positions.begin(), positions.end());
    correction.evaluate(commands, found);
    values.assign(outputs.size(), {});
    for (std::size_t f = 0; f < outputs.size(); ++f) {
      values[f] = found.axis[outputs[f]];
      for (double& value : values[f]) value -= subtracted[f];
    }
  }
};

/// What is taken off the correction of axis j on the line of axis i: what is the same in the whole volume is said once.
/// Where axes correct each other, an own table has all of it, and the others begin at zero; else an own table has of
/// the constant only its own part, for the rest of it belongs to other axes' positions.
double constant_of(const Machine& machine, const ErrorSet& errors, const std::vector<double>& reference, std::size_t i,
                   std::size_t j, bool cross, double at_reference) {
  if (i != j) return at_reference;
  return cross ? 0.0 : at_reference - own_correction(machine, errors, i, reference[i]);
}

}  // namespace

std::vector<double> middle_of_travel(const Machine& machine, const ErrorSet& errors) {
  std::vector<double> middle;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const KnownTravel travel = known_travel(machine, errors, i);
    // A turn has no middle; its zero is where the machine is described.
    middle.push_back(machine.axes[i].endless ? std::clamp(0.0, travel.from, travel.to)
                                             : 0.5 * (travel.from + travel.to));
  }
  return middle;
}

std::vector<double> line_correction(const Machine& machine, const ErrorSet& errors,
                                    const std::vector<double>& reference, std::size_t input, std::size_t output,
                                    const std::vector<double>& positions, bool cross) {
  const PointCorrection correction(machine, errors);
  PoseList at_reference, there;
  at_reference.append(reference);
  correction.evaluate(at_reference, there);
  const double constant = constant_of(machine, errors, reference, input, output, cross, there.axis[output][0]);
  std::vector<std::vector<double>> values;
  Line{machine, errors, correction, reference, input, {output}, {constant}}(positions, values);
  return values[0];
}

LineTables line_tables(const Machine& machine, const ErrorSet& errors, const LineTableOptions& options) {
  const std::size_t axes = machine.axes.size();
  const PointCorrection correction(machine, errors);
  const std::vector<double> reference =
      options.reference.empty() ? middle_of_travel(machine, errors) : options.reference;
  PoseList at_reference, there;
  at_reference.append(reference);
  correction.evaluate(at_reference, there);
  LineTables result;
  for (std::size_t i = 0; i < axes; ++i) {
    if (!options.axes.empty() && !options.axes[i]) continue;
    const KnownTravel travel = known_travel(machine, errors, i);
    Line line{machine, errors, correction, reference, i, {}, {}};
    NodeSpacing spacing;
    spacing.from = travel.from;
    spacing.to = travel.to;
    spacing.most = options.most_nodes;
    spacing.step_multiple =
        machine.axes[i].kind == AxisKind::rotary ? options.step_multiple_rad : options.step_multiple_mm;
    if (!options.anchors.empty() && !travel.whole_turn) spacing.anchor = options.anchors[i];
    spacing.kinks = kinks_of(errors, i);
    if (spacing.anchor && !spacing.kinks.empty()) spacing.kinks.push_back(*spacing.anchor);
    for (std::size_t j = 0; j < axes; ++j) {
      const bool rotary = machine.axes[j].kind == AxisKind::rotary;
      if (i == j ? !options.own : !options.cross || rotary) continue;
      line.outputs.push_back(j);
      line.subtracted.push_back(constant_of(machine, errors, reference, i, j, options.cross, there.axis[j][0]));
      spacing.tolerance.push_back(rotary ? options.tolerance_rad : options.tolerance_mm);
    }
    if (line.outputs.empty()) continue;
    const TableNodes nodes = options.nodes > 0 ? nodes_at(line, spacing, options.nodes) : choose_nodes(line, spacing);
    for (std::size_t f = 0; f < line.outputs.size(); ++f) {
      const bool rotary = machine.axes[line.outputs[f]].kind == AxisKind::rotary;
      AxisTable table;
      table.input = i;
      table.output = line.outputs[f];
      table.positions = nodes.positions;
      table.forward = nodes.values[f];
      // A table that repeats itself has one value where it meets itself.
      if (travel.whole_turn && std::abs(table.forward.back() - table.forward.front()) <= spacing.tolerance[f]) {
        table.forward.back() = table.forward.front();
        table.modulo = true;
      }
      table.reverse = table.forward;
      if (i == line.outputs[f] && options.directions) {
        const double half = 0.5 * reversal_of(errors, i);
        for (double& value : table.forward) value -= half;
        for (double& value : table.reverse) value += half;
      }
      if (largest_correction(table) <= (rotary ? options.negligible_rad : options.negligible_mm)) continue;
      result.tables.push_back(std::move(table));
      result.interpolation_error.push_back(nodes.error[f]);
      result.within.push_back(nodes.error[f] <= spacing.tolerance[f]);
    }
  }
  return result;
}

}  // namespace abbe
