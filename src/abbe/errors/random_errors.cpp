#include "abbe/errors/random_errors.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/best_fit_transform.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

/// One stream per error name, so that drawing fewer errors does not change the others.
std::uint64_t stream_of(std::size_t axis, Component component, bool location) {
  return (axis * kComponentCount + static_cast<std::size_t>(component)) * 2 + (location ? 1 : 0);
}

ErrorMotion random_motion(const Machine& machine, std::size_t index, Component component,
                          const RandomErrorOptions& options) {
  const Axis& axis = machine.axes[index];
  ErrorMotion motion{
      .axis = index, .component = component, .basis = {}, .coefficients = {}, .standard_uncertainty = {}};
  const PositionLimits travel = position_limits(machine, index);
  const bool turns = axis.kind == AxisKind::rotary && (axis.endless || travel.to - travel.from >= kTurn * (1 - 1e-9));
  motion.basis.from = turns && axis.endless ? 0 : travel.from;
  motion.basis.to = turns && axis.endless ? kTurn : travel.to;
  motion.basis.kind = turns ? BasisKind::fourier : BasisKind::legendre;
  motion.basis.period = turns ? kTurn : 0;
  motion.basis.order = turns                           ? options.rotary_harmonics
                       : axis.kind == AxisKind::rotary ? options.rotary_order
                                                       : options.linear_order;
  const double size = is_rotation(component) ? 1e-6 * options.rotation_urad : 1e-3 * options.translation_um;
  RandomStream random(options.seed, stream_of(index, component, false));
  for (std::size_t k = 0; k < motion.basis.size(); ++k) {
    // Degree, or harmonic of a cosine and sine pair.
    const std::size_t degree = turns ? (k + 1) / 2 : k;
    const double draw = random.normal();
    if (degree == 0) {
      motion.coefficients.push_back(options.constant_terms ? size * draw : 0.0);
    } else {
      motion.coefficients.push_back(size * std::pow(options.decay, static_cast<double>(degree - 1)) * draw);
    }
  }
  return motion;
}

struct Deviations {
  std::vector<Eigen::Vector3d> nominal, displacement;
};

Deviations sample_deviations(const Machine& machine, const ErrorSet& errors, const VolumetricTarget& target) {
  std::size_t per_axis = std::max<std::size_t>(target.points_per_axis, 2);
  const double axes = static_cast<double>(machine.axes.size());
  while (per_axis > 2 && std::pow(static_cast<double>(per_axis), axes) > 20000) --per_axis;
  PoseGrid grid;
  for (const Axis& axis : machine.axes) {
    const double from = axis.endless ? 0 : axis.travel_min, to = axis.endless ? kTurn : axis.travel_max;
    std::vector<double> values = evenly_spaced(from, to, from == to ? 1 : per_axis);
    // A position half a turn or a whole turn on sees the same harmonics; spread by the golden section instead.
    if (axis.kind == AxisKind::rotary && axis.endless) {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = kTurn * std::fmod(0.618033988749895 * static_cast<double>(i), 1.0);
    }
    grid.values.push_back(values);
  }
  const PoseSource poses = pose_source(grid);
  std::vector<std::vector<double>> positions(poses.axes, std::vector<double>(poses.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : positions) pointers.push_back(values.data());
  poses.fill(0, poses.count, pointers.data());
  const std::vector<const double*> axis(pointers.begin(), pointers.end());

  const auto seen_by = [&](const ErrorSet& set) {
    const Eigen::Vector3d tip = machine.tool_offset + set.tool_offset_error;
    std::vector<double> p[3];
    for (int c = 0; c < 3; ++c) p[c].assign(poses.count, tip[c]);
    const ChainPlan plan(machine, set, Body::tool, Body::workpiece);
    plan.transform({axis, poses.count}, {p[0].data(), p[1].data(), p[2].data()},
                   {p[0].data(), p[1].data(), p[2].data()});
    std::vector<Eigen::Vector3d> points(poses.count);
    for (std::size_t k = 0; k < poses.count; ++k) points[k] = {p[0][k], p[1][k], p[2][k]};
    return points;
  };
  Deviations result;
  ErrorSet none;
  none.composition = errors.composition;
  result.nominal = seen_by(none);
  result.displacement = seen_by(errors);
  RigidTransform datum;
  if (target.remove_rigid_motion) datum = best_fit_transform(result.displacement, result.nominal).target_from_source;
  for (std::size_t k = 0; k < poses.count; ++k) {
    result.displacement[k] = datum * result.displacement[k] - result.nominal[k];
  }
  return result;
}

void multiply(ErrorSet& errors, double factor) {
  std::vector<double> values = errors.parameters();
  for (double& value : values) value *= factor;
  errors.set_parameters(values);
}

}  // namespace

ErrorSet random_errors(const Machine& machine, const RandomErrorOptions& options) {
  std::set<std::pair<std::size_t, int>> motions, locations;
  for (const std::string& name : options.only) {
    std::size_t axis = 0;
    Component component = Component::X;
    bool is_location = false;
    if (!parse_error_name(machine, name, axis, component, is_location)) {
      throw std::invalid_argument(name + " is not an error of this machine");
    }
    (is_location ? locations : motions).insert({axis, static_cast<int>(component)});
  }
  const auto wanted = [&](const std::set<std::pair<std::size_t, int>>& chosen, std::size_t axis, int component) {
    return options.only.empty() || chosen.count({axis, component}) > 0;
  };
  ErrorSet errors;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    for (int c = 0; c < kComponentCount; ++c) {
      const Component component = static_cast<Component>(c);
      if (options.motions && wanted(motions, i, c)) {
        errors.motions.push_back(random_motion(machine, i, component, options));
      }
      if (!options.locations || !wanted(locations, i, c)) continue;
      if (!location_error_is_valid(machine.axes[i], component)) continue;
      RandomStream random(options.seed, stream_of(i, component, true));
      const double size = is_rotation(component) ? 1e-6 * options.location_urad : 1e-3 * options.location_um;
      errors.locations.push_back({i, component, size * random.normal(), 0});
    }
  }
  return errors;
}

double volumetric_error(const Machine& machine, const ErrorSet& errors, const VolumetricTarget& target) {
  const Deviations deviations = sample_deviations(machine, errors, target);
  double sum = 0, largest = 0;
  for (const Eigen::Vector3d& d : deviations.displacement) {
    sum += d.norm();
    largest = std::max(largest, d.norm());
  }
  if (target.measure == VolumetricMeasure::maximum) return largest;
  return sum / static_cast<double>(deviations.displacement.size());
}

double scale_errors(const Machine& machine, ErrorSet& errors, const VolumetricTarget& target) {
  if (!(target.value_um >= 0) || !std::isfinite(target.value_um)) {
    throw std::invalid_argument("volumetric error must be a finite number of um, not negative");
  }
  const ErrorSet original = errors;
  const double wanted = 1e-3 * target.value_um;
  double factor = 1;
  if (wanted == 0) {
    multiply(errors, 0);
    return 0;
  }
  // Nearly proportional: each step squares the relative gap.
  for (int step = 0; step < 50; ++step) {
    const double now = volumetric_error(machine, errors, target);
    if (!(now > 1e-12) || !std::isfinite(now)) break;
    if (std::abs(now - wanted) <= 1e-10 * wanted) return factor;
    factor *= wanted / now;
    errors = original;
    multiply(errors, factor);
  }
  if (std::abs(volumetric_error(machine, errors, target) - wanted) <= 1e-9 * wanted) return factor;
  errors = original;
  return 0;
}

}  // namespace abbe
