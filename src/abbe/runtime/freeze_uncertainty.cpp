#include "abbe/runtime/freeze_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"
#include "abbe/runtime/freeze_check.h"

namespace abbe {
namespace {

using Dimension = FrozenUncertainty::Dimension;

/// Poses and tools at which the file has the uncertainty, at most.
constexpr std::size_t kNodes = 20000;
/// With states, evaluations at most.
constexpr std::size_t kEvaluations = 160000;
static_assert(kNodes <= FrozenUncertainty::kMostNodes, "what is written is read again");
static_assert(std::size_t{1} << FrozenUncertainty::kMostDimensions <= kNodes, "two nodes of each dimension have room");

/// From end to end of travel and of where the errors are known.
Dimension dimension_of(const Machine& machine, const ErrorSet& errors, std::size_t axis) {
  const Axis& a = machine.axes[axis];
  Dimension d;
  d.axis = axis;
  if (a.endless) {
    d.from = -std::numbers::pi;
    d.to = std::numbers::pi;
    d.is_periodic = true;
  } else if (is_coupled(machine, axis)) {
    const std::array<double, 2> known = commands_in_map(machine, errors, axis);
    d.from = known[0];
    d.to = known[1];
  } else {
    double from = a.travel_min, to = a.travel_max;
    for (const ErrorMotion& motion : errors.motions) {
      const Basis& basis = motion.basis;
      if (motion.axis != axis || (basis.covers(basis.from - 1e5) && basis.covers(basis.to + 1e5))) continue;
      from = std::max(from, basis.from);
      to = std::min(to, basis.to);
    }
    d.from = from <= to ? from : a.travel_min;
    d.to = from <= to ? to : a.travel_max;
  }
  const bool turns_far = a.kind == AxisKind::rotary && d.to - d.from > 3.5;
  d.nodes = turns_far ? 9 : 5;
  return d;
}

class PointUncertainty {
 public:
  PointUncertainty(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                   const std::vector<std::vector<double>>& corners)
      : machine_(machine), errors_(errors), covariance_(options.covariance), corners_(corners) {
    machine_.tool_offset.setZero();
  }

  /// For several tools along the tool direction at one pose.
  void at(const std::vector<double>& position, const std::vector<double>& lengths, std::vector<double>& result) {
    const std::size_t before = result.size();
    result.resize(before + lengths.size(), 0.0);
    for (const std::vector<double>& given : corners_) {
      tool_deviation(machine_, errors_, position, deviation_, &by_parameters_, nullptr, given);
      const Eigen::Matrix<double, 6, 6> spread = by_parameters_ * covariance_ * by_parameters_.transpose();
      const Eigen::Vector3d tool = nominal_workpiece_from_tool(machine_, position).rotation * machine_.tool_direction;
      for (std::size_t k = 0; k < lengths.size(); ++k) {
        // The point lies against the tool direction from the gauge point; small turns move it by their cross product.
        Eigen::Matrix<double, 3, 6> moves;
        moves << Eigen::Matrix3d::Identity(), skew(lengths[k] * tool);
        const Eigen::Matrix3d point = moves * spread * moves.transpose();
        const SymmetricEigen<3> solver(point, Eigen::EigenvaluesOnly);
        result[before + k] = std::max(result[before + k], std::sqrt(std::max(0.0, solver.eigenvalues()[2])));
      }
    }
  }

 private:
  Machine machine_;
  const ErrorSet& errors_;
  const Eigen::MatrixXd& covariance_;
  const std::vector<std::vector<double>>& corners_;
  Deviation deviation_;
  Eigen::MatrixXd by_parameters_;
};

double node(const Dimension& d, std::size_t i) {
  return d.from + (d.to - d.from) * static_cast<double>(i) / static_cast<double>(d.nodes - 1);
}

/// @param axes  [axes] from end to end of all axes
/// @param most  nodes
std::vector<Dimension> choose_dimensions(const std::vector<Dimension>& axes, const FreezeOptions& options,
                                         std::size_t most) {
  std::vector<Dimension> dimensions;
  for (const Dimension& d : axes) {
    if (d.to - d.from > 1e-6) dimensions.push_back(d);
  }
  while (dimensions.size() + 1 > FrozenUncertainty::kMostDimensions) dimensions.erase(dimensions.begin());
  if (options.tool_length_max - options.tool_length_min > 1e-6 || dimensions.empty()) {
    const double to = std::max(options.tool_length_max, options.tool_length_min + 1);
    dimensions.push_back({FrozenUncertainty::kToolLength, 3, options.tool_length_min, to, false});
  }
  const auto nodes = [&] {
    std::size_t product = 1;
    for (const Dimension& d : dimensions) product *= d.nodes;
    return product;
  };
  while (nodes() > most) {
    const auto largest = std::max_element(dimensions.begin(), dimensions.end(),
                                          [](const Dimension& a, const Dimension& b) { return a.nodes < b.nodes; });
    --largest->nodes;
  }
  return dimensions;
}

}  // namespace

UncertaintyLattice uncertainty_lattice(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                                       const std::vector<std::vector<double>>& corners) {
  UncertaintyLattice lattice;
  if (corners.empty() || options.covariance.rows() == 0 || options.covariance.isZero(0)) return lattice;
  std::vector<Dimension> axes;
  std::vector<double> position;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    axes.push_back(dimension_of(machine, errors, i));
    position.push_back(0.5 * (axes[i].from + axes[i].to));
  }
  lattice.dimensions = choose_dimensions(axes, options, std::min(kNodes, kEvaluations / corners.size()));
  const std::vector<Dimension>& dimensions = lattice.dimensions;
  PointUncertainty uncertainty(machine, errors, options, corners);

  const bool has_lengths = dimensions.back().axis == FrozenUncertainty::kToolLength;
  std::vector<double> lengths;
  if (has_lengths) {
    for (std::size_t i = 0; i < dimensions.back().nodes; ++i) lengths.push_back(node(dimensions.back(), i));
  } else {
    lengths.push_back(options.tool_length_min);
  }
  const std::size_t turning = dimensions.size() - (has_lengths ? 1 : 0);
  std::vector<std::size_t> index(turning, 0);
  for (bool more = true; more;) {
    for (std::size_t k = 0; k < turning; ++k) position[dimensions[k].axis] = node(dimensions[k], index[k]);
    uncertainty.at(position, lengths, lattice.values);
    more = false;
    for (std::size_t k = turning; k-- > 0 && !more;) {
      more = ++index[k] < dimensions[k].nodes;
      if (!more) index[k] = 0;
    }
  }

  FrozenUncertainty frozen;
  frozen.dimensions = dimensions.size();
  std::copy(dimensions.begin(), dimensions.end(), frozen.dimension.begin());
  frozen.value = lattice.values.data();
  for (const double value : lattice.values) lattice.largest = std::max(lattice.largest, value);
  constexpr int kTried = 500;
  RandomStream random(11);
  for (int i = 0; i < kTried; ++i) {
    // Those that the lattice leaves out as well, so that what this costs is seen.
    for (const Dimension& d : axes) position[d.axis] = random.uniform(d.from, d.to);
    const double length = random.uniform(options.tool_length_min, options.tool_length_max);
    std::vector<double> there;
    uncertainty.at(position, {length}, there);
    const double between = frozen.at(position.data(), length);
    lattice.mean += there[0] / kTried;
    lattice.largest = std::max(lattice.largest, there[0]);
    lattice.interpolation = std::max(lattice.interpolation, std::abs(between - there[0]));
  }
  return lattice;
}

}  // namespace abbe
