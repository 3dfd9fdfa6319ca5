#include "abbe/errors/chain_plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "abbe/errors/chain_kernel.h"
#include "abbe/errors/chain_kernel_functions.h"
#include "abbe/errors/coupled_positions.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

using chain::AxisStep;
using chain::CarriedLoads;
using chain::CompiledChain;
using chain::ConstantTransform;
using chain::StateSource;
using chain::WeighedSide;

/// Beyond this the sine of a command has lost too many digits to be called covered.
constexpr double kLargestTurn = 1e6;  // rad

bool is_endless(const Basis& basis) {
  const double range = basis.to - basis.from;
  return basis.periodic || (basis.kind == BasisKind::fourier && range >= basis.period - 1e-9 * range);
}

void set_range(AxisStep& step, const ErrorSet& errors) {
  step.highest = step.rotary ? kLargestTurn : std::numeric_limits<double>::max();
  step.lowest = -step.highest;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != step.axis || is_endless(motion.basis)) continue;
    const double spare = 1e-9 * (motion.basis.to - motion.basis.from);
    step.lowest = std::max(step.lowest, motion.basis.from - spare);
    step.highest = std::min(step.highest, motion.basis.to + spare);
  }
}

void set_transform(ConstantTransform& out, const RigidTransform& transform) {
  out.turns = transform.rotation != Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) out.rotation[3 * i + k] = transform.rotation(i, k);
    out.offset[i] = transform.translation[i];
  }
}

RigidTransform machine_from_body(const Machine& machine, Body body) {
  if (body == Body::tool) return RigidTransform::translate(machine.tool_reference);
  if (body == Body::workpiece) return machine.bed_from_workpiece;
  return {};
}

/// Axes between the bed and a body, nearest to the bed first.
std::vector<std::size_t> axes_of(const Machine& machine, Body body) {
  std::vector<std::size_t> axes;
  const std::size_t workpiece_side = machine.workpiece_axis_count();
  if (body == Body::tool) {
    for (std::size_t i = workpiece_side; i < machine.axes.size(); ++i) axes.push_back(i);
  } else if (body == Body::workpiece) {
    for (std::size_t i = workpiece_side; i-- > 0;) axes.push_back(i);
  }
  return axes;
}

/// Machine's states that errors of these axes use, with the factors of products; [states of the machine].
std::vector<std::uint8_t> states_of_axes(const Machine& machine, const ErrorSet& errors,
                                         std::span<const std::size_t> axes) {
  std::vector<std::uint8_t> used(machine.states.size(), 0);
  const auto note = [&](std::size_t axis, std::size_t state) {
    if (state == kNoState || std::find(axes.begin(), axes.end(), axis) == axes.end()) return;
    const MachineState& one = machine.states.at(state);
    used[state] = 1;
    if (one.kind == StateKind::product) used[one.first] = used[one.second] = 1;
  };
  for (const ErrorMotion& motion : errors.motions) note(motion.axis, motion.state);
  for (const LocationError& location : errors.locations) note(location.axis, location.state);
  return used;
}

/// Axes of the side of a gravity state, as far as its loads are carried, and the loads by axis.
void add_loads(const Machine& machine, const MachineState& state, CompiledChain& chain, StateSource& source) {
  const Body body = machine.axes[state.axis].side == ChainSide::tool ? Body::tool : Body::workpiece;
  const std::vector<std::size_t> outwards = axes_of(machine, body);
  source.side = 0;
  while (source.side < chain.sides.size() && chain.sides[source.side].axes.front().axis != outwards.front()) {
    ++source.side;
  }
  if (source.side == chain.sides.size()) chain.sides.emplace_back();
  std::vector<WeighedSide::Line>& axes = chain.sides[source.side].axes;
  const auto place = [&](std::size_t axis) {
    return static_cast<std::size_t>(std::find(outwards.begin(), outwards.end(), axis) - outwards.begin());
  };
  source.about = place(state.axis);
  for (const GravityLoad& load : state.loads) {
    const std::size_t at = place(load.carried_by);
    for (std::size_t i = axes.size(); i <= at; ++i) {
      const Axis& axis = machine.axes[outwards[i]];
      WeighedSide::Line line{outwards[i], axis.kind == AxisKind::rotary, axis.sense()};
      for (int k = 0; k < 3; ++k) line.direction[k] = axis.direction[k];
      for (int k = 0; k < 3; ++k) line.point[k] = axis.point[k];
      axes.push_back(line);
    }
    const auto known = std::find_if(source.loads.begin(), source.loads.end(),
                                    [&](const CarriedLoads& other) { return other.at == at; });
    CarriedLoads& loads = known == source.loads.end() ? source.loads.emplace_back() : *known;
    loads.at = at;
    loads.mass += load.mass_kg;
    for (int k = 0; k < 3; ++k) loads.moment[k] += load.mass_kg * load.point[k];
  }
}

