#include "abbe/compensate/tables/correction_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/table_nodes.h"
#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

constexpr std::size_t kChecked = 4000;         // places where the finished lattice is looked at
constexpr double kMarginBetweenChecks = 1.05;  // what is between them may be a little more

/// Interval of a position and its share of the way through it.
struct PlaceInInterval {
  std::size_t index = 0;
  double share = 0;
};

PlaceInInterval place_of(const std::vector<double>& nodes, bool modulo, double position) {
  const double first = nodes.front(), last = nodes.back();
  if (modulo && last > first) position -= (last - first) * std::floor((position - first) / (last - first));
  if (nodes.size() == 1 || !(position > first)) return {};
  if (position >= last) return {nodes.size() - 2, 1};
  const auto after = static_cast<std::size_t>(std::upper_bound(nodes.begin(), nodes.end(), position) - nodes.begin());
  return {after - 1, (position - nodes[after - 1]) / (nodes[after] - nodes[after - 1])};
}

/// Nodes that one axis needs on lines through the corners and the middle of the others' travel.
TableNodes nodes_along(const CommandCorrection& function, const LatticeOptions& options, std::size_t input,
                       const std::vector<KnownTravel>& travels, std::size_t axes, const std::vector<double>& tolerance,
                       std::vector<double> kinks) {
  std::vector<std::vector<double>> lines;
  const std::size_t others = options.inputs.size() - 1;
  // Beyond five inputs the corners are too many; those of the first four others are taken.
  const std::size_t corners = std::size_t{1} << std::min<std::size_t>(others, 4);
  for (std::size_t corner = 0; corner <= corners; ++corner) {
    std::vector<double> pose = options.reference;
    std::size_t bit = 0;
    for (std::size_t a = 0; a < options.inputs.size(); ++a) {
      if (a == input) continue;
      const KnownTravel& travel = travels[a];
      const double middle = 0.5 * (travel.from + travel.to);
      const bool upper = (corner >> std::min<std::size_t>(bit, 8) & 1U) != 0;
      // A turn has no corners: a quarter of it stands for the middle.
      const double to = travel.whole_turn ? 0.5 * middle : travel.to;
      pose[options.inputs[a]] = corner == corners ? middle : upper ? to : travel.from;
      ++bit;
    }
    lines.push_back(std::move(pose));
  }
  const SampledFunctions sampled = [&](std::span<const double> positions, std::vector<std::vector<double>>& values) {
    values.clear();
    PoseList commands, found;
    for (const std::vector<double>& pose : lines) {
      commands.axis.clear();
      for (std::size_t i = 0; i < axes; ++i) commands.axis.emplace_back(positions.size(), pose[i]);
      commands.axis[options.inputs[input]].assign(positions.begin(), positions.end());
      function.evaluate(commands, found);
      for (const std::size_t output : options.outputs) values.push_back(found.axis[output]);
    }
  };
  NodeSpacing spacing;
  spacing.from = travels[input].from;
  spacing.to = travels[input].to;
  spacing.places = 250;
  spacing.kinks = std::move(kinks);
  // One axis can have no more than what is left when all others have two.
  spacing.most = std::min(options.most_per_axis, options.most_nodes >> others);
  for (std::size_t line = 0; line < lines.size(); ++line) {
    for (const double each : tolerance) spacing.tolerance.push_back(each / static_cast<double>(options.inputs.size()));
  }
  return choose_nodes(sampled, spacing);
}

