#include "abbe/errors/error_digest.h"

#include <array>

namespace abbe {
namespace {

void add_vector(Digest& digest, const Eigen::Vector3d& v) { digest.add_numbers(std::array{v.x(), v.y(), v.z()}); }

template <typename Number>
void add_choice(Digest& digest, Number value) {
  digest.add(static_cast<std::uint64_t>(value));
}

void add_axis(Digest& digest, const Axis& axis) {
  digest.add_text(axis.name);
  add_choice(digest, axis.kind);
  add_choice(digest, axis.side);
  for (const bool is : {axis.primed, axis.endless, axis.setting}) add_choice(digest, is);
  add_vector(digest, axis.direction);
  add_vector(digest, axis.point);
  digest.add_numbers(std::array{axis.travel_min, axis.travel_max});
}

void add_state(Digest& digest, const MachineState& state) {
  digest.add_text(state.name);
  digest.add_text(state.unit);
  add_choice(digest, state.kind);
  for (const std::size_t index : {state.axis, state.first, state.second}) digest.add(index);
  digest.add_numbers(std::array{state.reference, state.time_constant});
  for (const GravityLoad& load : state.loads) {
    digest.add(load.carried_by);
    digest.add_number(load.mass_kg);
    add_vector(digest, load.point);
  }
  digest.add(state.loads.size());
}

void add_basis(Digest& digest, const Basis& basis) {
  add_choice(digest, basis.kind);
  add_choice(digest, basis.order);
  add_choice(digest, basis.periodic);
  digest.add_numbers(std::array{basis.from, basis.to, basis.period});
  digest.add_numbers(basis.nodes);
}

}  // namespace

void add_to(Digest& digest, const Machine& machine) {
  for (const Axis& axis : machine.axes) add_axis(digest, axis);
  digest.add(machine.axes.size());
  const Eigen::Matrix3d& turn = machine.bed_from_workpiece.rotation;
  digest.add_numbers({turn.data(), static_cast<std::size_t>(turn.size())});
  for (const Eigen::Vector3d& v : {machine.bed_from_workpiece.translation, machine.tool_reference, machine.tool_offset,
                                   machine.tool_direction, machine.gravity})
    add_vector(digest, v);
  for (const MachineState& state : machine.states) add_state(digest, state);
  digest.add(machine.states.size());
  for (const AxisCoupling& coupling : machine.couplings) {
    digest.add(coupling.axis);
    digest.add(coupling.of);
    digest.add_number(coupling.ratio);
  }
  digest.add(machine.couplings.size());
}

void add_to(Digest& digest, const ErrorSet& errors) {
  for (const ErrorMotion& motion : errors.motions) {
    digest.add(motion.axis);
    digest.add(motion.state);
    add_choice(digest, motion.component);
    add_basis(digest, motion.basis);
    digest.add_numbers(motion.coefficients);
  }
  digest.add(errors.motions.size());
  for (const LocationError& location : errors.locations) {
    digest.add(location.axis);
    digest.add(location.state);
    add_choice(digest, location.component);
    digest.add_number(location.value);
  }
  digest.add(errors.locations.size());
  for (const Reversal& reversal : errors.reversals) {
    digest.add(reversal.axis);
    digest.add_number(reversal.value);
  }
  digest.add(errors.reversals.size());
  add_vector(digest, errors.tool_offset_error);
  add_choice(digest, errors.composition.order);
  add_choice(digest, errors.composition.first_order);
}

}  // namespace abbe