ConstPointArrays points_from(const ConstPointArrays& arrays, std::size_t first) {
  return {arrays.x + first, arrays.y + first, arrays.z + first};
}

PointArrays points_from(const PointArrays& arrays, std::size_t first) {
  return {arrays.x + first, arrays.y + first, arrays.z + first};
}

RotationArrays rotations_from(RotationArrays arrays, std::size_t first) {
  for (double*& element : arrays.r) {
    if (element != nullptr) element += first;
  }
  return arrays;
}

AxisStep::Location channels_of(const LocationEffect& effect, std::size_t parameter) {
  AxisStep::Location location{parameter};
  for (int k = 0; k < 3; ++k) location.effect[k] = effect.shift[k];
  for (int k = 0; k < 3; ++k) location.effect[3 + k] = effect.tilt[k];
  location.effect[6] = effect.zero_position;
  const auto effects =
      std::count_if(std::begin(location.effect), std::end(location.effect), [](double value) { return value != 0; });
  const auto* one = std::find(std::begin(location.effect), std::end(location.effect), 1.0);
  if (effects == 1 && one != std::end(location.effect)) location.only = static_cast<int>(one - location.effect);
  return location;
}

}  // namespace

struct ChainPlan::Implementation {
  struct Line {
    Eigen::Vector3d direction, point;
  };
  CompiledChain chain;
  chain::FunctionCompiler functions;
  std::vector<Line> lines;                  ///< nominal, per step
  std::vector<AxisCoupling> couplings;      ///< in the order of couplings_in_order()
  std::vector<std::size_t> compiled_state;  ///< [states of the machine] index into CompiledChain::states or kNoState
  std::size_t parameter_count = 0;

  void differentiate(chain::DifferentiateCall call) const {
    const auto sweep = [&] {
      for (std::size_t first = 0; first < call.rows.size(); first += chain::kRowsAtOnce) {
        chain::differentiate_rows(chain, call, first, std::min(chain::kRowsAtOnce, call.rows.size() - first));
      }
    };
    if (couplings.empty()) return sweep();
    const chain::CoupledPositions block(couplings, call.positions, 0, call.positions.count);
    call.positions = block.arrays();
    sweep();
    if (call.by_position != nullptr) {
      chain::hand_to_commands(couplings, call.rows.size() * call.positions.count, call.by_position);
    }
  }

  void add_states(const Machine& machine, const std::vector<std::uint8_t>& used) {
    compiled_state.assign(machine.states.size(), kNoState);
    if (std::find(used.begin(), used.end(), std::uint8_t{1}) == used.end()) return;
    assert(machine.states.size() <= kMaxStates);
    for (int k = 0; k < 3; ++k) chain.weight[k] = 1e-3 * machine.gravity[k];
    for (const bool products : {false, true}) {
      for (std::size_t j = 0; j < used.size(); ++j) {
        const MachineState& state = machine.states[j];
        if (used[j] == 0 || (state.kind == StateKind::product) != products) continue;
        StateSource source;
        source.kind = state.kind;
        source.given = j;
        source.reference = state.reference;
        source.axis = state.axis;
        source.moves = depends_on_commands(machine, j);
        if (products) {
          source.first = compiled_state[state.first];
          source.second = compiled_state[state.second];
        }
        if (state.kind == StateKind::gravity) add_loads(machine, state, chain, source);
        compiled_state[j] = chain.states.size();
        chain.states.push_back(std::move(source));
      }
    }
  }