/// Fewer nodes along every axis, until the lattice has room for all.
void fit_into(std::vector<std::vector<double>>& positions, std::size_t most) {
  const auto count = [&] {
    double product = 1;
    for (const std::vector<double>& nodes : positions) product *= static_cast<double>(nodes.size());
    return product;
  };
  while (count() > static_cast<double>(std::max<std::size_t>(most, std::size_t{1} << positions.size()))) {
    auto longest = std::max_element(positions.begin(), positions.end(),
                                    [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (longest->size() <= 2) break;
    *longest = evenly_spaced(longest->front(), longest->back(), longest->size() - 1 - longest->size() / 16);
  }
}

/// Largest differences between lattice and function over random places, half of them in middles of cells.
std::vector<double> found_errors(const Machine& machine, const CorrectionLattice& lattice,
                                 const CommandCorrection& function, const std::vector<double>& reference) {
  RandomStream random(1, 0);
  PoseList commands;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) commands.axis.emplace_back(kChecked, reference[i]);
  for (std::size_t k = 0; k < kChecked; ++k) {
    for (std::size_t a = 0; a < lattice.inputs.size(); ++a) {
      const std::vector<double>& nodes = lattice.positions[a];
      const double share = random.uniform();
      double position = nodes.front() + share * (nodes.back() - nodes.front());
      if (k % 2 == 0 && nodes.size() > 1) {
        const auto cell =
            std::min(nodes.size() - 2, static_cast<std::size_t>(share * static_cast<double>(nodes.size() - 1)));
        position = 0.5 * (nodes[cell] + nodes[cell + 1]);
      }
      commands.axis[lattice.inputs[a]][k] = position;
    }
  }
  PoseList wanted, said;
  function.evaluate(commands, wanted);
  LatticeCorrection(lattice).evaluate(commands, said);
  std::vector<double> errors;
  for (const std::size_t output : lattice.outputs) {
    double largest = 0;
    for (std::size_t k = 0; k < kChecked; ++k) {
      largest = std::max(largest, std::abs(said.axis[output][k] - wanted.axis[output][k]));
    }
    errors.push_back(kMarginBetweenChecks * largest);
  }
  return errors;
}

}  // namespace

void LatticeCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  const std::size_t count = commands.count(), inputs = lattice_.inputs.size();
  correction.axis.assign(commands.axis.size(), std::vector<double>(count, 0.0));
  std::array<PlaceInInterval, kMaxAxes> places;
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t a = 0; a < inputs; ++a) {
      places[a] = place_of(lattice_.positions[a], lattice_.modulo[a], commands.axis[lattice_.inputs[a]][k]);
    }
    for (std::size_t corner = 0; corner < std::size_t{1} << inputs; ++corner) {
      double weight = 1;
      std::size_t index = 0, stride = 1;
      for (std::size_t a = 0; a < inputs; ++a) {
        const bool upper = (corner >> a & 1U) != 0;
        weight *= upper ? places[a].share : 1 - places[a].share;
        index += stride * (places[a].index + (upper && lattice_.positions[a].size() > 1 ? 1 : 0));
        stride *= lattice_.positions[a].size();
      }
      if (weight == 0) continue;
      for (std::size_t o = 0; o < lattice_.outputs.size(); ++o) {
        correction.axis[lattice_.outputs[o]][k] += weight * lattice_.corrections[o][index];
      }
    }
  }
}

struct LatticeFunction::Implementation {
  Implementation(const Machine& machine, const ErrorSet& errors, LatticeOptions chosen)
      : point(machine, errors), options(std::move(chosen)) {}
  PointCorrection point;
  LatticeOptions options;
};

LatticeFunction::LatticeFunction(const Machine& machine, const ErrorSet& errors, LatticeOptions options)
    : implementation_(std::make_unique<Implementation>(machine, errors, std::move(options))) {
  const auto& outputs = implementation_->options.outputs;
  implementation_->point.set_rotary_corrected(std::any_of(
      outputs.begin(), outputs.end(), [&](std::size_t i) { return machine.axes[i].kind == AxisKind::rotary; }));
}
LatticeFunction::~LatticeFunction() = default;

void LatticeFunction::evaluate(const PoseList& commands, PoseList& correction) const {
  const LatticeOptions& options = implementation_->options;
  PoseList looked_up;
  for (std::size_t i = 0; i < commands.axis.size(); ++i) {
    looked_up.axis.emplace_back(commands.count(), options.reference[i]);
  }
  for (const std::size_t input : options.inputs) looked_up.axis[input] = commands.axis[input];
  PoseList found;
  implementation_->point.evaluate(looked_up, found);
  correction.axis.assign(commands.axis.size(), std::vector<double>(commands.count(), 0.0));
  for (const std::size_t output : options.outputs) correction.axis[output] = found.axis[output];
}

