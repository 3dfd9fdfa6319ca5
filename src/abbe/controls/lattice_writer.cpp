#include "abbe/controls/lattice_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/compensate/point_correction.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// Axes of the grid: those wanted that move, without wishes and `linear_only` no rotary ones.
std::vector<std::size_t> grid_axes(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                   bool linear_only) {
  std::vector<std::size_t> axes;
  const bool all = std::all_of(request.axes.begin(), request.axes.end(), [](bool wanted) { return wanted; });
  for (const TableAxisName& name : request.names) {
    const KnownTravel travel = known_travel(machine, errors, name.axis);
    if (!request.axes[name.axis] || !(travel.to > travel.from)) continue;
    if (all && linear_only && name.rotary) continue;
    axes.push_back(name.axis);
  }
  return axes;
}

/// Poses of at most some forty nodes of a lattice.
PoseList some_nodes(const Machine& machine, const CorrectionLattice& lattice, const std::vector<double>& reference,
                    std::vector<std::size_t>& indices) {
  PoseList poses;
  poses.axis.resize(machine.axes.size());
  const std::size_t stride = lattice.count() / 40 + 1;
  for (std::size_t k = 0; k < lattice.count(); k += stride) {
    std::vector<double> pose = reference;
    std::size_t rest = k;
    for (std::size_t a = 0; a < lattice.inputs.size(); ++a) {
      pose[lattice.inputs[a]] = lattice.positions[a][rest % lattice.positions[a].size()];
      rest /= lattice.positions[a].size();
    }
    poses.append(pose);
    indices.push_back(k);
  }
  return poses;
}

}  // namespace

LatticeOptions lattice_options(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                               const TableFormat& format, std::size_t most_inputs, bool linear_only) {
  LatticeOptions options;
  options.inputs = grid_axes(machine, errors, request, linear_only);
  if (options.inputs.empty() || options.inputs.size() > most_inputs) {
    throw InputError({.field = "--axis"}, fmt::format("{} axes for the grid", options.inputs.size()),
                     fmt::format("one to {} axes that move", most_inputs));
  }
  for (const TableAxisName& name : request.names) {
    const bool looked_up = std::find(options.inputs.begin(), options.inputs.end(), name.axis) != options.inputs.end();
    if (request.left_out.count("correction of " + machine.axes[name.axis].name) != 0) continue;
    if (!name.rotary || looked_up) options.outputs.push_back(name.axis);
  }
  options.reference = request.reference;
  options.tolerance_mm = request.tolerance_mm;
  options.tolerance_rad = request.tolerance_rad;
  options.most_nodes = request.most_nodes > 0 ? request.most_nodes : format.most_nodes;
  return options;
}

WrittenTable lattice_summary(const Machine& machine, const BuiltLattice& built, const LatticeOptions& options,
                             std::size_t output, const std::string& name, LatticeOfErrors function) {
  const CorrectionLattice& lattice = built.lattice;
  const std::size_t axis = lattice.outputs[output];
  std::vector<std::size_t> indices;
  WrittenTable summary;
  summary.name = name;
  summary.nodes = lattice.count();
  summary.is_angle = machine.axes[axis].kind == AxisKind::rotary;
  summary.interpolation_error = built.interpolation_error[output];
  summary.within = summary.interpolation_error <= (summary.is_angle ? options.tolerance_rad : options.tolerance_mm);
  for (const double value : lattice.corrections[output]) summary.largest = std::max(summary.largest, std::abs(value));
  summary.values = [poses = some_nodes(machine, lattice, options.reference, indices), axis,
                    function = std::move(function)](const ErrorSet& errors) {
    PoseList found;
    function(errors)->evaluate(poses, found);
    return found.axis[axis];
  };
  for (const std::size_t k : indices) summary.corrections.push_back(lattice.corrections[output][k]);
  return summary;
}

void add_lattice_summaries(const Machine& machine, const BuiltLattice& built, const LatticeOptions& options,
                           WrittenTables& made) {
  const CorrectionLattice& lattice = built.lattice;
  std::string grid;
  for (std::size_t a = 0; a < lattice.inputs.size(); ++a) {
    grid +=
        fmt::format("{}{} {}", a == 0 ? "" : " x ", lattice.positions[a].size(), machine.axes[lattice.inputs[a]].name);
  }
  made.remarks.push_back("grid of " + grid + ", " + fmt::format("{} nodes; other axes as --at says", lattice.count()));
  for (std::size_t o = 0; o < lattice.outputs.size(); ++o) {
    made.tables.push_back(lattice_summary(machine, built, options, o,
                                          "correction of " + machine.axes[lattice.outputs[o]].name,
                                          [&machine, options](const ErrorSet& errors) {
                                            return std::make_unique<LatticeFunction>(machine, errors, options);
                                          }));
  }
}

}  // namespace abbe