  void add_step(const Machine& machine, const ErrorSet& errors, std::size_t index, bool inverted) {
    const Axis& axis = machine.axes[index];
    AxisStep step;
    step.axis = index;
    step.rotary = axis.kind == AxisKind::rotary;
    step.inverted = inverted;
    const bool error_left = errors.composition.order == ErrorOrder::iso
                                ? step.rotary
                                : errors.composition.order == ErrorOrder::before_motion;
    step.error_first = error_left == inverted;
    step.first_order = errors.composition.first_order;
    step.sign = inverted ? -axis.sense() : axis.sense();
    for (int k = 0; k < 3; ++k) step.reference[k] = axis.point[k];
    for (int k = 0; k < 3; ++k) step.nominal_direction[k] = axis.direction[k];
    set_range(step, errors);
    std::size_t parameter = first_reversal(errors) - errors.locations.size();
    for (const LocationError& location : errors.locations) {
      if (location.axis == index) {
        step.locations.push_back(channels_of(location_effect(axis, location.component), parameter));
        if (location.state != kNoState) step.locations.back().state = compiled_state[location.state];
        step.moving_line = step.moving_line || location.state != kNoState;
        chain.influences[parameter] = 1;
      }
      ++parameter;
    }
    chain.steps.push_back(std::move(step));
    lines.push_back({axis.direction, axis.point});
    functions.add_terms(chain, chain.steps.size() - 1, errors, compiled_state);
    parameter = 0;
    for (const ErrorMotion& motion : errors.motions) {
      if (motion.axis == index) std::fill_n(&chain.influences[parameter], motion.coefficients.size(), std::uint8_t{1});
      parameter += motion.coefficients.size();
    }
  }

  /// What the point is shifted by before, between and after error and motion, so that both turn about the origin.
  static void set_offsets(AxisStep& step) {
    step.has_offsets = false;
    for (int i = 0; i < 3; ++i) {
      // An error without angles and a linear motion are the same about any point.
      const double error = step.has_angles ? step.reference[i] : step.rotary ? step.centre[i] : 0.0;
      const double motion = step.rotary ? step.centre[i] : error;
      step.before[i] = step.error_first ? error : motion;
      step.after[i] = step.error_first ? motion : error;
      step.between[i] = step.before[i] - step.after[i];
      step.has_offsets = step.has_offsets || step.before[i] != 0 || step.after[i] != 0;
    }
  }

  void displace_line(AxisStep& step, const Line& line, std::span<const double> values) const {
    Eigen::Vector3d tilt = Eigen::Vector3d::Zero(), centre = line.point;
    step.zero_position = 0;
    std::fill(std::begin(step.fixed_effect), std::end(step.fixed_effect), 0.0);
    for (AxisStep::Location& location : step.locations) {
      const double value = values[location.parameter];
      location.value = value;
      if (location.state != kNoState) continue;
      for (int k = 0; k < 7; ++k) step.fixed_effect[k] += value * location.effect[k];
      for (int k = 0; k < 3; ++k) centre[k] += value * location.effect[k];
      for (int k = 0; k < 3; ++k) tilt[k] += value * location.effect[3 + k];
      step.zero_position += value * location.effect[6];
    }
    const Eigen::Vector3d direction = rotation_from_error_angles(tilt) * line.direction;
    const Eigen::Matrix3d axes = error_angle_axes(tilt);
    step.zero_sine = std::sin(step.zero_position);
    step.zero_cosine = std::cos(step.zero_position);
    for (int i = 0; i < 3; ++i) {
      step.direction_products[i] = direction[i] * direction[i];
      step.direction_products[3 + i] = direction[i == 2 ? 1 : 0] * direction[i == 0 ? 1 : 2];
      step.direction[i] = direction[i];
      step.signed_direction[i] = step.sign * direction[i];
      step.centre[i] = centre[i];
      for (int k = 0; k < 3; ++k) step.tilt_axes[k][i] = axes(i, k);
    }
    set_offsets(step);
  }
};