namespace {

/// [outputs] mm or rad
std::vector<double> output_tolerance(const Machine& machine, const LatticeOptions& options) {
  std::vector<double> tolerance;
  for (const std::size_t output : options.outputs) {
    tolerance.push_back(machine.axes[output].kind == AxisKind::rotary ? options.tolerance_rad : options.tolerance_mm);
  }
  return tolerance;
}

}  // namespace

std::vector<std::vector<double>> lattice_nodes(const Machine& machine, const ErrorSet& errors,
                                               const LatticeOptions& options) {
  return lattice_nodes(machine, errors, options, LatticeFunction(machine, errors, options));
}

std::vector<std::vector<double>> lattice_nodes(const Machine& machine, const ErrorSet& errors,
                                               const LatticeOptions& options, const CommandCorrection& function) {
  std::vector<KnownTravel> travels;
  for (const std::size_t input : options.inputs) travels.push_back(known_travel(machine, errors, input));
  const std::vector<double> tolerance = output_tolerance(machine, options);
  std::vector<std::vector<double>> positions;
  for (std::size_t a = 0; a < options.inputs.size(); ++a) {
    positions.push_back(
        nodes_along(function, options, a, travels, machine.axes.size(), tolerance, kinks_of(errors, options.inputs[a]))
            .positions);
  }
  fit_into(positions, options.most_nodes);
  return positions;
}

BuiltLattice lattice_over(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options,
                          std::vector<std::vector<double>> positions) {
  return lattice_over(machine, errors, options, std::move(positions), LatticeFunction(machine, errors, options));
}

BuiltLattice lattice_over(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options,
                          std::vector<std::vector<double>> positions, const CommandCorrection& function) {
  const std::vector<double> tolerance = output_tolerance(machine, options);
  BuiltLattice built;
  CorrectionLattice& lattice = built.lattice;
  lattice.inputs = options.inputs;
  lattice.outputs = options.outputs;
  lattice.positions = std::move(positions);
  for (const std::size_t input : options.inputs) {
    lattice.modulo.push_back(known_travel(machine, errors, input).whole_turn);
  }
  // In pieces of one row of the first input, so that large lattices need little more memory than they are.
  const std::size_t row = lattice.positions.empty() ? 1 : lattice.positions[0].size();
  const std::size_t rows = lattice.count() / row;
  lattice.corrections.assign(options.outputs.size(), std::vector<double>(lattice.count()));
  PoseList commands, found;
  for (std::size_t r = 0; r < rows; ++r) {
    commands.axis.clear();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) commands.axis.emplace_back(row, options.reference[i]);
    if (!lattice.inputs.empty()) commands.axis[lattice.inputs[0]] = lattice.positions[0];
    std::size_t rest = r;
    for (std::size_t a = 1; a < lattice.inputs.size(); ++a) {
      const std::vector<double>& nodes = lattice.positions[a];
      commands.axis[lattice.inputs[a]].assign(row, nodes[rest % nodes.size()]);
      rest /= nodes.size();
    }
    function.evaluate(commands, found);
    for (std::size_t o = 0; o < options.outputs.size(); ++o) {
      std::copy(found.axis[options.outputs[o]].begin(), found.axis[options.outputs[o]].end(),
                lattice.corrections[o].begin() + static_cast<std::ptrdiff_t>(r * row));
    }
  }
  built.interpolation_error = found_errors(machine, lattice, function, options.reference);
  for (std::size_t o = 0; o < tolerance.size(); ++o) {
    built.within = built.within && built.interpolation_error[o] <= tolerance[o];
  }
  return built;
}

BuiltLattice build_lattice(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options) {
  return lattice_over(machine, errors, options, lattice_nodes(machine, errors, options));
}

}  // namespace abbe