ChainPlan::ChainPlan(const Machine& machine, const ErrorSet& errors, Body from, Body to)
    : implementation_(std::make_unique<Implementation>()) {
  CompiledChain& chain = implementation_->chain;
  implementation_->couplings = couplings_in_order(machine);
  implementation_->parameter_count = errors.parameter_count();
  chain.influences.assign(errors.parameter_count(), 0);
  chain.tool_parameter = errors.parameter_count() - 3;
  chain.first_order = errors.composition.first_order;
  chain.starts_at_tool = from == Body::tool && to != Body::tool;
  chain.ends_at_tool = to == Body::tool && from != Body::tool;
  if (chain.starts_at_tool || chain.ends_at_tool)
    std::fill_n(&chain.influences[chain.tool_parameter], 3, std::uint8_t{1});
  if (from == to) return;

  set_transform(chain.start, machine_from_body(machine, from));
  set_transform(chain.end, machine_from_body(machine, to).inverse());
  std::vector<std::size_t> towards_bed = axes_of(machine, from);
  std::reverse(towards_bed.begin(), towards_bed.end());
  std::vector<std::size_t> axes = towards_bed;
  const std::vector<std::size_t> from_bed = axes_of(machine, to);
  axes.insert(axes.end(), from_bed.begin(), from_bed.end());
  implementation_->add_states(machine, states_of_axes(machine, errors, axes));
  for (const std::size_t axis : towards_bed) implementation_->add_step(machine, errors, axis, false);
  for (const std::size_t axis : from_bed) implementation_->add_step(machine, errors, axis, true);
  set_parameters(errors.parameters());
}

ChainPlan::~ChainPlan() = default;
ChainPlan::ChainPlan(ChainPlan&&) noexcept = default;
ChainPlan& ChainPlan::operator=(ChainPlan&&) noexcept = default;

void ChainPlan::set_parameters(std::span<const double> values) {
  assert(values.size() == implementation_->parameter_count);
  CompiledChain& chain = implementation_->chain;
  implementation_->functions.set_values(chain, values);
  for (std::size_t i = 0; i < chain.steps.size(); ++i) {
    implementation_->displace_line(chain.steps[i], implementation_->lines[i], values);
  }
}

void ChainPlan::transform(PositionArrays positions, ConstPointArrays start, PointArrays seen, RotationArrays rotation,
                          std::uint8_t* covered) const {
  for (std::size_t first = 0; first < positions.count; first += kBlockSize) {
    const std::size_t count = std::min(kBlockSize, positions.count - first);
    if (implementation_->couplings.empty()) {
      chain::transform_block(implementation_->chain, positions, first, count, start, seen, rotation, covered);
    } else {
      const chain::CoupledPositions block(implementation_->couplings, positions, first, count);
      chain::transform_block(implementation_->chain, block.arrays(), 0, count, points_from(start, first),
                             points_from(seen, first), rotations_from(rotation, first),
                             covered != nullptr ? covered + first : nullptr);
    }
  }
}

void ChainPlan::differentiate(PositionArrays positions, ConstPointArrays /*start*/, ConstPointArrays seen,
                              std::span<const RowArrays> rows, std::span<const std::size_t> parameters,
                              double* jacobian, std::size_t stride, const PointArrays* by_start,
                              double* by_position) const {
  assert(positions.count <= kBlockSize);
  assert(parameters.empty() || stride >= rows.size() * positions.count);
  implementation_->differentiate({positions, seen, rows, parameters, jacobian, stride, by_start, by_position});
}

void ChainPlan::differentiate_factored(PositionArrays positions, ConstPointArrays seen, std::span<const RowArrays> rows,
                                       std::span<const std::size_t> parameters, const FactoredColumns& form,
                                       double* carriers, std::size_t stride, double* bases, std::size_t basis_stride,
                                       const PointArrays* by_start, double* by_position) const {
  assert(positions.count <= kBlockSize && basis_stride >= positions.count);
  assert(form.columns.size() >= parameters.size());
  assert(parameters.empty() || stride >= rows.size() * positions.count);
  implementation_->differentiate(
      {positions, seen, rows, parameters, carriers, stride, by_start, by_position, &form, bases, basis_stride});
}

}  // namespace abbe
